// Sums that do not depend on the order of their terms.
#pragma once

#include "ricochet/kokkos_compat.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>

namespace ricochet {

/// A sum of real numbers in fixed point of 115 bits.
///
/// Each term is rounded to a whole number of quanta (1/scale, a power of two) and added as an
/// integer, so any order, grouping or number of threads gives the same bits. With the scale of
/// power_scale() a quantum is 2^-80 of the reference size; a term may be 2^22 times that size and
/// the sum may grow to 2^34 times it. A larger term, or one that is not finite, makes the sum NaN.
struct ExactSum {
  std::int64_t high = 0;         ///< in units of 2^52 quanta
  std::int64_t low = 0;          ///< quanta, 0 ... 2^52 - 1
  std::int64_t out_of_range = 0; ///< number of terms that could not be represented

  /// Adds `value`; every term of a sum must come with the same `scale`.
  KOKKOS_FORCEINLINE_FUNCTION void add(double value, double scale)
  {
    add_one_of_few(value, scale);
    carry();
  }

  /// Most terms that a sum may get by add_one_of_few() before it is merged into another.
  static constexpr int few = 1024;

  /// The same for a sum of a few terms. It has no branch, and one term does not wait for the one
  /// before, so that compilers can add several at a time.
  KOKKOS_FORCEINLINE_FUNCTION void add_one_of_few(double value, double scale)
  {
    constexpr double most = unit * unit / 4; // both digits are below 2^51
    double const quanta = value * scale;
    bool const fits = quanta < most && quanta > -most;
    double const in_range = fits ? quanta : 0;
    out_of_range += fits ? 0 : 1;
    Rounded const digit(in_range * (1 / unit)), rest(in_range - digit.value * unit);
    high += digit.integer;
    low += rest.integer;
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

  /// A number of up to 2^51 rounded to an integer. Between 2^52 and 2^53 doubles are a unit apart,
  /// so adding 1.5 2^52 rounds it and leaves the integer in the lower bits.
  struct Rounded {
    std::int64_t integer;
    double value;

    explicit KOKKOS_FORCEINLINE_FUNCTION Rounded(double number)
    {
      constexpr double shift = 1.5 * unit;
      constexpr std::int64_t bits_of_shift = 0x4338000000000000;
      double const shifted = number + shift;
      memcpy(&integer, &shifted, sizeof integer);
      integer -= bits_of_shift;
      value = shifted - shift;
    }
  };

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
