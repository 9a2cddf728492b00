// The probe that guards reproducible arithmetic.
#include "ricochet/reproducible.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

TEST(Arithmetic, DoesNotFuseMultiplicationsWithAdditions)
{
  Kokkos::DefaultExecutionSpace const parallel;
  Kokkos::DefaultHostExecutionSpace const host;
  EXPECT_FALSE((contracts<double>(parallel)));
  EXPECT_FALSE((contracts<float>(parallel)));
  EXPECT_FALSE((contracts<double>(host)));
  EXPECT_FALSE((contracts<float>(host)));
}

// The numbers of the probe: rounded twice the result is 0, fused it is not. Both must hold, or the
// probe could never ring.
template <class Real>
void expect_probe_can_ring(Real e)
{
  volatile Real const a = 1 + e, b = 1 - e;
  volatile Real const product = a * b;
  EXPECT_EQ(product - 1, 0);
  EXPECT_NE(std::fma(Real{a}, Real{b}, Real(-1)), 0);
}

TEST(Arithmetic, WouldBeCaughtIfItDid)
{
  expect_probe_can_ring<double>(0x1p-27);
  expect_probe_can_ring<float>(0x1p-13f);
}

} // namespace
} // namespace ricochet::test
