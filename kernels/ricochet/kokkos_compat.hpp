// The differences between Kokkos 3.4 and 5.x that the kernels meet, all in one place.
#pragma once

#include <Kokkos_Core.hpp>

#include <string>
#include <type_traits>

namespace ricochet {

// 3.4 keeps the mathematical functions in Kokkos::Experimental, 4.x only in Kokkos.
#if KOKKOS_VERSION < 30700
using Kokkos::Experimental::fabs;
using Kokkos::Experimental::floor;
using Kokkos::Experimental::sqrt;
#else
using Kokkos::fabs;
using Kokkos::floor;
using Kokkos::sqrt;
#endif

/// Uninitialised View: for memory that a kernel fills before anything reads it.
template <class ViewType, class... Extents>
ViewType uninitialised(std::string const& label, Extents... extents)
{
  return ViewType(Kokkos::view_alloc(Kokkos::WithoutInitializing, label), extents...);
}

/// The work items of a kernel on `Space`, counted by int as its functors do: where a kernel's index
/// is wider than its functor's, compilers find no vectors in it.
template <class Space>
using Range = Kokkos::RangePolicy<Space, Kokkos::IndexType<int>>;

/// Work items that take unlike times: threads take a chunk of them as they come to it, instead of
/// an equal share each.
template <class Space>
using UnevenRange =
    Kokkos::RangePolicy<Space, Kokkos::IndexType<int>, Kokkos::Schedule<Kokkos::Dynamic>>;

template <class Space>
UnevenRange<Space> uneven(Space const& space, int begin, int end, int chunk = 64)
{
  return UnevenRange<Space>(space, begin, end, Kokkos::ChunkSize(chunk));
}

/// Whether kernels on `Space` run on the host, in its memory.
template <class Space>
constexpr bool shares_host_memory =
    Kokkos::SpaceAccessibility<Space, Kokkos::HostSpace>::accessible;

/// How many items a work item takes in turn where that helps a host: there `size`, and one on a
/// device, whose threads are many.
template <class Space, int size>
constexpr int block_on_host = shares_host_memory<Space> ? size : 1;

/// Number of blocks of `size` that hold `items`.
constexpr int blocks_of(int size, int items)
{
  return (items + size - 1) / size;
}

/// Calls visit(i) for the items of one of these blocks.
template <class Visit>
KOKKOS_INLINE_FUNCTION void for_each_in_block(int block, int size, int items, Visit const& visit)
{
  int const begin = block * size, end = begin + size < items ? begin + size : items;
  for (int i = begin; i < end; ++i)
    visit(i);
}

/// The value in a View of rank 0, for the host, once all that is queued on `space` is done.
template <class Space, class ViewType>
typename ViewType::non_const_value_type value_after(Space const& space, ViewType const& view)
{
  typename ViewType::non_const_value_type value;
  space.fence();
  Kokkos::deep_copy(value, view);
  return value;
}

/// Whether work items on `Space` run one after another, so that nothing they share needs atomics.
#if defined(KOKKOS_ENABLE_SERIAL)
template <class Space>
constexpr bool one_at_a_time = std::is_same_v<Space, Kokkos::Serial>;
#else
template <class Space>
constexpr bool one_at_a_time = false;
#endif

/// A work item that adds nothing.
struct Nothing {
  KOKKOS_INLINE_FUNCTION void operator()(int, int&) const {}
};

/// An instance of `Space` for an engine: engines of one thread each may work at the same time if
/// each is used by a thread of its own.
template <class Space>
Space own_instance()
{
  if constexpr (one_at_a_time<Space>) {
#if KOKKOS_VERSION >= 40100
    return Kokkos::Experimental::partition_space(Space(), 1)[0]; // kernels of one take turns
#else
    // Reductions look at the memory that all share, and would make it where it is too small.
    static bool const is_made = [] {
      int sum = 0;
      Kokkos::parallel_reduce("ricochet::make_scratch", Range<Space>(0, 0), Nothing{}, sum);
      return true;
    }();
    static_cast<void>(is_made);
#endif
  }
  return Space();
}

/// Calls body(i, before, true) for i = 0...count - 1 in order.
template <class Body>
struct ScanInOrder {
  Body body;
  int count;

