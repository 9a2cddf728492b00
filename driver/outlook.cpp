#include "outlook.hpp"

#include "overlaps.hpp"
#include "progress.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double freezing = 0.700; // liquid-hexatic coexistence begins; Engel et al. 2013

// Z - 1 of elastic discs: Luding's 2001 equation of state for the fluid, free volume above.
double excess_pressure(double packing)
{
  if (packing >= densest_packing)
    return HUGE_VAL;
  if (packing >= freezing)
    return 2 / (1 - packing / densest_packing) - 1;
  double const room = 1 - packing;
  double const at_contact = (1 - 7 * packing / 16) / (room * room) -
                            packing * packing * packing / (128 * room * room * room * room);
  return 2 * packing * at_contact;
}

// How many discs a line through the longer side of the box meets.
double optical_depth(Scene const& scene)
{
  Box const& box = scene.model.box;
  return static_cast<double>(scene.discs.size()) * 2 * scene.model.radius /
         std::min(box.width, box.height);
}

// Least number of discs in a row that can collapse, colliding infinitely often in a finite time,
// for large restitution: McNamara & Young 1992, doi 10.1063/1.858323.
double collapsing_row(double restitution)
{
  double const loss = 1 - restitution;
  return loss > 0 ? std::log(4 / loss) / loss : HUGE_VAL;
}

std::string size_text(double bytes)
{
  return bytes >= 1e9 ? fmt::format("{:.2f} GB", bytes / 1e9)
                      : fmt::format("{:.2f} MB", bytes / 1e6);
}

} // namespace

Outlook outlook(Scene const& scene)
{
  Model const& model = scene.model;
  double const dt = scene.method.dt, diameter = 2 * model.radius;
  auto const n = static_cast<double>(scene.discs.size());
  Outlook o;
  o.packing = packing_fraction(model, scene.discs.size());
  double sum = 0, largest = 0;
  for (DiscState const& disc : scene.discs) {
    double const speed2 = disc.vx * disc.vx + disc.vy * disc.vy;
    sum += speed2;
    largest = std::max(largest, speed2);
    o.momentum_x += disc.vx;
    o.momentum_y += disc.vy;
  }
  if (n > 0) {
    o.temperature = sum / (2 * n);
    o.fastest = std::sqrt(largest + 2 * std::fabs(model.gravity) * model.box.height);
  }
  o.step_in_radii = o.fastest * dt / model.radius;
  o.step_in_sizes = std::sqrt(o.temperature) * dt / diameter;
  if (model.contact.pairs && n > 1 && o.temperature > 0) {
    o.collision_rate = 4 / diameter * excess_pressure(o.packing) * std::sqrt(o.temperature / pi);
    o.free_path = std::sqrt(pi * o.temperature / 2) / o.collision_rate;
    o.collisions_a_step = o.collision_rate * dt;
  }
  return o;
}

