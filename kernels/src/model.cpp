#include "ricochet/model.hpp"

#include <charconv>
#include <cmath>

namespace ricochet {
namespace {

/// As few digits as read back to the same number.
std::string text(double value)
{
  char digits[32];
  auto const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  return {digits, end};
}

bool in_unit_interval(double value)
{
  return value >= 0 && value <= 1;
}

} // namespace

std::vector<Problem> problems(Model const& model)
{
  std::vector<Problem> found;
  auto const require = [&](bool holds, char const* quantity, double value, std::string allowed) {
    if (!holds)
      found.push_back({quantity, text(value), std::move(allowed)});
  };
  auto const& box = model.box;
  bool const radius_is_good = std::isfinite(model.radius) && model.radius > 0;
  require(radius_is_good, "discs.radius", model.radius, "a finite number above 0");
  auto const require_length = [&](double length, char const* quantity) {
    require(std::isfinite(length) && length > 0, quantity, length, "a finite number above 0");
    if (std::isfinite(length) && length > 0 && radius_is_good)
      require(length >= 2 * model.radius, quantity, length,
              "at least " + text(2 * model.radius) + ", the diameter of a disc");
  };
  require_length(box.width, "box.width");
  require_length(box.height, "box.height");
  require(std::isfinite(model.gravity), "forces.gravity", model.gravity, "a finite number");
  if (box.y == Boundary::periodic)
    require(model.gravity == 0 || !std::isfinite(model.gravity), "forces.gravity", model.gravity,
            "0, because box.y is periodic and discs would fall for ever");
  require(in_unit_interval(model.contact.restitution), "contact.restitution",
          model.contact.restitution, "0 to 1");
  require(in_unit_interval(model.contact.friction), "contact.friction", model.contact.friction,
          "0 to 1");
  return found;
}

std::vector<DiscProblem> problems(Model const& model, std::vector<DiscState> const& discs)
{
  std::vector<DiscProblem> found;
  auto const check = [&](std::size_t disc, char const* quantity, double value, double limit) {
    if (!std::isfinite(value))
      found.push_back({disc, {quantity, text(value), "a finite number"}});
    else if (std::fabs(value) > limit)
      found.push_back(
          {disc,
           {quantity, text(value),
            text(-limit) + " to " + text(limit) + ", so that the centre is in the box"}});
  };
  for (std::size_t i = 0; i < discs.size(); ++i) {
    check(i, "x", discs[i].x, model.box.width / 2);
    check(i, "y", discs[i].y, model.box.height / 2);
    check(i, "vx", discs[i].vx, HUGE_VAL);
    check(i, "vy", discs[i].vy, HUGE_VAL);
  }
  return found;
}

double packing_fraction(Model const& model, std::size_t count)
{
  constexpr double pi = 3.14159265358979323846;
  return static_cast<double>(count) * pi * model.radius * model.radius / model.box.width /
         model.box.height;
}

double collision_rate(Model const& model, std::size_t count, double temperature)
{
  constexpr double root_of_pi = 1.7724538509055160;
  double const packing = packing_fraction(model, count), diameter = 2 * model.radius;
  double const contact_value = (1 - 7 * packing / 16) / ((1 - packing) * (1 - packing));
  return 8 * packing / (root_of_pi * diameter) * contact_value * std::sqrt(temperature);
}

} // namespace ricochet
