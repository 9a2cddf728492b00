// The wall rule: at most one wall a step, in the order left, right, top, bottom; the position is
// mirrored, the normal velocity multiplied by -alpha, the tangential by beta.
#include "support/compare.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ricochet::test {
namespace {

constexpr double alpha = 0.5, beta = 0.25;

/// One disc of radius 1 in a box of 32 x 16, weightless; one step lasts 1/64. All numbers are
/// multiples of powers of two, so that no operation rounds.
Scene lone_disc(DiscState const& disc, double elastic = alpha, double friction = beta)
{
  Scene scene;
  scene.model = make_model(32, 16, 0, {Law::swap_scale, elastic, friction});
  scene.dt = 1.0 / 64;
  scene.discs = {disc};
  return scene;
}

class Walls : public testing::TestWithParam<Way> {
 protected:
  static void expect_step(DiscState const& before, DiscState const& after)
  {
    EXPECT_TRUE(same_bits(states_after(lone_disc(before), GetParam(), 1), {after}));
  }
};

// Each disc would be 1/4 beyond the wall, and ends 1/4 in front of it.
TEST_P(Walls, MirrorThePositionAndScaleTheVelocity)
{
  expect_step({-14.75, 2, -32, 8}, {-14.75, 2.125, 32 * alpha, 8 * beta});
  expect_step({14.75, 2, 32, 8}, {14.75, 2.125, -32 * alpha, 8 * beta});
  expect_step({2, 6.75, 8, 32}, {2.125, 6.75, 8 * beta, -32 * alpha});
  expect_step({2, -6.75, 8, -32}, {2.125, -6.75, 8 * beta, 32 * alpha});
}

TEST_P(Walls, AreNotMetByADiscThatJustTouches)
{
  expect_step({14.5, 2, 32, 8}, {15, 2.125, 32, 8});
  expect_step({2, -6.5, 8, -32}, {2.125, -7, 8, -32});
}

// A disc beyond two walls meets the earlier in the order left, right, top, bottom, and the other in
// the next step.
TEST_P(Walls, AreMetOneAStepInTheOrderLeftRightTopBottom)
{
  for (double const side : {-1.0, 1.0})
    for (double const end : {-1.0, 1.0})
      expect_step({side * 14.75, end * 6.75, side * 32, end * 32},
                  {side * 14.75, end * 7.25, side * -32 * alpha, end * 32 * beta});

  // After that the normal velocity is 8 upwards: the disc goes on to 7.375 and meets the top.
  auto const second = states_after(lone_disc({14.75, 6.75, 32, 32}), GetParam(), 2);
  EXPECT_TRUE(same_bits(second, {{14.75 - 0.25, 6.625, -16 * beta, -8 * alpha}}));
}

// A disc that was moved out by a push comes back at once, whichever way it flies.
TEST_P(Walls, MirrorADiscThatStartsBeyondThem)
{
  expect_step({15.5, 0, 0, 8}, {14.5, 0.125, -0.0, 8 * beta});
}

TEST_P(Walls, ThatAreElasticOnlyReverseTheNormalVelocity)
{
  EXPECT_TRUE(same_bits(states_after(lone_disc({-14.75, 2, -32, 8}, 1, 1), GetParam(), 1),
                        {{-14.75, 2.125, 32, 8}}));
}

TEST_P(Walls, AreAbsentOnAPeriodicAxis)
{
  auto scene = lone_disc({-14.75, 2, -32, 8});
  scene.model.box.x = Boundary::periodic;
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 1), {{-15.25, 2.125, -32, 8}}));
  scene = lone_disc({2, 6.75, 8, 32});
  scene.model.box.y = Boundary::periodic;
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 1), {{2.125, 7.25, 8, 32}}));
}

