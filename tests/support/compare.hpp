// Comparisons of whole states that say which disc differs, by how much, and in which bits.
#pragma once

#include "ricochet/engine.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ricochet::test {

/// EXPECT_TRUE(same_bits(actual, expected)): every number equal bit for bit (so 0 is not -0).
testing::AssertionResult same_bits(std::vector<DiscState> const& actual,
                                   std::vector<DiscState> const& expected);

/// EXPECT_TRUE(close(actual, expected, tolerance)): no number off by more than `tolerance`.
testing::AssertionResult close(std::vector<DiscState> const& actual,
                               std::vector<DiscState> const& expected, double tolerance);

/// EXPECT_TRUE(same_bits(a, b)) for all numbers of two reports.
testing::AssertionResult same_bits(Report const& actual, Report const& expected);

/// EXPECT_TRUE(all_finite(states)).
testing::AssertionResult all_finite(std::vector<DiscState> const& states);

/// The largest energy that a ledger mentions: the scale of its rounding errors.
double scale(EnergyLedger const& energy);

/// Largest distance of a number of `a` from its counterpart in `b`.
double largest_deviation(std::vector<DiscState> const& a, std::vector<DiscState> const& b);

} // namespace ricochet::test
