// Sums that do not depend on the order of their terms.
#pragma once

#include "ricochet/kokkos_compat.hpp"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

namespace ricochet {

/// A sum of real numbers in fixed point of 115 bits.
///
/// Each term is cut to a whole number of quanta (1/scale, a power of two) and added as an integer,
/// so any order, grouping or number of threads gives the same bits. With the scale of power_scale()
/// a term is cut at 2^-80 of the reference size and the sum may grow to 2^34 times it; a term that
/// leaves that range, or is not finite, makes the sum NaN.
struct ExactSum {
  std::int64_t high = 0;         ///< in units of 2^52 quanta
  std::int64_t low = 0;          ///< quanta, 0 ... 2^52 - 1
  std::int64_t out_of_range = 0; ///< number of terms that could not be represented

  /// Adds `value`; every term of a sum must come with the same `scale`.
  KOKKOS_FORCEINLINE_FUNCTION void add(double value, double scale)
  {
    double const quanta = value * scale;
    constexpr double most = unit * unit * 1024; // 2^114
    if (!(quanta < most && quanta > -most)) {
      ++out_of_range;
      return;
    }
    // Both digits of a number of 53 bits are exact, and have its sign.
    auto const digit = static_cast<std::int64_t>(quanta * (1 / unit));
    high += digit;
    low += static_cast<std::int64_t>(quanta - static_cast<double>(digit) * unit);
    carry();
  }

  KOKKOS_INLINE_FUNCTION void merge(ExactSum const& other)
  {
    high += other.high;
    low += other.low;
    out_of_range += other.out_of_range;
    carry();
  }

  template <class Visit>
  void visit_numbers(std::string const& name, Visit const& visit)
  {
    visit(name + ".high", high);
    visit(name + ".low", low);
    visit(name + ".out_of_range", out_of_range);
  }

  /// The sum, rounded to double.
  double value(double scale) const
  {
    if (out_of_range > 0)
      return std::numeric_limits<double>::quiet_NaN();
    return (static_cast<double>(high) * unit + static_cast<double>(low)) / scale;
  }

 private:
  static constexpr int bits = 52;
  static constexpr double unit = 4503599627370496.0; ///< 2^52

  KOKKOS_INLINE_FUNCTION void carry()
  {
    high += low >> bits;
    low &= (std::int64_t{1} << bits) - 1;
  }
};

/// The scale for sums whose terms are at most about `reference` in size: the power of two that
/// makes the quantum 2^-80 of it.
inline double power_scale(double reference)
{
  int exponent = 0;
  if (reference > 0 && std::isfinite(reference))
    std::frexp(reference, &exponent);
  // Keeps the scale itself a normal number for any reference.
  constexpr int widest = 900;
  exponent = exponent > widest ? widest : (exponent < -widest ? -widest : exponent);
  return std::ldexp(1.0, 80 - exponent);
}

} // namespace ricochet
