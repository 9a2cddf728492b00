// Sums that are the same in any order.
#include "ricochet/exact_sum.hpp"
#include "support/random.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace ricochet::test {
namespace {

double sum(std::vector<double> const& terms, double scale)
{
  ExactSum total;
  for (double const term : terms)
    total.add(term, scale);
  return total.value(scale);
}

std::vector<double> random_terms(std::size_t count, double size)
{
  Random random(21);
  std::vector<double> terms(count);
  for (auto& term : terms)
    term = random.between(-size, size);
  return terms;
}

TEST(ExactSum, IsTheSameInAnyOrderAndGrouping)
{
  auto const terms = random_terms(1000, 3);
  double const scale = power_scale(3);
  double const expected = sum(terms, scale);
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    auto const order = random_order(terms.size(), seed);
    ExactSum parts[3];
    for (auto const k : order)
      parts[k % 3 == 0 ? 0 : k % 7 == 0 ? 1 : 2].add(terms[k], scale);
    parts[1].merge(parts[2]);
    parts[1].merge(parts[0]);
    EXPECT_EQ(parts[1].value(scale), expected);
  }
}

TEST(ExactSum, LosesNothingToCancellation)
{
  double const scale = power_scale(1e10);
  EXPECT_EQ(sum({1e10, 0x1p-40, -1e10}, scale), 0x1p-40);
  EXPECT_EQ(sum({-1e10, -0x1p-40, 1e10}, scale), -0x1p-40);
  EXPECT_EQ(sum({1e10, -1e10}, scale), 0);
}

// Terms are cut at 2^-90 of the reference, far below the rounding of a double.
TEST(ExactSum, OfManyTermsIsTheTrueSumRoundedOnce)
{
  auto const terms = random_terms(100000, 5e-7);
  long double expected = 0, cut = 0;
  for (double const term : terms) {
    expected += term;
    cut += std::ldexp(5e-7L, -89);
  }
  double const actual = sum(terms, power_scale(5e-7));
  EXPECT_NEAR(actual, static_cast<double>(expected),
              static_cast<double>(cut + std::abs(expected) * 0x1p-52L));
}

TEST(ExactSum, HoldsSumsFarLargerThanTheirTerms)
{
  double const scale = power_scale(1);
  ExactSum total;
  total.add(0x1p+20, scale);
  for (int k = 0; k < 15; ++k) {
    auto const copy = total;
    total.merge(copy);
  }
  EXPECT_EQ(total.value(scale), 0x1p+35);
}

// With quanta of 1. From 2^52 on every double is whole, and all up to the largest term are exact.
TEST(ExactSum, RoundsATermToTheNearestQuantum)
{
  Random random(22);
  std::vector<double> terms{0.0,  -0.0,           0.5,           1.5,    -0.5,
                            -1.5, 0x1p+51 - 0.25, 0x1p+51 + 0.5, 0x1p+52};
  for (int exponent = -3; exponent < 102; ++exponent)
    for (int k = 0; k < 100; ++k)
      terms.push_back(std::ldexp(random.between(-1, 1), exponent));
  for (double const term : terms)
    EXPECT_EQ(sum({term}, 1), std::nearbyint(term)) << term;
}

TEST(ExactSum, IsTheSameOfFewTermsAtATime)
{
  Random random(23);
  double const largest = 0x1p+101; // whose digits are the longest
  for (double const size : {1.0, 0x1p+52, largest}) {
    ExactSum one_by_one, together;
    for (int block = 0; block < 5; ++block) {
      ExactSum own;
      for (int k = 0; k < ExactSum::few; ++k) {
        double const term = block < 3 ? random.between(-size, size) : block == 3 ? size / 2 : -size;
        one_by_one.add(term, 1);
        own.add_one_of_few(term, 1);
      }
      together.merge(own);
      EXPECT_EQ(together.high, one_by_one.high);
      EXPECT_EQ(together.low, one_by_one.low);
      EXPECT_EQ(together.out_of_range, 0);
    }
  }
}

TEST(ExactSum, SaysSoWhenATermIsNotANumberOrTooLarge)
{
  double const scale = power_scale(1);
  EXPECT_TRUE(std::isnan(sum({1, std::nan("")}, scale)));
  EXPECT_TRUE(std::isnan(sum({1, HUGE_VAL}, scale)));
  EXPECT_TRUE(std::isnan(sum({1, -HUGE_VAL}, scale)));
  EXPECT_TRUE(std::isnan(sum({1, 1e30}, scale)));
  EXPECT_TRUE(std::isnan(sum({0x1p+102}, 1)));
  EXPECT_TRUE(std::isnan(sum({-0x1p+102}, 1)));
  ExactSum bad, good;
  bad.add(std::nan(""), scale);
  good.add(1, scale);
  good.merge(bad);
  EXPECT_TRUE(std::isnan(good.value(scale))) << "through a merge, too";
}

TEST(ExactSum, HasAUsableScaleForAnyReference)
{
  for (double const reference : {0.0, 4.9e-324, 1e-300, 1.0, 1e300, HUGE_VAL}) {
    double const scale = power_scale(reference);
    EXPECT_TRUE(std::isnormal(scale)) << reference;
    int exponent = 0;
    EXPECT_EQ(std::frexp(scale, &exponent), 0.5) << "a power of two for " << reference;
  }
}

} // namespace
} // namespace ricochet::test
