// Collisions as engine `sweep` makes them: in the order of ids, in place, the second disc pushed
// out.
#include "support/compare.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

constexpr double pi = 3.14159265358979323846;

/// Two discs of radius 1, overlapping by 1/8, the second at `angle` from the first; the closing
/// speed is 3 along the line of centres, and they slide past each other at 1.
Scene encounter(double angle, Contact const& contact)
{
  double const c = std::cos(angle), s = std::sin(angle), distance = 1.875;
  Scene scene;
  scene.model = make_model(40, 30, 0, contact);
  scene.dt = 1.0 / 64;
  scene.discs = {{0.5, -0.25, 2 * c - 0.5 * s, 2 * s + 0.5 * c},
                 {0.5 + distance * c, -0.25 + distance * s, -c + 0.5 * s, -s - 0.5 * c}};
  return scene;
}

/// Components of a velocity along and across a direction.
struct Components {
  double normal, tangential;
};
Components components(DiscState const& d, double angle)
{
  double const c = std::cos(angle), s = std::sin(angle);
  return {d.vx * c + d.vy * s, d.vy * c - d.vx * s};
}

class Contacts : public testing::TestWithParam<Way> {
 protected:
  /// The angle of the normal comes out of positions and sqrt with a few roundings.
  double tolerance() const { return 32 * 3 * round_off(GetParam().precision); }
};

TEST_P(Contacts, ThatAreElasticExchangeTheNormalVelocitiesAtAnyAngle)
{
  for (int k = 0; k < 16; ++k) {
    double const angle = (k + 0.1) * 2 * pi / 16;
    SCOPED_TRACE(angle);
    auto const after = states_after(encounter(angle, {Law::swap_scale, 1, 1}), GetParam(), 1);
    auto const first = components(after[0], angle), second = components(after[1], angle);
    EXPECT_NEAR(first.normal, -1, tolerance());
    EXPECT_NEAR(second.normal, 2, tolerance());
    EXPECT_NEAR(first.tangential, 0.5, tolerance());
    EXPECT_NEAR(second.tangential, -0.5, tolerance());
  }
}

TEST_P(Contacts, UnderRestitutionReverseTheRelativeVelocityTimesAlphaAtAnyAngle)
{
  double const alpha = 0.7, beta = 0.4;
  for (int k = 0; k < 16; ++k) {
    double const angle = (k + 0.1) * 2 * pi / 16;
    SCOPED_TRACE(angle);
    auto const after =
        states_after(encounter(angle, {Law::restitution, alpha, beta}), GetParam(), 1);
    auto const first = components(after[0], angle), second = components(after[1], angle);
    EXPECT_NEAR(second.normal - first.normal, 3 * alpha, tolerance());
    EXPECT_NEAR(second.tangential - first.tangential, -1 * beta, tolerance());
    EXPECT_NEAR(second.normal + first.normal, 1, tolerance()) << "momentum";
    EXPECT_NEAR(second.tangential + first.tangential, 0, tolerance()) << "momentum";
  }
}

TEST_P(Contacts, UnderSwapScaleSwapTimesAlphaAndScaleByBetaAtAnyAngle)
{
  double const alpha = 0.7, beta = 0.4;
  for (int k = 0; k < 16; ++k) {
    double const angle = (k + 0.1) * 2 * pi / 16;
    SCOPED_TRACE(angle);
    auto const after =
        states_after(encounter(angle, {Law::swap_scale, alpha, beta}), GetParam(), 1);
    auto const first = components(after[0], angle), second = components(after[1], angle);
    EXPECT_NEAR(first.normal, -1 * alpha, tolerance());
    EXPECT_NEAR(second.normal, 2 * alpha, tolerance());
    EXPECT_NEAR(first.tangential, 0.5 * beta, tolerance());
    EXPECT_NEAR(second.tangential, -0.5 * beta, tolerance());
  }
}

INSTANTIATE_TEST_SUITE_P(Ways, Contacts, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

class Sweep : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Ways, Sweep, testing::ValuesIn(sweep_ways()),
                         [](auto const& way) { return name(way.param); });

// Disc 0 is where its new velocity took it; disc 1 stood 2 away from where disc 0 was, and flew.
TEST_P(Sweep, PushesTheSecondDiscOutOfTheOverlapAndLeavesTheFirst)
{
  for (int k = 0; k < 16; ++k) {
    double const angle = (k + 0.1) * 2 * pi / 16, dt = 1.0 / 64;
    auto const scene = encounter(angle, {Law::restitution, 0.7, 0.4});
    auto const after = states_after(scene, GetParam(), 1);
    double const tolerance = 32 * round_off(GetParam().precision);
    EXPECT_NEAR(after[0].x - after[0].vx * dt, scene.discs[0].x, tolerance);
    EXPECT_NEAR(after[0].y - after[0].vy * dt, scene.discs[0].y, tolerance);
    EXPECT_NEAR(after[1].x - after[1].vx * dt, scene.discs[0].x + 2 * std::cos(angle), tolerance);
    EXPECT_NEAR(after[1].y - after[1].vy * dt, scene.discs[0].y + 2 * std::sin(angle), tolerance);
  }
}

Scene pair(DiscState const& first, DiscState const& second)
{
  Scene scene;
  scene.model = make_model(64, 32, 0, {Law::swap_scale, 1, 1});
  scene.dt = 1.0 / 64;
  scene.discs = {first, second};
  return scene;
}