std::vector<std::string> doubts(Scene const& scene, Outlook const& o)
{
  Settings const& s = scene.settings;
  double const dt = scene.method.dt, diameter = 2 * scene.model.radius;
  std::vector<std::string> list;
  auto const doubt = [&](std::vector<std::string> const& keys, std::string const& problem,
                         std::string const& suggestion) {
    Origin at = blame(s, keys.front(), keys);
    at.name = "";
    ProblemList line;
    line.add(at, "warning: " + problem, suggestion);
    list.push_back(line.text());
  };
  std::vector<std::string> const step{"run.dt", "run.steps_per_time"};
  std::vector<std::string> const discs{"discs.states", "discs.generate.count",
                                       "discs.generate.packing_fraction"};

  EngineKind const engine = scene.method.engine;
  bool const exact = engine == EngineKind::events; // whatever the step
  bool const looks_once = engine == EngineKind::sweep || engine == EngineKind::simultaneous;
  Overlaps const overlaps = find_overlaps(scene.model, scene.discs);
  if (overlaps.outside > 0)
    doubt(discs, fmt::format("{} discs poke through a wall", overlaps.outside),
          "--relax moves them inside");
  if (!scene.model.contact.pairs)
    return list;
  if (overlaps.pairs > 0)
    doubt(
        discs,
        fmt::format("{} pairs of discs overlap, discs {} and {} by {:.2g} diameters (the deepest)",
                    overlaps.pairs, overlaps.first, overlaps.second, overlaps.deepest / diameter),
        "--relax separates them");
  if (looks_once && o.step_in_radii > 1)
    doubt(step,
          fmt::format("the fastest disc{} moves {:.3g} radii in a step (beyond 1 discs may pass "
                      "through each other)",
                      scene.model.gravity != 0 ? ", after a fall through the box," : "",
                      o.step_in_radii),
          fmt::format("dt = {:.2g} makes it 0.2", 0.2 * dt / o.step_in_radii));
  else if (looks_once && o.step_in_sizes > 0.02)
    doubt(step,
          fmt::format("a thermal disc moves {:.2g} diameters in a step (contacts found late make "
                      "the discs of this engine about {:.1g} % too small)",
                      o.step_in_sizes, 70 * o.step_in_sizes),
          fmt::format("dt = {:.2g} makes it 0.01", 0.01 * dt / o.step_in_sizes));
  if (o.packing > densest_packing)
    doubt(discs,
          fmt::format("the discs cover {:.4g} of the box (without overlaps at most 0.9069 is "
                      "possible)",
                      o.packing),
          "");
  else if (o.packing > freezing - 0.02)
    doubt(discs,
          fmt::format("packing {:.4g} is near or above freezing (at 0.700 discs begin to order, "
                      "and any change takes very long)",
                      o.packing),
          "");
  if (!exact && o.collisions_a_step > 0.2)
    doubt(step,
          fmt::format("{:.2g} collisions of a disc are expected in a step (several at once are "
                      "resolved in an order of their own)",
                      o.collisions_a_step),
          fmt::format("dt = {:.2g} makes it 0.1", 0.1 * dt / o.collisions_a_step));
  double const depth = optical_depth(scene), row = collapsing_row(scene.model.contact.restitution);
  if (scene.discs.size() > 1 && depth > row)
    doubt({"contact.restitution"},
          fmt::format(
              "inelastic collapse is likely (a line through the box meets {:.3g} discs, and "
              "{:.3g} in a row can collapse): {}",
              depth, row,
              exact ? "engine events stops at lasting contact" : "clusters of discs that overlap"),
          "");
  else if (scene.discs.size() > 1 && scene.model.gravity != 0 &&
           scene.model.contact.restitution < 1)
    doubt({"contact.restitution"},
          exact
              ? "the discs will come to rest on each other (engine events stops at lasting contact)"
              : "the discs will come to rest on each other (fixed-step engines represent lasting "
                "contact by deep overlaps)",
          "");
  return list;
}

std::string in_words(Scene const& scene, Outlook const& o)
{
  Model const& m = scene.model;
  auto const axis = [](Boundary boundary) {
    return boundary == Boundary::walls ? "walls" : "periodic";
  };
  std::string text = fmt::format(
      "discs       {} of radius {}, packing fraction {:.4g}\n"
      "box         {} x {}, x {}, y {}\n"
      "contact     {}, restitution {}, friction {}; gravity {}\n",
      scene.discs.size(), shortest(m.radius), o.packing, shortest(m.box.width),
      shortest(m.box.height), axis(m.box.x), axis(m.box.y), name_of_law(m.contact),
      shortest(m.contact.restitution), shortest(m.contact.friction), shortest(m.gravity));
  text += fmt::format("motion      temperature {:.6g}, momentum ({:.3g}, {:.3g}), fastest {:.4g}\n",
                      o.temperature, o.momentum_x, o.momentum_y, o.fastest);
  text += fmt::format("steps       {} of {} ({}, {})\n", scene.steps, shortest(scene.method.dt),
                      name(scene.method.engine), name(scene.method.precision));
  text += fmt::format("in a step   thermal way {:.3g} diameters, fastest {:.3g} radii, {:.3g} "
                      "collisions of a disc\n",
                      o.step_in_sizes, o.step_in_radii, o.collisions_a_step);
  if (o.collision_rate > 0)
    text +=
        fmt::format("collisions  {:.4g} of a disc per time, a free path of {:.4g} (spread evenly, "
                    "elastic)\n",
                    o.collision_rate, o.free_path);
  return text;
}

std::string in_words(Forecast const& forecast)
{
  std::string text = fmt::format("memory      {} at most\n", size_text(forecast.memory));
  if (forecast.frames > 0)
    text += fmt::format("trajectory  {} in {} frames\n", size_text(forecast.file), forecast.frames);
  text += fmt::format("time        {} ({:.3g} s), as measured here with the first steps\n",
                      clock_text(forecast.seconds), forecast.seconds);
  return text;
}

} // namespace ricochet::driver
