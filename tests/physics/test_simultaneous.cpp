// Engine `simultaneous`: every disc answers to the old states; its last overlapping partner wins.
#include "support/compare.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

namespace ricochet::test {
namespace {

Scene weightless(std::vector<DiscState> const& discs,
                 Contact const& contact = {Law::swap_scale, 1, 1})
{
  Scene scene;
  scene.model = make_model(64, 32, 0, contact);
  scene.dt = 1.0 / 64;
  scene.discs = discs;
  return scene;
}

std::vector<Way> simultaneous_ways()
{
  std::vector<Way> ways;
  for (auto const& way : all_ways())
    if (way.engine == EngineKind::simultaneous)
      ways.push_back(way);
  return ways;
}

class Simultaneous : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Ways, Simultaneous, testing::ValuesIn(simultaneous_ways()),
                         [](auto const& way) { return name(way.param); });

TEST_P(Simultaneous, LeavesOverlapsAsTheyAre)
{
  EXPECT_TRUE(same_bits(states_after(weightless({{0, 0, 4, 0}, {1.5, 0, -4, 0}}), GetParam(), 1),
                        {{-0.0625, 0, -4, 0}, {1.5625, 0, 4, 0}}));
}

// Discs 1 and 2 both overlap disc 0; it takes its velocity from disc 2 alone. Both take theirs from
// it. So 4 became 4 and 4: this is where the energy comes from.
TEST_P(Simultaneous, GivesADiscTheResultOfItsLastPartner)
{
  auto const after =
      states_after(weightless({{0, 0, 4, 0}, {1.5, 0, -8, 0}, {-1.5, 0, 16, 0}}), GetParam(), 1);
  EXPECT_EQ(after[0].vx, 16);
  EXPECT_EQ(after[1].vx, 4);
  EXPECT_EQ(after[2].vx, 4);
}

// A result equal to the old velocity replaces nothing: disc 2 has the velocity of disc 0.
TEST_P(Simultaneous, IgnoresAPartnerWhoseResultChangesNothing)
{
  auto const after =
      states_after(weightless({{0, 0, 4, 0}, {1.5, 0, -8, 0}, {-1.5, 0, 4, 0}}), GetParam(), 1);
  EXPECT_EQ(after[0].vx, -8);
}

TEST_P(Simultaneous, SkipsAPartnerInExactlyTheSameState)
{
  auto const scene = weightless({{0, 0, 4, 2}, {0, 0, 4, 2}}, {Law::restitution, 0.5, 0.5});
  EXPECT_TRUE(same_bits(states_after(scene, GetParam(), 1),
                        {{0.0625, 0.03125, 4, 2}, {0.0625, 0.03125, 4, 2}}));
  EXPECT_EQ(report_after(scene, GetParam(), 1).collisions, 0);

  // Under swap_scale a pair in the same state would be slowed down, were it not skipped.
  auto const slowed = weightless({{0, 0, 4, 2}, {0, 0, 4, 2}}, {Law::swap_scale, 0.5, 0.5});
  EXPECT_EQ(states_after(slowed, GetParam(), 1)[0].vx, 4);
}

TEST_P(Simultaneous, CountsAPairOnce)
{
  auto const report =
      report_after(weightless({{0, 0, 4, 0}, {1.5, 0, -8, 0}, {-1.5, 0, 16, 0}}), GetParam(), 1);
  EXPECT_EQ(report.collisions, 2);
  EXPECT_EQ(report.separating_hits, 0);
}

// Elastic crowds on a torus: no energy is lost anywhere, yet there is more of it, about twice as
// much after 100 steps (it is a multiplicative random walk upwards, so four crowds are averaged),
// and the ledger says that the method made it.
TEST_P(Simultaneous, GainsEnergyAndBooksItAsNumerical)
{
  double gain = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    auto scene = weightless({});
    scene.model.box = {40, 40, Boundary::periodic, Boundary::periodic};
    scene.dt = 1.0 / 45;
    scene.discs = random_discs(scene.model, 400, 20, Ids::shuffled, seed);
    auto const energy = report_after(scene, GetParam(), 100).energy;
    gain += energy.kinetic / energy.kinetic_initial / 4;
    double const rounding = 64 * round_off(GetParam().precision) * energy.kinetic * 100;
    EXPECT_NEAR(energy.lost_pairs, 0, rounding);
    EXPECT_EQ(energy.lost_walls, 0);
    EXPECT_NEAR(energy.numerical, energy.kinetic - energy.kinetic_initial, rounding);
  }
  EXPECT_GT(gain, 1.5);
}

TEST_P(Simultaneous, WarnsThatItGainsEnergy)
{
  auto const engine = start(weightless({{0, 0, 0, 0}}), GetParam());
  bool warned = false;
  for (auto const& warning : engine->warnings())
    warned = warned || warning.find("energy") != std::string::npos;
  EXPECT_TRUE(warned);
}

TEST(Sweep, HasNothingToWarnAboutInAGas)
{
  auto const scene = weightless({{0, 0, 1, 0}, {10, 0, 0, 1}});
  for (auto const& way : sweep_ways())
    EXPECT_TRUE(start(scene, way)->warnings().empty());
}

} // namespace
} // namespace ricochet::test
