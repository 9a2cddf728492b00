// The differences between Kokkos 3.4 and 5.x that the kernels meet, all in one place.
#pragma once

#include <Kokkos_Core.hpp>

#include <string>

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
 public:
  using reducer = Merge;
  using value_type = Value;
  using result_view_type = Kokkos::View<Value, typename Space::memory_space>;

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
