// Scans of engines that work at the same time, each in a thread of its own.
#include "ricochet/kokkos_compat.hpp"
#include "ricochet/spaces.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ricochet {
namespace {

constexpr int length = 1000;

// Not inlined, so that the sum has to be in memory, where another scan could find it.
KOKKOS_FUNCTION __attribute__((noinline)) void add(int& sum, int number)
{
  sum += number;
}

/// Replaces the ones in `v` by how many are before them.
void count_ones(SerialSpace const& space, Kokkos::View<int*, SerialSpace> const& v)
{
  scan(
      "ricochet::test_scan", space, length, KOKKOS_LAMBDA(int i, int& before, bool final) {
        int const here = v(i);
        if (final)
          v(i) = before;
        add(before, here);
      });
}

// True if `rounds` scans in this thread all come out right.
bool all_right(int rounds)
{
  auto const space = own_instance<SerialSpace>();
  Kokkos::View<int*, SerialSpace> const v("ricochet::test_ones", length);
  bool right = true;
  for (int round = 0; round < rounds; ++round) {
    Kokkos::deep_copy(space, v, 1);
    count_ones(space, v);
    for (int i = 0; i < length; ++i)
      right = right && v(i) == i;
  }
  return right;
}

TEST(Scan, OfOneThreadIsNotDisturbedByThatOfAnother)
{
  if (!one_at_a_time<SerialSpace>)
    GTEST_SKIP() << "Kokkos was built without Serial";
  constexpr int threads = 4;
  std::vector<char> right(threads, 0);
#if defined(KOKKOS_ENABLE_OPENMP)
#pragma omp parallel for schedule(static, 1) num_threads(threads)
#endif
  for (int k = 0; k < threads; ++k)
    right[static_cast<std::size_t>(k)] = all_right(20000);
  EXPECT_EQ(right, std::vector<char>(threads, 1));
}

} // namespace
} // namespace ricochet