  KOKKOS_INLINE_FUNCTION void operator()(int) const
  {
    int before = 0;
    for (int i = 0; i < count; ++i)
      body(i, before, true);
  }
};

/// Kokkos::parallel_scan of 0...count - 1 for bodies (int i, int& before, bool final). On one
/// thread it does without the memory in which Kokkos 3.4 adds up for all instances.
template <class Space, class Body>
void scan(char const* label, Space const& space, int count, Body const& body)
{
  if constexpr (one_at_a_time<Space>)
    Kokkos::parallel_for(label, Range<Space>(space, 0, 1), ScanInOrder<Body>{body, count});
  else
    Kokkos::parallel_scan(label, Range<Space>(space, 0, count), body);
}

/// Adds to a counter that the work items of a kernel on `Space` share; returns its value before.
template <class Space>
KOKKOS_INLINE_FUNCTION int fetch_add(int& counter, int increment)
{
  if constexpr (one_at_a_time<Space>) {
    int const before = counter;
    counter = before + increment;
    return before;
  } else {
    return Kokkos::atomic_fetch_add(&counter, increment);
  }
}

/// Replaces a number that the work items of a kernel on `Space` share; returns the one before.
template <class Space>
KOKKOS_INLINE_FUNCTION int exchange(int& number, int replacement)
{
  if constexpr (one_at_a_time<Space>) {
    int const before = number;
    number = replacement;
    return before;
  } else {
    return Kokkos::atomic_exchange(&number, replacement);
  }
}

/// Reads, and writes, a number that other work items of a kernel may write meanwhile, all of them
/// the same.
KOKKOS_INLINE_FUNCTION int peek(int const& number)
{
  return *static_cast<int const volatile*>(&number);
}
KOKKOS_INLINE_FUNCTION void poke(int& number, int value)
{
  *static_cast<int volatile*>(&number) = value;
}

/// Replaces such a number if it is `expected`; returns the one before.
template <class Space>
KOKKOS_INLINE_FUNCTION int compare_exchange(int& number, int expected, int replacement)
{
  if constexpr (one_at_a_time<Space>) {
    int const before = number;
    if (before == expected)
      number = replacement;
    return before;
  } else {
    return Kokkos::atomic_compare_exchange(&number, expected, replacement);
  }
}

/// A function for what few work items of a kernel need. It stays out of the loop over all of them,
/// whose registers it would take. It must be given plain pointers, and not be a member of the
/// functor but of a copy of a part of it: what could be reached through the functor's own address
/// would be read from memory again for each work item.
#define RICOCHET_APART KOKKOS_FUNCTION __attribute__((noinline, cold))

/// Begins to fetch what a later work item of the same thread will read. It is for lists of discs,
/// whose gaps no hardware foresees; where threads are many, others work while one waits. Functions
/// that do nothing else must be inlined by force, too: to g++ they have no effect, and it would
/// leave out calls of them.
template <class Value>
KOKKOS_FORCEINLINE_FUNCTION void fetch_ahead(Value const& value)
{
#if !defined(__CUDA_ARCH__) && !defined(__HIP_DEVICE_COMPILE__)
  __builtin_prefetch(&value);
#endif
}

/// How many values fill a line of the cache.
template <class Value>
constexpr int per_cache_line = static_cast<int>(64 / sizeof(Value));

/// Place of the lowest bit that is set in `bits`, which is not 0.
KOKKOS_INLINE_FUNCTION int lowest_bit(unsigned bits)
{
#if defined(__CUDA_ARCH__)
  return __ffs(static_cast<int>(bits)) - 1; // nvcc has no builtin for it
#else
  return __builtin_ctz(bits);
#endif
}

/// A named region of Kokkos Tools for the lifetime of the object.
class ProfilingRegion {
 public:
  explicit ProfilingRegion(char const* name) { Kokkos::Profiling::pushRegion(name); }
  ~ProfilingRegion() { Kokkos::Profiling::popRegion(); }
  ProfilingRegion(ProfilingRegion const&) = delete;
  ProfilingRegion& operator=(ProfilingRegion const&) = delete;
};

/// Reducer for a type with `merge(other)` and a default constructor that is its neutral element.
/// The result stays in device memory, so that a step never waits for the host.
template <class Value, class Space>
class Merge {
  // What all instances of a host backend share in Kokkos 3.4 has so many bytes from the start.
  static_assert(sizeof(Value) <= 512, "own_instance() must make more scratch memory");

 public:
  using reducer = Merge;
  using value_type = Value;
  using result_view_type = Kokkos::View<Value, Space>;

  explicit Merge(result_view_type const& result) : result_(result) {}

  KOKKOS_INLINE_FUNCTION void init(value_type& value) const { value = value_type{}; }
  KOKKOS_INLINE_FUNCTION void join(value_type& into, value_type const& from) const
  {
    into.merge(from);
  }
#if KOKKOS_VERSION < 30700
  // 3.4 joins through volatile references to objects that are not volatile.
  KOKKOS_INLINE_FUNCTION void join(value_type volatile& into, value_type const volatile& from) const
  {
    const_cast<value_type&>(into).merge(const_cast<value_type const&>(from));
  }
#endif
  KOKKOS_INLINE_FUNCTION value_type& reference() const
  {
    return *result_.data();
  }
  KOKKOS_INLINE_FUNCTION result_view_type view() const
  {
    return result_;
  }
  KOKKOS_INLINE_FUNCTION bool references_scalar() const
  {
    return false;
  }

 private:
  result_view_type result_;
};

} // namespace ricochet
