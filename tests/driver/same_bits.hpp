// Equality of numbers that tells 0 from -0.
#pragma once

#include "ricochet/model.hpp"

#include <cstdint>
#include <cstring>

namespace ricochet::test {

inline bool same_bits(double a, double b)
{
  std::uint64_t bits_a = 0, bits_b = 0;
  std::memcpy(&bits_a, &a, sizeof a);
  std::memcpy(&bits_b, &b, sizeof b);
  return bits_a == bits_b;
}

inline bool same_bits(DiscState const& a, DiscState const& b)
{
  return same_bits(a.x, b.x) && same_bits(a.y, b.y) && same_bits(a.vx, b.vx) &&
         same_bits(a.vy, b.vy);
}

} // namespace ricochet::test
