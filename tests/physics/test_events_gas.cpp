// Engine `events`: what a gas of hard discs must be on average. The numbers of elastic discs are
// those of long event-driven runs of other programs, or of theory; see kernels/README.md.
#include "support/runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
constexpr double pi = 3.14159265358979323846;
Contact const elastic{Law::swap_scale, 1, 1};
Way const way{EngineKind::events, Precision::double_, Placement::automatic};

struct Fluid {
  double packing, z, rate; ///< pressure, and collision rate of a disc in units of sqrt(T)/diameter
};

class EquationOfState : public testing::TestWithParam<Fluid> {};

/// Z and the collision rate within 0.5 % of long runs, and of each other by Enskog's identity
/// rate = (4/diameter) (Z - 1) sqrt(T/pi) within 0.5 %. 1,000 discs with 1,000 collisions each
/// after 50: the standard error of Z - 1 is about 1/sqrt(500000) = 0.15 %, and that of the rate
/// less; the finite number of discs adds 0.05 %.
TEST_P(EquationOfState, IsThatOfLongRuns)
{
  auto const fluid = GetParam();
  Scene scene = thermal_gas(1000, fluid.packing, 0, elastic, periodic, periodic);
  scene.dt = 10 / fluid.rate;
  auto const run = start(scene, way);
  run->advance(5);
  auto const before = run->report();
  run->advance(100);
  auto const after = run->report();
  double const time = after.time - before.time;
  double const virial =
      (*after.pressure_z - 1) * after.time - (*before.pressure_z - 1) * before.time;
  double const z = 1 + virial / time;
  double const rate = 2.0 * static_cast<double>(after.collisions - before.collisions) /
                      (static_cast<double>(after.discs) * time);
  EXPECT_NEAR(z, fluid.z, 0.005 * fluid.z);
  EXPECT_NEAR(rate, fluid.rate, 0.005 * fluid.rate);
  EXPECT_NEAR(rate, 4 * (z - 1) / std::sqrt(pi), 0.005 * rate);
  EXPECT_LT(after.max_overlap, 1e-12);
}

INSTANTIATE_TEST_SUITE_P(At, EquationOfState,
                         testing::Values(Fluid{0.1, 1.23615, 0.5329}, Fluid{0.3, 2.0631, 2.3993},
                                         Fluid{0.5, 4.1071, 7.0114}, Fluid{0.65, 8.4121, 16.727}),
                         [](auto const& fluid) {
                           return "packing_" +
                                  std::to_string(std::lround(100 * fluid.param.packing));
                         });

/// The virial theorem of a gas in a box: N T Z = F L, where Z is from the collisions of discs, F
/// the force on a wall and L the way between opposite walls that centres have, a diameter less than
/// the box. The mean impulse of a disc of Maxwell's velocities on a wall is sqrt(2 pi T), for 200
/// discs of given energy 1/1600 less. Twenty blocks, whose mean is allowed 4.5 standard errors and
/// that.
TEST(GasOfEvents, PressesOnTheWallsOfItsAccessibleArea)
{
  for (auto const& fluid :
       {Fluid{0.1, 1.23615, 0.5329}, Fluid{0.3, 2.0631, 2.3993}, Fluid{0.5, 4.1071, 7.0114}}) {
    int const blocks = 20;
    double const count = 200;
    Scene scene = thermal_gas(200, fluid.packing, 0, elastic, walls, walls);
    scene.dt = 100 / fluid.rate;
    auto const run = start(scene, way);
    run->advance(1);
    double const way_of_centres = scene.model.box.width - 1;
    double sum = 0, squares = 0;
    for (int block = 0; block < blocks; ++block) {
      auto const before = run->report();
      run->start_measuring();
      run->advance(1);
      auto const after = run->report();
      double const hits = static_cast<double>(after.wall_hits - before.wall_hits);
      double const force = hits / (4 * scene.dt) * std::sqrt(2 * pi * after.temperature);
      double const z = force * way_of_centres / (count * after.temperature);
      double const difference = z / *after.pressure_z - 1;
      sum += difference;
      squares += difference * difference;
    }
    double const mean = sum / blocks;
    double const error = std::sqrt((squares / blocks - mean * mean) / (blocks - 1));
    EXPECT_LT(error, 0.006) << fluid.packing; // a diameter more or less would be 2.6 to 6 %
    EXPECT_LT(std::fabs(mean), 4.5 * error + 1.0 / 1600) << fluid.packing << ": " << mean;
  }
}

