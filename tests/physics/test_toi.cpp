// Engine `toi`: contacts at their time of impact inside a fixed step.
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
Contact const elastic{Law::swap_scale, 1, 1};

std::vector<Way> const ways{{EngineKind::toi, Precision::double_, Placement::serial},
                            {EngineKind::toi, Precision::double_, Placement::parallel},
                            {EngineKind::toi, Precision::single_, Placement::serial}};

class Toi : public testing::TestWithParam<Way> {
 protected:
  static double unit() { return round_off(GetParam().precision); }
};
INSTANTIATE_TEST_SUITE_P(Ways, Toi, testing::ValuesIn(ways),
                         [](auto const& way) { return name(way.param); });

Scene gas(std::size_t count, double packing, double gravity, Contact const& contact, Boundary x,
          Boundary y)
{
  double const height = height_for(count, packing, 1.0);
  Scene scene;
  scene.model = make_model(height, height, gravity, contact, x, y);
  scene.discs = separate_discs(scene.model, count, 10, 21);
  scene.dt = 0.02;
  return scene;
}

/// The impulse at the moment of contact: discs that are 2 and not 4 apart in the middle of the step
/// exchange their velocities there, and both fly on for the rest of it.
TEST_P(Toi, AppliesTheImpulseWhereDiscsTouch)
{
  auto const run =
      start(scene_of(64, 32, 0, elastic, {{-2, 0, 8, 0}, {2, 0, 0, 0}}, 0.5), GetParam());
  run->advance(1);
  EXPECT_TRUE(same_bits(states(run), {{0, 0, 0, 0}, {4, 0, 8, 0}}));
  EXPECT_EQ(run->report().collisions, 1);
}

/// Only discs that approach collide: not those that touch at rest or recede.
TEST_P(Toi, LeavesTouchingDiscsAloneUnlessTheyApproach)
{
  for (double const speed : {0.0, 1.0, -1.0}) {
    auto const run = start(
        scene_of(64, 32, 0, elastic, {{-1, 0, -speed, 0}, {1, 0, speed, 0}}, 0.125), GetParam());
    run->advance(4);
    EXPECT_EQ(run->report().collisions, speed < 0 ? 1 : 0) << speed;
  }
}

/// Five in a row that touch: the first stops, the last goes, all in one step.
TEST_P(Toi, PassesMomentumThroughARowInOneStep)
{
  auto const run =
      start(scene_of(64, 32, 0, elastic,
                     {{-5, 0, 4, 0}, {-2, 0, 0, 0}, {0, 0, 0, 0}, {2, 0, 0, 0}, {4, 0, 0, 0}}, 0.5),
            GetParam());
  run->advance(1);
  EXPECT_TRUE(same_bits(states(run),
                        {{-4, 0, 0, 0}, {-2, 0, 0, 0}, {0, 0, 0, 0}, {2, 0, 0, 0}, {5, 0, 4, 0}}));
}

/// Both axes in one step, exactly in the corner too, and several bounces: the free path of a point
/// in a box of 62 x 30, unfolded.
TEST_P(Toi, FoldsThePathAtAllWallsInOneStep)
{
  auto const folded = [](double place, double length) { // in 0...length
    double const u = std::fmod(place, 2 * length);
    return u < length ? u : 2 * length - u;
  };
  for (double const dt : {0.5, 2.0, 5.0}) {
    auto const run = start(scene_of(64, 32, 0, elastic, {{11, 4, 31, 17}}, dt), GetParam());
    run->advance(1);
    auto const disc = states(run)[0];
    EXPECT_NEAR(disc.x + 31, folded(42 + 31 * dt, 62), 2000 * unit()) << dt;
    EXPECT_NEAR(disc.y + 15, folded(19 + 17 * dt, 30), 2000 * unit()) << dt;
    EXPECT_EQ(run->report().wall_hits,
              std::floor((42 + 31 * dt) / 62) + std::floor((19 + 17 * dt) / 30));
  }
  auto const corner = start(scene_of(64, 64, 0, elastic, {{27, 27, 8, 8}}, 1), GetParam());
  corner->advance(1);
  EXPECT_TRUE(same_bits(states(corner), {{27, 27, -8, -8}}));
  EXPECT_EQ(corner->report().wall_hits, 2);
}