TEST_P(Sweep, LetsOverlappingDiscsRespondAlsoWhenTheySeparate)
{
  auto const scene = pair({0, 0, -4, 0}, {1.5, 0, 8, 0});
  EXPECT_TRUE(
      same_bits(states_after(scene, GetParam(), 1), {{0.125, 0, 8, 0}, {1.9375, 0, -4, 0}}));
  auto const report = report_after(scene, GetParam(), 1);
  EXPECT_EQ(report.collisions, 1);
  EXPECT_EQ(report.separating_hits, 1);
}

TEST_P(Sweep, CountsAnApproachAsNoSeparatingHit)
{
  auto const report = report_after(pair({0, 0, 4, 0}, {1.5, 0, -4, 0}), GetParam(), 1);
  EXPECT_EQ(report.collisions, 1);
  EXPECT_EQ(report.separating_hits, 0);
}

TEST_P(Sweep, TakesTheNormalPlusXForDiscsWithTheSameCentre)
{
  EXPECT_TRUE(same_bits(states_after(pair({1, 1, 4, 2}, {1, 1, -4, 6}), GetParam(), 1),
                        {{1 - 4 / 64.0, 1 + 2 / 64.0, -4, 2}, {3 + 4 / 64.0, 1 + 6 / 64.0, 4, 6}}));
}

TEST_P(Sweep, DoesNotCollideDiscsThatJustTouch)
{
  EXPECT_EQ(report_after(pair({0, 0, 4, 0}, {2, 0, -4, 0}), GetParam(), 1).collisions, 0);
  EXPECT_EQ(report_after(pair({0, 0, 4, 0}, {std::nextafter(2.0, 0.0), 0, -4, 0}), GetParam(), 1)
                .collisions,
            1);
}

// On a torus the nearest image counts: 0.5 from either side of an edge, 1 apart.
TEST_P(Sweep, CollidesDiscsAcrossAPeriodicEdge)
{
  for (auto const& [first, second] :
       {std::pair<DiscState, DiscState>{{31.5, 0, 4, 0}, {-31.5, 0, -4, 0}},
        {{-31.5, 3, -4, 0}, {31.5, 3, 4, 0}},
        {{5, 15.5, 0, 4}, {5, -15.5, 0, -4}},
        {{31.5, -15.5, 1, 1}, {-31.5, 15.5, -1, -1}}}) {
    auto scene = pair(first, second);
    EXPECT_EQ(report_after(scene, GetParam(), 1).collisions, 0) << "with walls";
    scene.model.box.x = scene.model.box.y = Boundary::periodic;
    EXPECT_EQ(report_after(scene, GetParam(), 1).collisions, 1);
  }

  auto scene = pair({31.5, 0, 4, 0}, {-31.5, 0, -4, 0});
  scene.model.box.x = Boundary::periodic;
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 1),
                        {{31.4375, 0, -4, 0}, {-30.5 + 0.0625, 0, 4, 0}}));
}

TEST_P(Sweep, PutsAPushedDiscBackIntoThePeriod)
{
  auto scene = pair({30.5, 0, 4, 0}, {31.5, 0, -4, 0});
  scene.model.box.x = Boundary::periodic;
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 1),
                        {{30.4375, 0, -4, 0}, {-31.5 + 0.0625, 0, 4, 0}}));
}

/// Five discs in a row, 1/64 of overlap each; the leftmost moves right. `ids` names the order.
Scene cradle(std::vector<std::size_t> const& ids)
{
  Scene scene;
  scene.model = make_model(64, 32, 0, {Law::swap_scale, 1, 1});
  scene.dt = 1.0 / 1024;
  std::vector<DiscState> discs;
  for (int k = 0; k < 5; ++k)
    discs.push_back({k * (2 - 1.0 / 64), 0, k == 0 ? 8.0 : 0.0, 0});
  scene.discs = reordered(discs, ids);
  return scene;
}

// In place and in order: what disc 1 took from disc 0 it hands on to disc 2 in the same step.
TEST_P(Sweep, HandsAnImpulseDownARowOfRisingIdsInOneStep)
{
  auto const after = states_after(cradle({0, 1, 2, 3, 4}), GetParam(), 1);
  for (int k = 0; k < 5; ++k)
    EXPECT_EQ(after[static_cast<std::size_t>(k)].vx, k == 4 ? 8 : 0) << "disc " << k;
}

// With falling ids the pair that holds the impulse comes last, and each step moves it by one disc.
TEST_P(Sweep, HandsAnImpulseUpARowOfFallingIdsByOneDiscAStep)
{
  auto const after = states_after(cradle({4, 3, 2, 1, 0}), GetParam(), 1);
  for (std::size_t k = 0; k < 5; ++k)
    EXPECT_EQ(after[k].vx, k == 3 ? 8 : 0) << "disc " << k;
}

// Pair (0, 1) pushes disc 1 onto disc 2, which it had not touched: they collide in the same step.
TEST_P(Sweep, CollidesDiscsThatAPushBringsTogetherInTheSameStep)
{
  auto scene = pair({0, 0, 4, 0}, {1.5, 0, -4, 0});
  scene.discs.push_back({3.75, 0, 0, 0});
  auto const report = report_after(scene, GetParam(), 1);
  EXPECT_EQ(report.collisions, 2);
  EXPECT_EQ(states_after(scene, GetParam(), 1)[2].vx, 4);
}

// And the other way round: pushed clear of disc 2 before its turn, disc 1 does not meet it.
TEST_P(Sweep, SparesDiscsThatAPushTookApartBeforeTheirTurn)
{
  auto scene = pair({0, 0, 4, 0}, {0.5, 0, -4, 0});
  scene.discs.push_back({0.5, -1.875, 0, 0});
  auto const report = report_after(scene, GetParam(), 1);
  EXPECT_EQ(report.collisions, 2) << "(0, 1) and (0, 2)";
}

} // namespace
} // namespace ricochet::test
