// The motion of a disc that meets nothing: v' = v - g dt, x' = x + v' dt, with the new velocity.
#include "support/compare.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

class Flight : public testing::TestWithParam<Way> {};

// Everything is a small multiple of a power of two, so that no operation rounds, in either
// precision: the closed form holds exactly.
TEST_P(Flight, OverAnyNumberOfStepsHasItsClosedForm)
{
  double const dt = 1.0 / 64, gravity = 8, vx = -1.5, vy = 3;
  Scene scene;
  scene.model = make_model(4096, 4096, gravity, {});
  scene.dt = dt;
  scene.discs = {{100, 200, vx, vy}};
  auto const engine = start(scene, GetParam());
  for (int k = 1; k <= 500; ++k) {
    engine->advance(1);
    DiscState const expected{100 + k * vx * dt,
                             200 + k * vy * dt - gravity * dt * dt * k * (k + 1) / 2, vx,
                             vy - k * gravity * dt};
    ASSERT_TRUE(same_bits(states(engine), {expected})) << "step " << k;
  }
}

// With numbers that do round: k steps make at most 4 k roundings of numbers up to 300.
TEST_P(Flight, HasItsClosedFormUpToRounding)
{
  int const k = 100;
  double const dt = 1.0 / 45, gravity = 9.81;
  Scene scene;
  scene.model = make_model(740, 740, gravity, {});
  scene.discs = {{-33.3343, 241.8407, 59.6842, -13.74}};
  auto const d = scene.discs[0];
  DiscState const expected{d.x + k * d.vx * dt,
                           d.y + k * d.vy * dt - gravity * dt * dt * k * (k + 1) / 2, d.vx,
                           d.vy - k * gravity * dt};
  EXPECT_TRUE(close(states_after(scene, GetParam(), k), {expected},
                    4 * k * 300 * round_off(GetParam().precision)));
}

TEST_P(Flight, WithoutGravityIsStraightAndKeepsItsVelocityToTheBit)
{
  Scene scene;
  scene.model = make_model(740, 740, 0, {});
  scene.discs = {{0.5, -0.25, 59.6842, -13.74}};
  double const vx = scene.discs[0].vx, vy = scene.discs[0].vy;
  auto const after = states_after(scene, GetParam(), 100)[0];
  bool const single = GetParam().precision == Precision::single_;
  EXPECT_EQ(after.vx, single ? double{static_cast<float>(vx)} : vx);
  EXPECT_EQ(after.vy, single ? double{static_cast<float>(vy)} : vy);
  EXPECT_NEAR(after.y, -0.25 + 100 * vy / 45, 300 * 100 * round_off(GetParam().precision));
}

TEST_P(Flight, UnderNegativeGravityRises)
{
  Scene scene;
  scene.model = make_model(64, 64, -8, {});
  scene.dt = 1.0 / 64;
  scene.discs = {{0, 0, 0, 0}};
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 8), {{0, 36.0 / 512, 0, 1}}));
}

// A torus: the position is the free one modulo the length of the axis, in [-L/2, L/2).
TEST_P(Flight, OnPeriodicAxesComesBackOnTheOtherSide)
{
  Scene scene;
  scene.model = make_model(32, 16, 0, {}, Boundary::periodic, Boundary::periodic);
  scene.dt = 1.0 / 64;
  scene.discs = {{10, 3, 24, -40}};
  auto const engine = start(scene, GetParam());
  for (int k = 1; k <= 300; ++k) {
    engine->advance(1);
    double const x = 10 + k * 24 / 64.0, y = 3 - k * 40 / 64.0;
    DiscState const expected{x - 32 * std::floor((x + 16) / 32), y - 16 * std::floor((y + 8) / 16),
                             24, -40};
    ASSERT_TRUE(same_bits(states(engine), {expected})) << "step " << k;
  }
}

// The upper end of a periodic axis is the lower one.
TEST_P(Flight, StartsInsideThePeriod)
{
  Scene scene;
  scene.model = make_model(32, 16, 0, {}, Boundary::periodic, Boundary::periodic);
  scene.discs = {{16, 8, 0, 0}, {-16, 0, 0, 0}};
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 0), {{-16, -8, 0, 0}, {-16, 0, 0, 0}}));
}

TEST_P(Flight, IsTheSameForEveryDiscOfACrowdThatDoesNotMeet)
{
  Scene scene;
  scene.model = make_model(4096, 4096, 8, {});
  scene.dt = 1.0 / 64;
  for (int row = 0; row < 50; ++row)
    for (int column = 0; column < 50; ++column)
      scene.discs.push_back({-1000.0 + 40 * column, -1000.0 + 40 * row, 4, 8});
  auto expected = scene.discs;
  int const k = 32;
  for (auto& d : expected)
    d = {d.x + k * 4 / 64.0, d.y + k * 8 / 64.0 - 8.0 / 4096 * k * (k + 1) / 2, 4,
         8 - k * 8 / 64.0};
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), k), expected));
}

INSTANTIATE_TEST_SUITE_P(Ways, Flight, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

} // namespace
} // namespace ricochet::test