/// Longer than can be followed: the disc is somewhere in the box, as fast as before.
TEST_P(Toi, KeepsADiscInsideHoweverLongTheStep)
{
  for (double const dt : {1e3, 1e6, 1e30}) {
    auto const run = start(scene_of(64, 32, 0, elastic, {{11, 4, 31, 17}}, dt), GetParam());
    run->advance(3);
    auto const disc = states(run)[0];
    EXPECT_LE(std::fabs(disc.x), 31);
    EXPECT_LE(std::fabs(disc.y), 15);
    EXPECT_EQ(std::fabs(disc.vx), 31);
    EXPECT_EQ(std::fabs(disc.vy), 17);
    EXPECT_EQ(run->report().max_outside, 0);
  }
}

/// They would pass through each other in an engine that looks once a step.
TEST_P(Toi, MissesNoDiscThatCrossesInAStep)
{
  for (double const speed : {1.0, 100.0, 1e4}) {
    auto const run =
        start(scene_of(400, 40, 0, elastic, {{-10, 0, speed, 0}, {10, 0, -speed, 0}}, 18 / speed),
              GetParam());
    run->advance(1);
    EXPECT_EQ(run->report().collisions, 1);
    EXPECT_TRUE(close(states(run), {{-10, 0, -speed, 0}, {10, 0, speed, 0}}, 100 * speed * unit()));
  }
}

/// Exact parabola and exact bounce: a step changes the energy by a few roundings and no more,
/// though perhaps always in the same direction, since the ball repeats itself. Four are allowed.
TEST_P(Toi, KeepsTheEnergyOfABouncingBall)
{
  std::int64_t const steps = long_run(GetParam(), 100000);
  auto const run = start(scene_of(40, 40, 10, elastic, {{0, -14, 1, 0}}, 0.3), GetParam());
  run->advance(steps);
  auto const report = run->report();
  EXPECT_NEAR(static_cast<double>(report.wall_hits),
              report.time / 2 + std::floor((19 + report.time) / 38), 2 + 1e6 * unit());
  EXPECT_NEAR(report.energy.kinetic + report.energy.potential, report.energy.initial(),
              4 * static_cast<double>(steps) * unit() * report.energy.initial());
}

/// A disc with no velocity left, which could tell the ceiling from the floor.
TEST_P(Toi, TurnsADiscRoundAtACeilingThatIsJustReached)
{
  auto const run = start(scene_of(40, 40, 10, elastic, {{0, 14, 0, 10}}, 1.5), GetParam());
  run->advance(1);
  EXPECT_TRUE(close(states(run), {{0, 19 - 10 * 0.25 / 2, 0, -5}}, 100 * unit()));
}

/// A ball comes to rest at sqrt(2 h/g) (1 + a)/(1 - a), after infinitely many bounces; the step in
/// which that is ends with the ball at rest, and so do all after it, without further events but one
/// a step. Its tangential velocity is kept without friction and lost with it.
TEST_P(Toi, BringsABallToRestInTheStepInWhichItDoes)
{
  double const g = 10, h = 5, a = 0.5, rest = std::sqrt(2 * h / g) * (1 + a) / (1 - a);
  for (double const friction : {1.0, 0.5}) {
    auto const scene =
        scene_of(40, 40, g, {Law::restitution, a, friction}, {{7, -19 + h, 0.25, 0}}, 0.28);
    auto const run = start(scene, GetParam());
    auto const last = static_cast<std::int64_t>(rest / 0.28);
    run->advance(last);
    EXPECT_NE(states(run)[0].vy, 0);
    run->advance(1);
    EXPECT_EQ(states(run)[0].vy, 0);
    auto const hits = run->report().wall_hits;
    run->advance(50);
    EXPECT_EQ(states(run)[0].vy, 0);
    EXPECT_NEAR(states(run)[0].y, -19, 100 * unit());
    EXPECT_EQ(states(run)[0].vx, friction < 1 ? 0 : 0.25);
    EXPECT_LE(run->report().wall_hits, hits + 50);
  }
}

/// The sums of all sources against the energy that is there: 1e-12 of it in double precision.
TEST_P(Toi, BalancesItsBooks)
{
  double const tolerance = GetParam().precision == Precision::double_ ? 1e-12 : 1e-4;
  for (auto const& contact : {elastic, Contact{Law::swap_scale, 0.95, 0.9},
                              Contact{Law::restitution, 0.9, 0.8}, Contact{Law::restitution, 0, 0}})
    for (double const packing : {0.05, 0.5})
      for (double const gravity : {0.0, 9.81, -9.81}) {
        auto const scene = gas(100, packing, gravity, contact, periodic, walls);
        auto const run = start(scene, GetParam());
        run->advance(100);
        auto const report = run->report();
        EXPECT_LE(std::fabs(report.energy.residual()), tolerance * scale(report.energy))
            << packing << " " << gravity << " " << contact.restitution;
        EXPECT_GT(report.collisions, 0);
      }
}