TEST_P(Walls, BookEveryHitAndItsLoss)
{
  auto const report = report_after(lone_disc({-14.75, 2, -32, 8}), GetParam(), 1);
  EXPECT_EQ(report.wall_hits, 1);
  EXPECT_EQ(report.energy.lost_walls,
            (32 * 32 * (1 - alpha * alpha) + 8 * 8 * (1 - beta * beta)) / 2);
  EXPECT_EQ(report.energy.numerical, 0) << "a mirrored x costs nothing";
  EXPECT_EQ(report_after(lone_disc({0, 0, -32, 8}), GetParam(), 1).wall_hits, 0);
}

// The mirrored height is energy that the method makes: g times the change of y.
TEST_P(Walls, BookTheMirroredHeightAsNumerical)
{
  auto scene = lone_disc({2, -6.75, 8, -24}, 1, 1);
  scene.model.gravity = 512; // 8 a step
  auto const report = report_after(scene, GetParam(), 1);
  double const mirror = 512 * 0.5, flight = -8 * 8 / 2.0;
  EXPECT_EQ(report.energy.numerical, mirror + flight);
  EXPECT_EQ(report.energy.residual(), 0);
}

INSTANTIATE_TEST_SUITE_P(Ways, Walls, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

/// Heights of the apexes of a ball that bounces on the floor, measured from where it rests.
std::vector<double> apexes(Scene const& scene, std::int64_t steps)
{
  auto const engine = start(scene, {EngineKind::sweep, Precision::double_, Placement::serial});
  double const floor = -scene.model.box.height / 2 + scene.model.radius;
  std::vector<double> result;
  double rising = 0;
  for (std::int64_t step = 0; step < steps; ++step) {
    engine->advance(1);
    auto const ball = states(engine)[0];
    if (ball.vy > 0)
      rising = ball.y - floor;
    else if (rising > 0) {
      result.push_back(rising);
      rising = 0;
    }
  }
  return result;
}

// The n-th apex is alpha^2n of the height it fell from. The mirror and the kick of a step move the
// turning point by up to v dt in each bounce, with v the speed of the impact.
TEST(BouncingBall, RisesToAlphaSquaredOfItsHeightEachTime)
{
  double const height = 5, elastic = 0.8;
  Scene scene;
  scene.model = make_model(10, 20, 10, {Law::restitution, elastic, 1});
  scene.dt = 1e-4;
  scene.discs = {{0, -9 + height, 0, 0}};
  auto const found = apexes(scene, 65000);
  ASSERT_GE(found.size(), 5u);
  double expected = height, tolerance = 0;
  for (std::size_t n = 0; n < 5; ++n) {
    tolerance += 2 * std::sqrt(2 * 10 * expected) * scene.dt;
    expected *= elastic * elastic;
    EXPECT_NEAR(found[n], expected, tolerance) << "apex " << n + 1;
  }
}

// The n-th impact of a ball dropped from h is at sqrt(2h/g) (1 + 2 (alpha + ... + alpha^(n-1))).
TEST(BouncingBall, HitsTheFloorWhenTheClosedFormSays)
{
  double const height = 5, elastic = 0.8, gravity = 10;
  Scene scene;
  scene.model = make_model(10, 20, gravity, {Law::restitution, elastic, 1});
  scene.dt = 1e-4;
  scene.discs = {{0, -9 + height, 0, 0}};
  auto const engine = start(scene, {EngineKind::sweep, Precision::double_, Placement::serial});
  double const fall = std::sqrt(2 * height / gravity);
  double expected = fall, power = 1;
  std::int64_t step = 0;
  for (int impact = 1; impact <= 5; ++impact) {
    while (engine->report().wall_hits < impact && step < 100000) {
      engine->advance(1);
      ++step;
    }
    // Each bounce errs by a step or so, and by what the apex above errs.
    EXPECT_NEAR(static_cast<double>(step) * scene.dt, expected, 4 * impact * scene.dt)
        << "impact " << impact;
    power *= elastic;
    expected += 2 * fall * power;
  }
}

} // namespace
} // namespace ricochet::test
