// The execution spaces that the library is compiled for.
#pragma once

#include "ricochet/kokkos_compat.hpp"

#include <type_traits>

namespace ricochet {

/// Where kernels run unless a run is better served by one thread.
using ParallelSpace = Kokkos::DefaultExecutionSpace;

/// One thread of the host: what small runs use instead of a host backend's threads. Without Kokkos'
/// Serial backend it is the default backend again.
#if defined(KOKKOS_ENABLE_SERIAL)
using SerialSpace = Kokkos::Serial;
#else
using SerialSpace = Kokkos::DefaultHostExecutionSpace;
#endif

/// Whether the two differ.
constexpr bool has_two_spaces = !std::is_same_v<ParallelSpace, SerialSpace>;

/// Whether the default backend is a device with a memory of its own.
constexpr bool parallel_is_device = !shares_host_memory<ParallelSpace>;

/// An execution space as an argument.
template <class Space>
struct SpaceTag {
  using type = Space;
};

/// Calls use(SpaceTag<Space>{}) for the space of one thread or for the parallel one; returns what
/// it returns.
template <class Use>
auto with_space(bool one_thread, Use const& use)
{
  if constexpr (has_two_spaces)
    if (one_thread)
      return use(SpaceTag<SerialSpace>{});
  return use(SpaceTag<ParallelSpace>{});
}

} // namespace ricochet
