#include "support/compare.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>
#include <iomanip>
#include <limits>
#include <sstream>

namespace ricochet::test {

namespace {

struct Field {
  char const* name;
  double DiscState::*value;
};
constexpr Field fields[] = {
    {"x", &DiscState::x}, {"y", &DiscState::y}, {"vx", &DiscState::vx}, {"vy", &DiscState::vy}};

std::uint64_t bits(double value)
{
  std::uint64_t result;
  std::memcpy(&result, &value, sizeof result);
  return result;
}

std::string shown(double value)
{
  std::ostringstream text;
  text << std::setprecision(17) << value << " [" << std::hex << std::setw(16) << std::setfill('0')
       << bits(value) << "]";
  return text.str();
}

/// |a - b|, and infinity where that is not a number.
double distance(double a, double b)
{
  double const d = std::abs(a - b);
  return a == b ? 0 : std::isnan(d) ? std::numeric_limits<double>::infinity() : d;
}

/// Fails where `differs` for any number; shows the worst three of them.
template <class Differs>
testing::AssertionResult compare(std::vector<DiscState> const& actual,
                                 std::vector<DiscState> const& expected, Differs const& differs)
{
  if (actual.size() != expected.size())
    return testing::AssertionFailure() << actual.size() << " discs instead of " << expected.size();

  struct Difference {
    std::size_t disc;
    Field field;
    double size;
  };
  std::vector<Difference> found;
  for (std::size_t k = 0; k < actual.size(); ++k)
    for (auto const& field : fields) {
      double const a = actual[k].*field.value, b = expected[k].*field.value;
      if (differs(a, b))
        found.push_back({k, field, distance(a, b)});
    }
  if (found.empty())
    return testing::AssertionSuccess();

  std::stable_sort(found.begin(), found.end(),
                   [](auto const& a, auto const& b) { return a.size > b.size; });
  auto failure = testing::AssertionFailure();
  failure << found.size() << " of " << 4 * actual.size() << " numbers differ; the worst:";
  for (std::size_t k = 0; k < std::min<std::size_t>(3, found.size()); ++k) {
    auto const& f = found[k];
    failure << "\n  disc " << f.disc << " " << f.field.name << ": "
            << shown(actual[f.disc].*f.field.value) << " instead of "
            << shown(expected[f.disc].*f.field.value) << ", off by " << f.size;
  }
  return failure;
}

} // namespace

testing::AssertionResult same_bits(std::vector<DiscState> const& actual,
                                   std::vector<DiscState> const& expected)
{
  return compare(actual, expected, [](double a, double b) { return bits(a) != bits(b); });
}

testing::AssertionResult close(std::vector<DiscState> const& actual,
                               std::vector<DiscState> const& expected, double tolerance)
{
  return compare(actual, expected,
                 [&](double a, double b) { return !(distance(a, b) <= tolerance); })
         << "\n  (tolerance " << tolerance << ")";
}

testing::AssertionResult same_bits(Report const& actual, Report const& expected)
{
  std::ostringstream found;
  auto const compare_number = [&](char const* name, double a, double b) {
    if (bits(a) != bits(b))
      found << "\n  " << name << ": " << shown(a) << " instead of " << shown(b);
  };
  auto const compare_count = [&](char const* name, std::int64_t a, std::int64_t b) {
    if (a != b)
      found << "\n  " << name << ": " << a << " instead of " << b;
  };
  compare_count("discs", actual.discs, expected.discs);
  compare_count("steps", actual.steps, expected.steps);
  compare_count("collisions", actual.collisions, expected.collisions);
  compare_count("separating_hits", actual.separating_hits, expected.separating_hits);
  compare_count("wall_hits", actual.wall_hits, expected.wall_hits);
  compare_count("pressure_z is defined", actual.pressure_z.has_value(),
                expected.pressure_z.has_value());
  compare_count("executions.islands", actual.executions.islands, expected.executions.islands);
  compare_count("executions.crowd", actual.executions.crowd, expected.executions.crowd);
  compare_count("executions.rounds", actual.executions.rounds, expected.executions.rounds);
  compare_count("executions.in_order", actual.executions.in_order, expected.executions.in_order);
  compare_number("time", actual.time, expected.time);
  compare_number("max_overlap", actual.max_overlap, expected.max_overlap);
  compare_number("max_outside", actual.max_outside, expected.max_outside);
  compare_number("momentum_x", actual.momentum_x, expected.momentum_x);
  compare_number("momentum_y", actual.momentum_y, expected.momentum_y);
  compare_number("temperature", actual.temperature, expected.temperature);
  compare_number("pressure_z", actual.pressure_z.value_or(0), expected.pressure_z.value_or(0));
  auto const &a = actual.energy, &e = expected.energy;
  compare_number("energy.kinetic_initial", a.kinetic_initial, e.kinetic_initial);
  compare_number("energy.potential_initial", a.potential_initial, e.potential_initial);
  compare_number("energy.kinetic", a.kinetic, e.kinetic);
  compare_number("energy.potential", a.potential, e.potential);
  compare_number("energy.lost_pairs", a.lost_pairs, e.lost_pairs);
  compare_number("energy.lost_walls", a.lost_walls, e.lost_walls);
  compare_number("energy.numerical", a.numerical, e.numerical);
  if (found.str().empty())
    return testing::AssertionSuccess();
  return testing::AssertionFailure() << "the reports differ:" << found.str();
}

testing::AssertionResult all_finite(std::vector<DiscState> const& states)
{
  for (std::size_t k = 0; k < states.size(); ++k)
    for (auto const& field : fields)
      if (!std::isfinite(states[k].*field.value))
        return testing::AssertionFailure()
               << "disc " << k << " " << field.name << " is " << states[k].*field.value;
  return testing::AssertionSuccess();
}

double scale(EnergyLedger const& energy)
{
  return std::max({std::abs(energy.kinetic_initial), std::abs(energy.potential_initial),
                   std::abs(energy.kinetic), std::abs(energy.potential),
                   std::abs(energy.lost_pairs), std::abs(energy.lost_walls),
                   std::abs(energy.numerical)});
}

double largest_deviation(std::vector<DiscState> const& a, std::vector<DiscState> const& b)
{
  double largest = 0;
  for (std::size_t k = 0; k < a.size(); ++k)
    for (auto const& field : fields)
      largest = std::max(largest, distance(a[k].*field.value, b[k].*field.value));
  return largest;
}

} // namespace ricochet::test
