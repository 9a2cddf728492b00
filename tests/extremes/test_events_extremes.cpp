// Engine `events` where numbers, boxes and collisions are extreme.
#include "support/compare.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace ricochet::test {
namespace {

constexpr auto periodic = Boundary::periodic;
Contact const elastic{Law::swap_scale, 1, 1};

/// In both precisions, on one thread and on the default backend.
class EventExtremes : public testing::TestWithParam<Way> {
 protected:
  static ricochet::test::Run run_of(Scene const& scene, std::int64_t steps)
  {
    auto run = start(scene, GetParam());
    run->advance(steps);
    return run;
  }
  static double unit() { return round_off(GetParam().precision); }
};

INSTANTIATE_TEST_SUITE_P(
    Of, EventExtremes,
    testing::Values(Way{EngineKind::events, Precision::double_, Placement::serial},
                    Way{EngineKind::events, Precision::double_, Placement::parallel},
                    Way{EngineKind::events, Precision::single_, Placement::serial}),
    [](auto const& way) { return name(way.param); });

TEST_P(EventExtremes, NoDiscAndOneDiscRun)
{
  EXPECT_EQ(run_of(scene_of(40, 40, 9.81, elastic, {}, 1), 3)->report().discs, 0);
  auto const run = run_of(scene_of(40, 40, 0, elastic, {{1, 2, 3, -4}}, 1), 3);
  EXPECT_TRUE(close(states(run), {{10, -10, 3, -4}}, 100 * unit()));
}

TEST_P(EventExtremes, OverlapsAndDiscsBeyondAWallAreRefused)
{
  for (auto const& discs : inseparate_discs())
    EXPECT_THROW(start(scene_of(40, 40, 0, elastic, discs, 1), GetParam()), std::invalid_argument);
}

/// Centres exactly a diameter apart: at rest nothing happens, receding discs recede, and the
/// slowest approach is one collision.
TEST_P(EventExtremes, TouchingDiscsCollideOnlyIfTheyApproach)
{
  double const slow = GetParam().precision == Precision::double_ ? 1e-300 : 1e-30;
  for (double const speed : {0.0, 1.0, -slow}) {
    auto const run =
        run_of(scene_of(40, 40, 0, elastic, {{-1, 0, -speed, 0}, {1, 0, speed, 0}}, 1), 5);
    EXPECT_EQ(run->report().collisions, speed < 0 ? 1 : 0) << speed;
    EXPECT_TRUE(all_finite(states(run)));
    EXPECT_EQ(run->report().max_overlap, 0);
  }
}

TEST_P(EventExtremes, DenormalAndNegativeZeroStayFinite)
{
  auto const run = run_of(
      scene_of(40, 40, 0, elastic,
               {{-0.0, -0.0, 5e-324, -0.0}, {3, 0, -1e-310, 1e-320}, {0, 9, 0x1p-140, -0.0}}, 1e3),
      4);
  EXPECT_TRUE(all_finite(states(run)));
  EXPECT_LT(largest_deviation(states(run), {{0, 0, 0, 0}, {3, 0, 0, 0}, {0, 9, 0, 0}}), 1e-9);
}

/// A step is only the distance of frames: a disc may cross the box a thousand times in one. The
/// free path is that of a point in a box of 38 x 38, unfolded.
TEST_P(EventExtremes, AStepMayBeLongerThanTheBox)
{
  auto const run = run_of(scene_of(40, 40, 0, elastic, {{1, 2, 30, 41}}, 997), 1);
  auto const folded = [](double place) { // in 0...38
    double const u = std::fmod(place, 76);
    return u < 38 ? u : 76 - u;
  };
  auto const disc = states(run)[0];
  // In a window a disc may fly three boxes wide, and what it flies is rounded once a bounce.
  double const tolerance = 40 * 2000 * 32 * unit();
  EXPECT_NEAR(disc.x + 19, folded(20 + 30.0 * 997), tolerance);
  EXPECT_NEAR(disc.y + 19, folded(21 + 41.0 * 997), tolerance);
  EXPECT_EQ(std::fabs(disc.vx), 30);
  EXPECT_EQ(std::fabs(disc.vy), 41);
  EXPECT_EQ(run->report().wall_hits, (20 + 30 * 997) / 38 + (21 + 41 * 997) / 38);
}

/// They would pass through each other in any stepper that looks at them once a step.
TEST_P(EventExtremes, DiscsThatCrossInAStepCollide)
{
  for (double const speed : {1.0, 100.0, 1e4}) {
    auto const run = run_of(
        scene_of(400, 40, 0, elastic, {{-10, 0, speed, 0}, {10, 0, -speed, 0}}, 18 / speed), 1);
    EXPECT_EQ(run->report().collisions, 1);
    EXPECT_TRUE(close(states(run), {{-10, 0, -speed, 0}, {10, 0, speed, 0}}, 1e3 * speed * unit()));
  }
}

/// Both walls in the same instant: the disc comes back on its way.
TEST_P(EventExtremes, AnExactHitOfACornerReturns)
{
  auto const run = run_of(scene_of(40, 40, 0, elastic, {{3, 3, 4, 4}}, 8), 1);
  EXPECT_EQ(run->report().wall_hits, 2);
  EXPECT_TRUE(close(states(run), {{3, 3, -4, -4}}, 100 * unit()));
}

TEST_P(EventExtremes, ABoxMayBeOneDiscWideOrAMillionTimesLongerThanHigh)
{
  auto const tube = run_of(scene_of(40, 2, 0, elastic, {{-5, 0, 3, 0}, {5, 0, -1, 0}}, 1), 4);
  EXPECT_EQ(tube->report().collisions, 1);
  EXPECT_TRUE(close(states(tube), {{-1, 0, -1, 0}, {9, 0, 3, 0}}, 100 * unit()));

  auto const line = run_of(
      scene_of(2.5e6, 2.5, 0, elastic, {{-1e6, 0, 1, 0}, {1e6, 0, -1, 0}, {0, 0, 0, 0}}, 1.5e6), 1);
  EXPECT_EQ(line->report().collisions, 3);
}

/// One disc 10,000 times faster than the others: no collision is missed and none invented. What it
/// has in energy stays.
TEST_P(EventExtremes, OneFastDiscIsFollowed)
{
  Scene scene;
  scene.model = make_model(60, 60, 0, elastic, periodic, periodic);
  scene.discs = separate_discs(scene.model, 200, 1e-4, 3);
  scene.discs[17].vx = 1;
  scene.discs[17].vy = 0.3;
  scene.dt = 10;
  auto const run = run_of(scene, 3);
  auto const report = run->report();
  EXPECT_GT(report.collisions, 20);
  EXPECT_LT(report.max_overlap, 1e4 * unit());
  EXPECT_NEAR(report.energy.kinetic, report.energy.kinetic_initial,
              1e3 * unit() * report.energy.kinetic_initial);
}

/// The densest packing but for a thousandth: every disc rattles in its cage.
TEST_P(EventExtremes, AlmostClosePackedDiscsRattleInTheirCages)
{
  double const gap = 1.001, rows = 12, columns = 14;
  Scene scene;
  scene.model =
      make_model(2 * gap * columns, std::sqrt(3.0) * gap * rows, 0, elastic, periodic, periodic);
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 14; ++column)
      scene.discs.push_back({2 * gap * (column + (row % 2 == 1 ? 0.75 : 0.25) - columns / 2),
                             std::sqrt(3.0) * gap * (row + 0.5 - rows / 2),
                             0.01 * ((7 * row + 3 * column) % 11 - 5),
                             0.01 * ((5 * row + 2 * column) % 13 - 6)});
  scene.dt = 0.5;
  auto const run = run_of(scene, 2);
  auto const report = run->report();
  EXPECT_GT(report.collisions, 168 * 2);
  EXPECT_LT(report.max_overlap, 1e3 * unit());
  EXPECT_NEAR(report.energy.kinetic, report.energy.kinetic_initial,
              1e4 * unit() * report.energy.kinetic_initial);
}