/// Rounding only: each collision errs by a few units of the velocities, which are below 100.
TEST_P(Toi, KeepsMomentumOnATorusByTheLawThatConservesIt)
{
  auto const scene = gas(200, 0.4, 0, {Law::restitution, 0.9, 0.7}, periodic, periodic);
  auto const before = report_after(scene, GetParam(), 0),
             after = report_after(scene, GetParam(), long_run(GetParam(), 500));
  ASSERT_GT(after.collisions, 100);
  double const tolerance = 16 * unit() * 100 * static_cast<double>(after.collisions);
  EXPECT_NEAR(after.momentum_x, before.momentum_x, tolerance);
  EXPECT_NEAR(after.momentum_y, before.momentum_y, tolerance);
}

/// Discs of restitution 0.5 fall into a heap. This engine is not made for that: contacts that go on
/// for ever are left to the next step, and discs sink into each other. But it goes on, in the box,
/// with books that balance, without energy from nowhere, and says how deep.
TEST_P(Toi, SurvivesAHeap)
{
  auto const scene = gas(80, 0.4, 50, {Law::restitution, 0.5, 0.9}, walls, walls);
  auto const run = start(scene, GetParam());
  run->advance(long_run(GetParam(), 400));
  auto const report = run->report();
  double const deepest = deepest_overlap(scene.model, states(run));
  EXPECT_TRUE(all_finite(states(run)));
  EXPECT_LE(farthest_outside(scene.model, states(run)), 8 * unit());
  EXPECT_GE(report.max_overlap, deepest - 8 * unit());
  EXPECT_LT(report.energy.kinetic + report.energy.potential, report.energy.initial());
  EXPECT_LE(std::fabs(report.energy.residual()),
            (GetParam().precision == Precision::double_ ? 1e-12 : 1e-4) * scale(report.energy));
}

/// No overlap is missed, however often it is asked, in a heap and in a gas whose discs stay
/// together when they have met. (Inside some steps they overlap deeper than after any.)
TEST_P(Toi, SaysHowDeepDiscsOverlapAfterAnyStep)
{
  for (auto const& scene : {gas(80, 0.4, 50, {Law::restitution, 0.5, 0.9}, walls, walls),
                            gas(200, 0.6, 0, {Law::restitution, 0, 1}, periodic, walls)})
    for (int const steps : {1, 3, 7}) {
      auto const run = start(scene, GetParam());
      double deepest = 0;
      for (int k = 0; k < 60; ++k) {
        run->advance(steps);
        deepest = std::max(deepest, deepest_overlap(scene.model, states(run)));
        ASSERT_GE(run->report().max_overlap, deepest - 8 * unit()) << k;
      }
      EXPECT_GT(deepest, 64 * unit());
    }
}

TEST_P(Toi, RefusesWhatIsNotOneLayerOfDiscsBetweenTheWalls)
{
  for (auto const& discs : inseparate_discs())
    EXPECT_THROW(start(scene_of(40, 40, 0, elastic, discs, 1), GetParam()), std::invalid_argument);
}

/// Numbers of single precision near 1e5 are 1/128 apart: a tenth of the way in a step of a disc
/// with a thermal speed of 1 is 1/128 at dt = 10/128.
TEST(ToiInSinglePrecision, IsRefusedWherePlacesAreTooCoarse)
{
  std::vector<DiscState> const discs{{0, 0, 1, 1}, {10, 10, -1, 1}};
  for (auto const precision : {Precision::double_, Precision::single_})
    for (double const steps : {0.99, 1.01}) {
      auto const begin = [&] {
        start(scene_of(2e5, 2e5, 0, elastic, discs, steps * 10 / 128),
              {EngineKind::toi, precision, Placement::serial});
      };
      if (precision == Precision::single_ && steps < 1)
        EXPECT_THROW(begin(), std::invalid_argument);
      else
        EXPECT_NO_THROW(begin());
    }
}

} // namespace
} // namespace ricochet::test
