// The box as the kernels see it: separations and positions on periodic axes.
#pragma once

#include "ricochet/discs.hpp"
#include "ricochet/model.hpp"
#include "ricochet/vec2.hpp"

#include <limits>

namespace ricochet {

/// Periodicity of the plane. `periodic` says whether any axis is; where none is, all of this
/// compiles to nothing. An axis with walls has an infinite period, which never wraps.
template <class Real, bool periodic>
class Domain {
 public:
  static constexpr bool wraps = periodic;

  /// The plane.
  KOKKOS_INLINE_FUNCTION Domain() {}
  explicit Domain(Box const& box)
  {
    if (box.x == Boundary::periodic)
      x_ = {static_cast<Real>(box.width), static_cast<Real>(box.width) / 2};
    if (box.y == Boundary::periodic)
      y_ = {static_cast<Real>(box.height), static_cast<Real>(box.height) / 2};
  }

  /// Vector from `a` to the nearest image of `b`, for positions inside the box.
  KOKKOS_INLINE_FUNCTION Vec2<Real> separation(Vec2<Real> a, Vec2<Real> b) const
  {
    auto d = b - a;
    if constexpr (periodic) {
      d.x = x_.nearest(d.x);
      d.y = y_.nearest(d.y);
    }
    return d;
  }

  /// The image of `p` inside the box, [-L/2, L/2) on each periodic axis of length L.
  KOKKOS_INLINE_FUNCTION Vec2<Real> wrapped(Vec2<Real> p) const
  {
    if constexpr (periodic)
      return {x_.wrapped(p.x), y_.wrapped(p.y)};
    else
      return p;
  }

  /// Calls use(domain) with the plane, which has no images, for discs that are not near any other's
  /// image across an end of the box (`inner`), and with this domain for others.
  template <class Use>
  KOKKOS_INLINE_FUNCTION void with_ends(bool inner, Use const& use) const
  {
    if constexpr (periodic) {
      if (!inner) {
        use(*this);
        return;
      }
    }
    use(Domain<Real, false>());
  }

 private:
  struct Axis {
    Real length = std::numeric_limits<Real>::infinity();
    Real half = std::numeric_limits<Real>::infinity();

    KOKKOS_INLINE_FUNCTION Real nearest(Real d) const
    {
      return d > half ? d - length : (d < -half ? d + length : d);
    }

    KOKKOS_INLINE_FUNCTION Real wrapped(Real p) const
    {
      // Without a branch, so that compilers find the vectors in a loop over discs.
      Real const image = p - length * floor((p + half) / length);
      // Rounding may end on, or just past, the far side, which is the near side of the next image.
      Real const not_below = image > -half ? image : -half;
      Real const inside = not_below < half ? not_below : -half;
      return fabs(p) >= half ? inside : p; // -half is its own image
    }
  };

  Axis x_, y_;
};

/// Brings every disc to its image inside the box.
template <class Space, class Real, bool periodic>
void wrap_all(Space const& space, Discs<Space, Real> const& discs,
              Domain<Real, periodic> const& domain)
{
  Kokkos::parallel_for(
      "ricochet::wrap_all", Range<Space>(space, 0, discs.count()),
      KOKKOS_LAMBDA(int i) { discs.set_position(i, domain.wrapped(discs.position(i))); });
}

/// Whether any axis of the box is periodic.
inline bool is_periodic(Box const& box)
{
  return box.x == Boundary::periodic || box.y == Boundary::periodic;
}

} // namespace ricochet
