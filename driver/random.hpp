// Counter-based random numbers: the k-th number of a stream is a function of (seed, stream, k) and
// nothing else, made of integer arithmetic and + - * /, so it is the same on every machine.
#pragma once

#include <cstdint>

namespace ricochet::driver {

class Random {
 public:
  /// Streams of different number are independent of each other.
  Random(std::uint64_t seed, std::uint64_t stream) : key_(mixed(mixed(seed) + stream)) {}

  std::uint64_t bits() { return mixed(key_ + ++counter_ * 0x9e3779b97f4a7c15u); }

  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

  /// Uniform in 0...n-1, for n far below 2^64.
  std::uint64_t below(std::uint64_t n) { return bits() % n; }

  /// Normally distributed, with mean 0 and variance 1, exactly but for the grain of unit().
  ///
  /// Algorithm N of Karney, Sampling exactly from the normal distribution (2016), doi
  /// 10.1145/2710016, in which nothing is computed but comparisons and products: the integer part
  /// k and the rest x of |value| = k + x are proposed with density e^(-k/2) and kept with
  /// probability e^(-k(k-1)/2) e^(-x(2k+x)/2), which together is e^(-(k+x)^2/2).
  double normal()
  {
    for (;;) {
      int k = 0;
      while (happens(0.5))
        ++k;
      double const x = unit();
      bool kept = true;
      for (int trial = 0; kept && trial < k * (k - 1); ++trial)
        kept = happens(0.5);
      for (int trial = 0; kept && trial <= k; ++trial)
        kept = happens(x * (2 * k + x) / (2 * k + 2));
      if (kept)
        return (bits() & 1) != 0 ? k + x : -(k + x);
    }
  }

 private:
  // The finaliser of splitmix64 (Steele, Lea & Flood 2014).
  static std::uint64_t mixed(std::uint64_t z)
  {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  /// True with probability e^-x, for 0 <= x <= 1: the length of the run of descending numbers that
  /// begins with x is even that often (von Neumann 1951).
  bool happens(double x)
  {
    bool even = true;
    for (double last = x;; even = !even) {
      double const next = unit();
      if (!(next < last))
        return even;
      last = next;
    }
  }

  std::uint64_t key_;
  std::uint64_t counter_ = 0;
};

} // namespace ricochet::driver