/// From discs of one speed: <v^2> is kept, <vx^4>/<vx^2>^2 becomes 3, <v^4>/<v^2>^2 becomes 2. Over
/// 40 states some collisions apart of 1,000 discs the standard error of the second is sqrt(20 /
/// 40000) = 0.02, of the first sqrt(96 / 80000) = 0.035; bounds of four of them.
TEST(GasOfEvents, HasMaxwellsVelocities)
{
  Scene scene = thermal_gas(1000, 0.3, 0, elastic, periodic, periodic);
  for (auto& disc : scene.discs) {
    double const speed = std::sqrt(disc.vx * disc.vx + disc.vy * disc.vy);
    disc.vx /= speed;
    disc.vy /= speed;
  }
  scene.dt = 2;
  auto const run = start(scene, way);
  run->advance(5);
  double vx2 = 0, vx4 = 0, v2 = 0, v4 = 0, n = 0;
  for (int k = 0; k < 40; ++k) {
    run->advance(1);
    for (auto const& d : states(run)) {
      double const x2 = d.vx * d.vx, y2 = d.vy * d.vy;
      vx2 += (x2 + y2) / 2;
      vx4 += (x2 * x2 + y2 * y2) / 2;
      v2 += x2 + y2;
      v4 += (x2 + y2) * (x2 + y2);
      ++n;
    }
  }
  EXPECT_NEAR(v2 / n, 1, 1e-12);
  EXPECT_NEAR(vx4 / n / (vx2 / n * vx2 / n), 3, 0.14);
  EXPECT_NEAR(v4 / n / (v2 / n * v2 / n), 2, 0.08);
}

/// Energy after c collisions a disc: exp(-c loss/2) with the mean loss of a collision in units of
/// T, 1 - a^2 for `restitution` (b = 1), 3/2 (1 - a^2) + (1 - b^2) for `swap_scale`; the latter for
/// a gas of Maxwell's velocities, from which it departs: 3 % is allowed there, 1 % for the former.
TEST(GasOfEvents, CoolsAsItsLawSays)
{
  struct Case {
    Contact contact;
    double loss, tolerance;
  };
  double const a = 0.95, b = 0.97;
  for (auto const& c : {Case{{Law::restitution, a, 1}, 1 - a * a, 0.01},
                        Case{{Law::swap_scale, a, b}, 1.5 * (1 - a * a) + (1 - b * b), 0.03}}) {
    Scene scene = thermal_gas(4000, 0.2, 0, c.contact, periodic, periodic);
    scene.dt = 0.2;
    auto const run = start(scene, way);
    while (run->report().collisions < 3 * 4000 / 2)
      run->advance(1);
    auto const report = run->report();
    double const cpp = 2.0 * static_cast<double>(report.collisions) / 4000;
    double const expected = std::exp(-cpp * c.loss / 2);
    EXPECT_NEAR(report.energy.kinetic / report.energy.kinetic_initial, expected,
                c.tolerance * expected)
        << name(c.contact.law);
  }
}

/// A dilute gas under gravity: n(y) ~ exp(-g y/T), so the mean height of the centres above their
/// lowest place is h = T/g less what the ceiling takes; at packing 0.002 interactions add under 2
/// %. Height 8 T/g: the ceiling takes 8/(e^8 - 1) = 0.3 %. Over 60 states of 400 discs, not all
/// independent, the standard error is about 1.5 %; 6 % is allowed.
TEST(GasOfEvents, IsDenserBelowByTheBarometricLaw)
{
  Scene scene = thermal_gas(400, 0.002, 0, elastic, periodic, walls);
  double const range = scene.model.box.height - 1;
  scene.model.gravity = 8 / range;
  scene.dt = range / 2;
  auto const run = start(scene, way);
  run->advance(20);
  double height = 0, temperature = 0;
  int const samples = 60;
  for (int k = 0; k < samples; ++k) {
    run->advance(1);
    temperature += run->report().temperature / samples;
    for (auto const& disc : states(run))
      height += (disc.y + range / 2) / (400.0 * samples);
  }
  double const x = scene.model.gravity * range / temperature;
  double const expected = range * (1 / x - 1 / std::expm1(x));
  EXPECT_NEAR(height, expected, 0.06 * expected);
}

} // namespace
} // namespace ricochet::test
