// The state of all discs on the device.
#pragma once

#include "ricochet/vec2.hpp"

#include <string>

namespace ricochet {

/// Place and velocity of one disc.
template <class Real>
struct Motion {
  Vec2<Real> place, velocity;
};

/// Positions, velocities and ids of N discs, one View a component.
///
/// A disc's place in the arrays (its slot) is a matter of storage and changes when discs are sorted
/// into cells; its id is its place in the initial state and never changes.
///
/// Here and elsewhere a View names its execution space and not only a memory, because Kokkos fills
/// new memory by that space, and in the threads of others the default one of the host may not work.
template <class Space, class Real>
struct Discs {
  /// The arrays are longer than the number of discs by this, so that a kernel may read (and ignore)
  /// a few discs too many.
  static constexpr int padding = 8;

  Kokkos::View<Real*, Space> x, y, vx, vy;
  Kokkos::View<int*, Space> id;

  Discs() = default;
  explicit Discs(int count)
    : x("ricochet::x", count + padding),
      y("ricochet::y", count + padding),
      vx("ricochet::vx", count + padding),
      vy("ricochet::vy", count + padding),
      id("ricochet::id", count + padding),
      count_(count)
  {
  }

  KOKKOS_INLINE_FUNCTION int count() const { return count_; }

  KOKKOS_INLINE_FUNCTION Vec2<Real> position(int slot) const { return {x(slot), y(slot)}; }
  KOKKOS_INLINE_FUNCTION Vec2<Real> velocity(int slot) const { return {vx(slot), vy(slot)}; }

  KOKKOS_INLINE_FUNCTION Motion<Real> motion(int slot) const
  {
    return {position(slot), velocity(slot)};
  }

  KOKKOS_FORCEINLINE_FUNCTION void fetch_motion_ahead(int slot) const
  {
    fetch_ahead(x(slot));
    fetch_ahead(y(slot));
    fetch_ahead(vx(slot));
    fetch_ahead(vy(slot));
  }

  KOKKOS_INLINE_FUNCTION void set_position(int slot, Vec2<Real> p) const
  {
    x(slot) = p.x;
    y(slot) = p.y;
  }
  KOKKOS_INLINE_FUNCTION void set_velocity(int slot, Vec2<Real> v) const
  {
    vx(slot) = v.x;
    vy(slot) = v.y;
  }

 private:
  int count_ = 0;
};

} // namespace ricochet