/// alpha = beta = 0: pairs and walls take all they can, and the run ends.
TEST_P(EventExtremes, AGasThatLosesEverythingComesToRest)
{
  Scene scene;
  scene.model = make_model(60, 60, 0, {Law::swap_scale, 0, 0});
  scene.discs = separate_discs(scene.model, 100, 1, 4);
  scene.dt = 1000;
  auto const run = run_of(scene, 3);
  EXPECT_LT(run->report().energy.kinetic, 1e-3 * run->report().energy.kinetic_initial);
  EXPECT_LT(run->report().max_overlap, 1e3 * unit());
}

/// A ball that comes to rest does so at sqrt(2 h/g) (1 + a)/(1 - a). There the run stops, and says
/// where and when.
TEST_P(EventExtremes, LastingContactStopsTheRunWithAMessage)
{
  for (double const a : {0.5, 0.97}) {
    double const g = 10, h = 5, rest = std::sqrt(2 * h / g) * (1 + a) / (1 - a);
    auto const run = start(
        scene_of(40, 40, g, {Law::restitution, a, 1}, {{7, -19 + h, 0, 0}}, 0.26), GetParam());
    std::int64_t steps = 0;
    std::string message;
    try {
      for (; steps < 1000; ++steps)
        run->advance(1);
    } catch (LastingContact const& error) {
      message = error.what();
    }
    EXPECT_EQ(steps, static_cast<std::int64_t>(std::ceil(rest / 0.26)) - 1);
    EXPECT_NE(message.find("disc 0 and the floor"), std::string::npos) << message;
    EXPECT_NE(message.find("lasting contact"), std::string::npos) << message;
    auto const time = message.find("at time ");
    ASSERT_NE(time, std::string::npos) << message;
    // A place is rounded, by up to 19 units, and a bounce of this height takes so long.
    double const rounding = 2 / (1 - a) * std::sqrt(2 * 19 * unit() / g);
    EXPECT_NEAR(std::stod(message.substr(time + 8)), rest, 1e-4 + rounding);
  }
}

