// Counter-based random numbers: the k-th number of a seed is a function of (seed, k) alone, made
// with integer arithmetic and one exact multiplication, so it is the same on every machine.
#pragma once

#include <cstdint>

namespace ricochet::test {

/// The k-th output of the generator splitmix64 (Steele, Lea & Flood 2014) started at `seed`.
constexpr std::uint64_t random_bits(std::uint64_t seed, std::uint64_t k)
{
  std::uint64_t z = seed + (k + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// A stream of numbers, for scenes and permutations.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {}

  std::uint64_t bits() { return random_bits(seed_, counter_++); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in [lo, hi), up to rounding.
  double between(double lo, double hi) { return lo + (hi - lo) * unit(); }

  /// Uniform in 0...n-1 (n far below 2^64, so the bias is of no consequence).
  std::uint64_t below(std::uint64_t n) { return bits() % n; }

 private:
  std::uint64_t seed_;
  std::uint64_t counter_ = 0;
};

} // namespace ricochet::test
