// The tools of the tests: comparers that cannot fail would prove nothing.
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::test {
namespace {

std::vector<DiscState> const some{{1, 2, 3, 4}, {5, 6, 7, 0}};

TEST(Comparers, SeeEveryBit)
{
  EXPECT_TRUE(same_bits(some, some));
  for (auto const field : {&DiscState::x, &DiscState::y, &DiscState::vx, &DiscState::vy}) {
    auto changed = some;
    changed[1].*field = std::nextafter(changed[1].*field, 10.0);
    EXPECT_FALSE(same_bits(changed, some));
  }
  auto negative = some;
  negative[1].vy = -0.0;
  EXPECT_FALSE(same_bits(negative, some));
  EXPECT_FALSE(same_bits({some[0]}, some)) << "a missing disc";
}

TEST(Comparers, SeeADeviationBeyondTheToleranceAndNotANumber)
{
  auto changed = some;
  changed[0].vx += 0.25;
  EXPECT_TRUE(close(changed, some, 0.25));
  EXPECT_FALSE(close(changed, some, 0.2));
  EXPECT_EQ(largest_deviation(changed, some), 0.25);
  changed[0].vx = std::nan("");
  EXPECT_FALSE(close(changed, some, 1e300));
  EXPECT_FALSE(all_finite(changed));
  EXPECT_TRUE(all_finite(some));
}

TEST(Comparers, SeeEveryNumberOfAReport)
{
  Report const report;
  EXPECT_TRUE(same_bits(report, report));
  auto const expect_seen = [&](auto const& change) {
    auto changed = report;
    change(changed);
    EXPECT_FALSE(same_bits(changed, report));
  };
  expect_seen([](Report& r) { r.steps = 1; });
  expect_seen([](Report& r) { r.collisions = 1; });
  expect_seen([](Report& r) { r.max_overlap = 4.9e-324; });
  expect_seen([](Report& r) { r.energy.numerical = -0.0; });
  expect_seen([](Report& r) { r.pressure_z = 0; });
}

// First outputs of splitmix64 for seed 1234567, as published with the generator.
TEST(Random, IsTheGeneratorItSaysItIs)
{
  EXPECT_EQ(random_bits(1234567, 0), 6457827717110365317u);
  EXPECT_EQ(random_bits(1234567, 1), 3203168211198807973u);
  EXPECT_EQ(random_bits(1234567, 2), 9817491932198370423u);
}

TEST(Scenes, KeepTheirDiscsInTheBoxAndUseItAll)
{
  auto const model = make_model(30, 20, 0, {});
  for (auto const ids : {Ids::shuffled, Ids::row_major, Ids::reversed}) {
    auto const discs = random_discs(model, 500, 3, ids, 1);
    EXPECT_TRUE(problems(model, discs).empty());
    auto const [low, high] = std::minmax_element(
        discs.begin(), discs.end(), [](auto const& a, auto const& b) { return a.y < b.y; });
    EXPECT_LT(low->y, -9);
    EXPECT_GT(high->y, 9);
  }
  auto const rows = random_discs(model, 500, 3, Ids::row_major, 1);
  EXPECT_LT(rows.front().y, -8);
  EXPECT_GT(rows.back().y, 8);
}

TEST(Scenes, HaveThePackingAskedFor)
{
  for (double const packing : {0.05, 0.9, 1.1}) {
    double const height = height_for(700, packing, 1.3);
    auto const model = make_model(1.3 * height, height, 0, {});
    EXPECT_NEAR(packing_fraction(model, 700), packing, 1e-12);
  }
}

TEST(Scenes, PutALatticeDownWithoutOverlap)
{
  auto const model = make_model(41, 83, 0, {});
  EXPECT_EQ(deepest_overlap(model, lattice_discs(model, 700, 1, 1)), 0);
}

} // namespace
} // namespace ricochet::test