/// A disc that comes to the ceiling with no velocity left touches it, and falls.
TEST_P(EventExtremes, ADiscThatJustReachesTheCeilingStaysThere)
{
  auto const run = run_of(scene_of(40, 40, 10, elastic, {{0, 14, 0, 10}}, 1.5), 1);
  EXPECT_TRUE(close(states(run), {{0, 19 - 10 * 0.25 / 2, 0, -5}}, 100 * unit()));
}

/// Discs at rest just above the floor, in a box that is periodic in the other direction: their
/// speed says nothing of that of their first bounces, some tens of them in this time.
TEST_P(EventExtremes, DiscsThatBeginAtRestFall)
{
  double const g = 10, gap = 500 * unit();
  Scene scene;
  scene.model = make_model(40, 40, g, elastic, periodic, Boundary::walls);
  scene.discs = {{-3, -19 + gap, 0, 0}, {3, 5, 0, 0}};
  scene.dt = 40 * std::sqrt(2 * gap / g);
  auto const report = run_of(scene, 2)->report();
  EXPECT_GT(report.wall_hits, 10);
  EXPECT_NEAR(report.energy.kinetic + report.energy.potential, report.energy.initial(),
              1e3 * unit() * report.energy.initial());
}

/// 20,000 bounces of an elastic ball, or 1,000: each adds a few roundings to the energy, at random.
TEST_P(EventExtremes, AnElasticBallBouncesForEver)
{
  auto const scene = scene_of(40, 40, 10, elastic, {{0, -14, 0, 0}}, 200);
  auto const& way = GetParam(); // threads take long to begin 16 kernels for each bounce
  bool const is_fast = way.precision == Precision::double_ && way.placement == Placement::serial;
  auto const run = run_of(scene, is_fast ? 200 : 10);
  auto const report = run->report();
  EXPECT_NEAR(static_cast<double>(report.wall_hits), report.time / 2, 1);
  EXPECT_NEAR(report.energy.kinetic + report.energy.potential, report.energy.initial(),
              1e6 * unit() * report.energy.initial());
}

/// Gravity that lifts, and gravity a million times as strong.
TEST_P(EventExtremes, GravityMayLiftOrBeHuge)
{
  auto const lifted = run_of(scene_of(40, 40, -10, elastic, {{0, 14, 0, 0}}, 2), 1);
  EXPECT_EQ(lifted->report().wall_hits, 1);
  EXPECT_TRUE(close(states(lifted), {{0, 14, 0, 0}}, 1e4 * unit()));

  auto const heavy = run_of(scene_of(40, 40, 1e7, elastic, {{0, -14, 0, 0}}, 0.002), 1);
  EXPECT_EQ(heavy->report().wall_hits, 1);
  EXPECT_TRUE(close(states(heavy), {{0, -14, 0, 0}}, 1e8 * unit()));
}

TEST_P(EventExtremes, AStepMayBeShort)
{
  auto const run = run_of(scene_of(40, 40, 9.81, elastic, {{0, 0, 1, 1}}, 1e-300), 3);
  EXPECT_TRUE(close(states(run), {{0, 0, 1, 1}}, 1e-30));
}

} // namespace
} // namespace ricochet::test
