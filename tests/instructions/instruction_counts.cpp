// Steps of scenes that lack terms of the model, and the same steps written by hand for just these
// scenes, in plain loops. Both must come to the same states. Run by callgrind, it dumps how many
// instructions each takes, which compare_counts.cmake reads.
#include "ricochet/engine.hpp"
#include "support/scenes.hpp"

#include <Kokkos_Core.hpp>
#include <valgrind/callgrind.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <iostream>
#include <string>
#include <vector>

namespace ricochet::test {
namespace {

/// The discs of a scene in plain arrays, and what happened to them at walls.
struct Plain {
  Scene const& scene;
  std::vector<double> x, y, vx, vy;
  std::int64_t wall_hits = 0;
  double lost = 0;

  explicit Plain(Scene const& of) : scene(of)
  {
    for (auto const& disc : of.discs) {
      x.push_back(disc.x);
      y.push_back(disc.y);
      vx.push_back(disc.vx);
      vy.push_back(disc.vy);
    }
  }

  std::vector<DiscState> states() const
  {
    std::vector<DiscState> all;
    for (std::size_t i = 0; i < x.size(); ++i)
      all.push_back({x[i], y[i], vx[i], vy[i]});
    return all;
  }
};

double wrapped(double p, double length)
{
  double const half = length / 2;
  return p < -half ? p + length : (p >= half ? p - length : p);
}

/// Neither gravity, nor walls, nor contacts.
void drift(Plain& all)
{
  double const dt = all.scene.dt, width = all.scene.model.box.width,
               height = all.scene.model.box.height;
  for (std::size_t i = 0; i < all.x.size(); ++i) {
    all.x[i] = wrapped(all.x[i] + dt * all.vx[i], width);
    all.y[i] = wrapped(all.y[i] + dt * all.vy[i], height);
  }
}

/// A disc that leaves the box in a step is mirrored, as engine `sweep` does it: at one wall a step.
template <bool gravity, bool dissipative>
void fly_and_mirror(Plain& all)
{
  double const dt = all.scene.dt, fall = all.scene.model.gravity * dt,
               a = all.scene.model.contact.restitution, b = all.scene.model.contact.friction,
               radius = all.scene.model.radius, high_x = all.scene.model.box.width / 2,
               high_y = all.scene.model.box.height / 2;
  for (std::size_t i = 0; i < all.x.size(); ++i) {
    if (gravity)
      all.vy[i] -= fall;
    double x = all.x[i] + dt * all.vx[i], y = all.y[i] + dt * all.vy[i];
    if (std::fabs(x) + radius > high_x || std::fabs(y) + radius > high_y) {
      double const vx = all.vx[i], vy = all.vy[i];
      bool const side = std::fabs(x) + radius > high_x;
      if (side)
        x = x < 0 ? x + 2 * ((-high_x - x) + radius) : x - 2 * ((x + radius) - high_x);
      else
        y = y < 0 ? y + 2 * ((-high_y - y) + radius) : y - 2 * ((y + radius) - high_y);
      double const along = side ? -1 : 1;
      all.vx[i] = along * (dissipative ? (side ? a : b) * vx : vx);
      all.vy[i] = -along * (dissipative ? (side ? b : a) * vy : vy);
      ++all.wall_hits;
      if (dissipative)
        all.lost += 0.5 * ((vx * vx - all.vx[i] * all.vx[i]) + (vy * vy - all.vy[i] * all.vy[i]));
    }
    all.x[i] = x;
    all.y[i] = y;
  }
}

/// Time until a distance is covered under an acceleration towards its end.
double time_to_cover(double gap, double speed, double pull)
{
  double const root = std::sqrt(speed * speed + 2 * pull * gap);
  return speed < 0 ? (root - speed) / pull : 2 * gap / (speed + root);
}

/// A disc that would leave the box in a step meets a wall where and when it does: the side wall or
/// the floor, and in these scenes none meets a second in the step, or the ceiling.
template <bool gravity, bool dissipative>
void fly_and_bounce(Plain& all)
{
  double const dt = all.scene.dt, g = all.scene.model.gravity, fall = g * dt * dt / 2,
               a = all.scene.model.contact.restitution, b = all.scene.model.contact.friction,
               high_x = all.scene.model.box.width / 2 - all.scene.model.radius,
               high_y = all.scene.model.box.height / 2 - all.scene.model.radius;
  for (std::size_t i = 0; i < all.x.size(); ++i) {
    double x = all.x[i] + dt * all.vx[i], straight = all.y[i] + dt * all.vy[i];
    double y = gravity ? straight - fall : straight;
    bool const is_free = std::fabs(x) < high_x && std::fabs(y) < high_y &&
                         (!gravity || std::fabs(straight) < high_y);
    if (!is_free) {
      double vx = all.vx[i], vy = all.vy[i];
      bool const side = !(std::fabs(x) < high_x);
      double const gap = side ? high_x - std::fabs(all.x[i]) : high_y - std::fabs(all.y[i]);
      bool const below = y < 0;
      double const to_wall = side      ? gap / std::fabs(vx)
                             : gravity ? time_to_cover(gap, below ? -vy : vy, below ? g : -g)
                                       : gap / std::fabs(vy);
      double const left = dt - to_wall;
      x = all.x[i] + to_wall * vx;
      y = all.y[i] + to_wall * vy;
      if (gravity) {
        y = y - g * to_wall * to_wall / 2;
        vy = vy - g * to_wall;
      }
      double const before = vx * vx + vy * vy;
      if (side)
        x = std::copysign(high_x, vx);
      else
        y = std::copysign(high_y, vy);
      vx = side ? -(a * vx) : b * vx;
      vy = side ? b * vy : -(a * vy);
      ++all.wall_hits;
      if (dissipative)
        all.lost += 0.5 * (before - (vx * vx + vy * vy));
      x = x + left * vx;
      y = y + left * vy;
      if (gravity) {
        y = y - g * left * left / 2;
        vy = vy - g * left;
      }
      all.vx[i] = vx;
      all.vy[i] = vy;
    } else if (gravity) {
      all.vy[i] -= g * dt;
    }
    all.x[i] = x;
    all.y[i] = y;
  }
}

struct Reduction {
  std::string name;
  EngineKind engine;
  Scene scene;
  std::function<void(Plain&)> by_hand;
};

/// Discs of which about one in ten thousand meets a wall in a step.
Scene scene(double gravity, Contact const& contact, Boundary boundary)
{
  Scene result;
  result.model = make_model(4000, 4000, gravity, contact, boundary, boundary);
  result.discs = separate_discs(result.model, 20000, 10, 1);
  result.dt = 0.01;
  return result;
}

bool same_bits(std::vector<DiscState> const& a, std::vector<DiscState> const& b)
{
  return std::memcmp(a.data(), b.data(), a.size() * sizeof(DiscState)) == 0;
}

std::vector<Reduction> reductions()
{
  constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
  constexpr auto sweep = EngineKind::sweep, toi = EngineKind::toi;
  Contact const elastic{Law::swap_scale, 1, 1, false}, damping{Law::swap_scale, 0.9, 0.8, false};
  return {
      {"sweep, nothing", sweep, scene(0, elastic, periodic), drift},
      {"sweep, walls", sweep, scene(0, elastic, walls), fly_and_mirror<false, false>},
      {"sweep, gravity, walls", sweep, scene(10, elastic, walls), fly_and_mirror<true, false>},
      {"sweep, gravity, walls, damping", sweep, scene(10, damping, walls),
       fly_and_mirror<true, true>},
      {"toi, nothing", toi, scene(0, elastic, periodic), drift},
      {"toi, walls", toi, scene(0, elastic, walls), fly_and_bounce<false, false>},
      {"toi, gravity, walls", toi, scene(10, elastic, walls), fly_and_bounce<true, false>},
      {"toi, gravity, walls, damping", toi, scene(10, damping, walls), fly_and_bounce<true, true>},
  };
}

/// Returns whether both came to the same.
bool count(Reduction const& reduction)
{
  constexpr int steps = 5;
  Scene const& scene = reduction.scene;
  auto const engine =
      make_engine(scene.model, {reduction.engine, Precision::double_, scene.dt, Placement::serial},
                  scene.discs);
  Plain plain(scene);
  std::string const of_engine = "engine: " + reduction.name, by_hand = "by hand: " + reduction.name;

  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  engine->advance(steps);
  CALLGRIND_DUMP_STATS_AT(of_engine.c_str());
  for (int step = 0; step < steps; ++step)
    reduction.by_hand(plain);
  CALLGRIND_DUMP_STATS_AT(by_hand.c_str());
  CALLGRIND_STOP_INSTRUMENTATION;

  std::vector<DiscState> states(scene.discs.size());
  engine->states(states.data());
  auto const report = engine->report();
  bool const same = same_bits(states, plain.states()) && report.wall_hits == plain.wall_hits &&
                    std::fabs(report.energy.lost_walls - plain.lost) <= 1e-9 * plain.lost;
  if (!same)
    std::cerr << reduction.name << ": the engine and the step by hand differ\n";
  return same;
}

} // namespace
} // namespace ricochet::test

int main(int argc, char** argv)
{
  using namespace ricochet::test;
  Kokkos::ScopeGuard const kokkos(argc, argv);
  bool good = true;
  for (auto const& reduction : reductions())
    good = count(reduction) && good;
  return good ? 0 : 1;
}
