// Numbers are read strictly and printed exactly.
#include "text.hpp"

#include "same_bits.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>

namespace ricochet::driver {
namespace {

TEST(Text, EveryFiniteDoubleReadsBackToTheSameBits)
{
  std::mt19937_64 bits(1);
  for (int n = 0; n < 200000; ++n) {
    std::uint64_t const pattern = bits();
    double value = 0, back = 0;
    std::memcpy(&value, &pattern, sizeof value);
    if (!std::isfinite(value))
      continue;
    ASSERT_EQ(parse_decimal(shortest(value), back), NumberError::none) << shortest(value);
    ASSERT_TRUE(test::same_bits(value, back)) << shortest(value);
  }
  for (double const value : {0.0, -0.0, 5e-324, std::numeric_limits<double>::max(), 0.1}) {
    double back = 1;
    ASSERT_EQ(parse_decimal(shortest(value), back), NumberError::none);
    EXPECT_TRUE(test::same_bits(value, back)) << shortest(value);
  }
}

TEST(Text, ShortestIsShort)
{
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(-40), "-40");
  EXPECT_EQ(shortest(1e22), "1e+22");
}

TEST(Text, DecimalNumbersAreAcceptedAsPeopleWriteThem)
{
  struct {
    char const* word;
    double value;
  } const good[] = {{"1", 1},      {"-1.5", -1.5}, {"+2", 2}, {".5", .5}, {"5.", 5},
                    {"2e3", 2000}, {"1E-2", .01},  {"-0", 0}, {"007", 7}, {"1e308", 1e308}};
  for (auto const& [word, value] : good) {
    double read = -99;
    EXPECT_EQ(parse_decimal(word, read), NumberError::none) << word;
    EXPECT_EQ(read, value) << word;
  }
}

TEST(Text, WhatIsNotADecimalNumberIsNamed)
{
  struct {
    char const* word;
    NumberError error;
  } const bad[] = {{"", NumberError::empty},
                   {"x", NumberError::not_a_number},
                   {"1x", NumberError::not_a_number},
                   {"1 ", NumberError::not_a_number},
                   {"--1", NumberError::not_a_number},
                   {"+-1", NumberError::not_a_number},
                   {"+", NumberError::not_a_number},
                   {"1e", NumberError::not_a_number},
                   {"1.2.3", NumberError::not_a_number},
                   {"0x10", NumberError::hexadecimal},
                   {"-0X1p3", NumberError::hexadecimal},
                   {"nan", NumberError::not_finite},
                   {"-NaN(1)", NumberError::not_finite},
                   {"inf", NumberError::not_finite},
                   {"-Infinity", NumberError::not_finite},
                   {"1e999", NumberError::range},
                   {"-1e999", NumberError::range}};
  for (auto const& [word, error] : bad) {
    double value = 0;
    EXPECT_EQ(parse_decimal(word, value), error)
        << word << " " << explain(parse_decimal(word, value));
  }
}

TEST(Text, IntegersHaveNoFraction)
{
  std::int64_t value = 0;
  EXPECT_EQ(parse_integer("+45", value), NumberError::none);
  EXPECT_EQ(value, 45);
  EXPECT_EQ(parse_integer("45.0", value), NumberError::not_an_integer);
  EXPECT_EQ(parse_integer("1e3", value), NumberError::not_an_integer);
  EXPECT_EQ(parse_integer("99999999999999999999", value), NumberError::range);
  EXPECT_EQ(parse_integer("0x1f", value), NumberError::hexadecimal);
  EXPECT_EQ(parse_integer("", value), NumberError::empty);
}

TEST(Text, UnprintableBytesAreShownAndLongWordsCut)
{
  EXPECT_EQ(in_quotes(std::string("a\0\xffz", 4)), "'a\\x00\\xffz'");
  EXPECT_EQ(in_quotes(std::string(50, 'a')), "'" + std::string(40, 'a') + "...'");
}

TEST(Text, OnlyACloseWordIsSuggested)
{
  std::vector<std::string> const keys{"alpha", "beta", "g", "totTime"};
  EXPECT_EQ(did_you_mean("apha", keys), "did you mean 'alpha'?");
  EXPECT_EQ(did_you_mean("ALPHA", keys), "did you mean 'alpha'?");
  EXPECT_EQ(did_you_mean("tottime", keys), "did you mean 'totTime'?");
  EXPECT_EQ(did_you_mean("gravity", keys), "");
  EXPECT_EQ(did_you_mean("x", keys), "");
}

} // namespace
} // namespace ricochet::driver
