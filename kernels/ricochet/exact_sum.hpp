// Sums that do not depend on the order of their terms.
#pragma once

#include "ricochet/kokkos_compat.hpp"

#include <cmath>
#include <cstdint>
#include <limits>

namespace ricochet {

/// A sum of real numbers in 128-bit fixed point.
///
/// Each term is cut to a whole number of quanta (1/scale, a power of two) and added as an integer,
/// so any order, grouping or number of threads gives the same bits. With the scale of power_scale()
/// a term is cut at 2^-90 of the reference size and the sum may grow to 2^37 times it; a sum that
/// leaves that range, or meets a term that is not finite, becomes NaN.
struct ExactSum {
  std::int64_t high = 0;
  std::uint64_t low = 0;
  std::int64_t out_of_range = 0; ///< number of terms that could not be represented

  /// Adds `value`; every term of a sum must come with the same `scale`.
  KOKKOS_INLINE_FUNCTION void add(double value, double scale)
  {
    constexpr double two64 = 18446744073709551616.0, two126 = two64 * 4611686018427387904.0;
    double const quanta = value * scale;
    double const size = quanta < 0 ? -quanta : quanta;
    if (!(size < two126)) {
      ++out_of_range;
      return;
    }
    ExactSum term;
    auto const whole = static_cast<std::uint64_t>(size * (1 / two64));
    term.high = static_cast<std::int64_t>(whole);
    term.low = static_cast<std::uint64_t>(size - static_cast<double>(whole) * two64);
    if (quanta < 0)
      term.negate();
    merge(term);
  }

  KOKKOS_INLINE_FUNCTION void merge(ExactSum const& other)
  {
    low += other.low;
    std::uint64_t const carry = low < other.low ? 1 : 0;
    // Unsigned, where a carry into the sign is defined.
    high = static_cast<std::int64_t>(static_cast<std::uint64_t>(high) +
                                     static_cast<std::uint64_t>(other.high) + carry);
    out_of_range += other.out_of_range;
  }

  /// The sum, rounded once.
  double value(double scale) const
  {
    if (out_of_range > 0)
      return std::numeric_limits<double>::quiet_NaN();
    ExactSum size = *this;
    if (high < 0)
      size.negate();
    double const result =
        std::ldexp(static_cast<double>(size.high), 64) + static_cast<double>(size.low);
    return (high < 0 ? -result : result) / scale;
  }

 private:
  KOKKOS_INLINE_FUNCTION void negate()
  {
    low = ~low + 1;
    high = static_cast<std::int64_t>(~static_cast<std::uint64_t>(high) + (low == 0 ? 1 : 0));
  }
};

/// The scale for sums whose terms are at most about `reference` in size: the power of two that
/// makes the quantum 2^-90 of it.
inline double power_scale(double reference)
{
  int exponent = 0;
  if (reference > 0 && std::isfinite(reference))
    std::frexp(reference, &exponent);
  // Keeps the scale itself a normal number for any reference.
  constexpr int widest = 900;
  exponent = exponent > widest ? widest : (exponent < -widest ? -widest : exponent);
  return std::ldexp(1.0, 90 - exponent);
}

} // namespace ricochet
