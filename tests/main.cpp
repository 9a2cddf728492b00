// Runs the tests of one executable with Kokkos initialised; honours the flags of both.
#include <Kokkos_Core.hpp>
#include <gtest/gtest.h>

int main(int argc, char** argv)
{
  testing::InitGoogleTest(&argc, argv);
  // What Kokkos says as it starts would stand among the names.
  if (testing::GTEST_FLAG(list_tests))
    return RUN_ALL_TESTS();
  Kokkos::ScopeGuard const kokkos(argc, argv);
  return RUN_ALL_TESTS();
}
