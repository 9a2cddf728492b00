// What a state hash stands for: the states in id order, all of their bits, and nothing else.
#include "support/compare.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace ricochet::test {
namespace {

Scene some_scene()
{
  Scene scene;
  scene.model = make_model(30, 20, 0, {Law::restitution, 0.9, 0.9});
  scene.discs = random_discs(scene.model, 50, 5, Ids::shuffled, 31);
  return scene;
}

std::uint64_t hash(std::vector<DiscState> const& discs, Way const& way)
{
  auto scene = some_scene();
  scene.discs = discs;
  return start(scene, way)->state_hash();
}

class StateHash : public testing::TestWithParam<Way> {};

TEST_P(StateHash, IsTheSameForTheSameStatesHoweverTheyCameAbout)
{
  auto const scene = some_scene();
  auto const engine = start(scene, GetParam());
  engine->advance(10);
  EXPECT_EQ(engine->state_hash(), hash(states(engine), GetParam()));
  EXPECT_EQ(engine->state_hash(), engine->state_hash()) << "asking does not change it";
}

TEST_P(StateHash, ChangesWithTheLastBitOfEveryNumberAndWithTheOrderOfDiscs)
{
  auto const discs = some_scene().discs;
  std::set<std::uint64_t> hashes{hash(discs, GetParam())};
  std::size_t states = 1;
  for (std::size_t k = 0; k < discs.size(); ++k)
    for (auto const field : {&DiscState::x, &DiscState::y, &DiscState::vx, &DiscState::vy}) {
      auto changed = discs;
      double& number = changed[k].*field;
      number = GetParam().precision == Precision::double_
                   ? std::nextafter(number, 0.0)
                   : double{std::nextafter(static_cast<float>(number), 0.0f)};
      hashes.insert(hash(changed, GetParam()));
      ++states;
    }
  for (std::size_t k = 1; k < discs.size(); ++k) {
    auto swapped = discs;
    std::swap(swapped[0], swapped[k]);
    hashes.insert(hash(swapped, GetParam()));
    ++states;
  }
  auto fewer = discs;
  fewer.pop_back();
  hashes.insert(hash(fewer, GetParam()));
  ++states;
  EXPECT_EQ(hashes.size(), states) << "every change gives another hash";
}

TEST_P(StateHash, TellsZeroFromMinusZero)
{
  auto discs = some_scene().discs;
  discs[7].vx = 0;
  auto const zero = hash(discs, GetParam());
  discs[7].vx = -0.0;
  EXPECT_NE(hash(discs, GetParam()), zero);
}

// Numbers that single precision holds exactly hash alike in both.
TEST(StateHash, IsOfTheNumbersAndNotOfTheirFormat)
{
  std::vector<DiscState> const discs = {{1, 2, 3, 4}, {-4, 0.5, 0.25, -8}};
  std::set<std::uint64_t> hashes;
  for (auto const& way : all_ways())
    hashes.insert(hash(discs, way));
  EXPECT_EQ(hashes.size(), 1u);
}

INSTANTIATE_TEST_SUITE_P(Ways, StateHash, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

} // namespace
} // namespace ricochet::test
