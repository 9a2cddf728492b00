// Free flight, and when it ends: the mathematics of `toi`, `events` and discs that do not meet.
//
// Times count from the beginning of a stretch of time (see lines.hpp), in which nothing is far from
// 0. Positions and velocities are those in the frame that begins the stretch at rest and falls with
// the discs,
//   q = x + g t^2/2,   w = v + g t   (x, v in the lab; g acts along -y),
// where every free flight is straight and it is the walls that accelerate.
#pragma once

#include "ricochet/domain.hpp"
#include "ricochet/model.hpp"
#include "ricochet/vec2.hpp"

#include <limits>

namespace ricochet {

/// Who or what ends a free flight: the slot of a disc, or one of these.
namespace partner {
constexpr int wall_x = -1; ///< the left or the right wall
constexpr int wall_y = -2; ///< the floor or the ceiling
constexpr int none = -3;   ///< nothing ends it in this stretch of time
} // namespace partner

/// When and at which wall a free flight ends; see `partner`.
template <class Real>
struct WallHit {
  Real due;
  int with;
};

/// Time until a distance `gap` >= 0 ahead is covered, starting with `speed` towards it under the
/// acceleration `pull` towards it; infinite if never. The positive root of
///   gap = speed t + pull t^2/2,
/// in the form that does not cancel.
template <class Real>
KOKKOS_INLINE_FUNCTION Real time_to_cover(Real gap, Real speed, Real pull)
{
  constexpr Real never = std::numeric_limits<Real>::infinity();
  if (pull == 0)
    return speed > 0 ? gap / speed : never;
  if (pull < 0 && !(speed > 0))
    return never;
  Real const square = speed * speed + 2 * pull * gap;
  if (!(square >= 0))
    return never;
  if (speed < 0)
    return (sqrt(square) - speed) / pull;
  Real const sum = speed + sqrt(square);
  return sum > 0 ? 2 * gap / sum : 0;
}

/// Whether a disc at the height `y` that has met the floor or the ceiling has met the floor. At the
/// height of its arc the velocity does not tell; the height does not in a box one disc high.
template <class Real>
KOKKOS_INLINE_FUNCTION bool is_floor(Real y, Real velocity, Real gravity)
{
  return y != 0 ? y < 0 : velocity < 0 || (velocity == 0 && gravity > 0);
}

/// Time until two points `d` apart with relative velocity `w` are sqrt(`distance2`) from each
/// other; infinite if never, or if clearly later than `limit`. With b = d.w and
/// c = d^2 - distance^2 it is the smaller root of c + 2 b t + w^2 t^2 = 0, in the form that does
/// not cancel.
///
/// Closer and approaching means now; closer and separating means never. This keeps an event-driven
/// run stable against rounding (Bannerman, Strobl, Formella & Poeschel 2014,
/// doi 10.1007/s40571-014-0021-8).
template <class Real>
KOKKOS_INLINE_FUNCTION Real time_to_meet(Vec2<Real> d, Vec2<Real> w, Real distance2, Real limit)
{
  constexpr Real never = std::numeric_limits<Real>::infinity();
  Real const b = dot(d, w);
  Real const c = dot(d, d) - distance2;
  // No root is earlier than c/(-2b). The margin is for rounding: a root at the limit is found.
  constexpr Real margin = 2 * (1 + 64 * std::numeric_limits<Real>::epsilon());
  bool const approach = b < 0, in_time = c <= -b * margin * limit;
  if (!(approach & in_time))
    return never;
  if (c <= 0)
    return 0;
  Real const discriminant = b * b - dot(w, w) * c;
  if (!(discriminant >= 0))
    return never;
  return c / (sqrt(discriminant) - b);
}

/// Whether a disc is closer to another one, at `p` with velocity `w`, than a distance, or may come
/// that close within a time: a test of many slots at once, which passes some that do not but none
/// that do.
///
/// With b = d.w and c = d^2 - distance^2 no root of c + 2 b t + w^2 t^2 is earlier than c/(-2b);
/// see time_to_meet(). So c <= -2 b t for those that come close within t; for those that separate
/// the right hand side is negative, and 0 in its place. One comparison, for compilers turn several
/// into branches.
template <class Real, class DomainType, bool at_start>
class MayMeet {
 public:
  /// Discs by slot are at (x, y) with velocities (vx, vy) at time 0; the test is for those who come
  /// closer than the root of `distance2` between `since`, which is 0 if at_start, and `since +
  /// time`. All pass if `any_image`: images other than the nearest may come closer.
  KOKKOS_INLINE_FUNCTION MayMeet(Real const* x, Real const* y, Real const* vx, Real const* vy,
                                 DomainType const& domain, Vec2<Real> p, Vec2<Real> w, Real since,
                                 Real distance2, Real time, bool any_image)
    : x_(x),
      y_(y),
      vx_(vx),
      vy_(vy),
      domain_(domain),
      p_(p),
      w_(w),
      since_(since),
      distance2_(distance2),
      factor_(-2 * (1 + margin) * time),
      least_(any_image ? std::numeric_limits<Real>::infinity() : Real(0))
  {
  }

  KOKKOS_FORCEINLINE_FUNCTION bool operator()(int k) const
  {
    Vec2<Real> const relative{vx_[k] - w_.x, vy_[k] - w_.y};
    Vec2<Real> d{x_[k] - p_.x, y_[k] - p_.y};
    if constexpr (!at_start) // there nothing has moved
      d = d + since_ * relative;
    if constexpr (DomainType::wraps)
      d = domain_.separation({0, 0}, d);
    Real const right = dot(d, relative) * factor_;
    return dot(d, d) - distance2_ <= (right > least_ ? right : least_);
  }

 private:
  static constexpr Real margin = 64 * std::numeric_limits<Real>::epsilon();

  Real const *x_, *y_, *vx_, *vy_;
  DomainType domain_;
  Vec2<Real> p_, w_;
  Real since_, distance2_;
  Real factor_; ///< -2 time, and a margin for rounding
  Real least_;  ///< of the right hand side
};

/// The box, the force and the sizes: all that decides when a flight ends.
template <class Real, bool periodic>
struct Arena {
  Domain<Real, periodic> domain;
  Real diameter2; ///< square of the diameter
  Real gravity;
  Real wall_x, wall_y; ///< the most that |x| and |y| of a centre can be; infinite if periodic
  Real period_x, period_y;
  /// Images on either side, beside the nearest, in which a pair may meet in a small periodic box.
  int images_x, images_y;
  Real inner_x, inner_y; ///< see is_inner()
  Real end;              ///< of the stretch of time

  /// Where a disc in the falling frame is in the lab at `time`, and how fast; and back.
  KOKKOS_INLINE_FUNCTION Motion<Real> in_lab(Motion<Real> const& disc, Real time) const
  {
    auto const& [q, w] = disc;
    return {{q.x, q.y - gravity * time * time / 2}, {w.x, w.y - gravity * time}};
  }
  KOKKOS_INLINE_FUNCTION Motion<Real> falling(Motion<Real> const& disc, Real time) const
  {
    auto const& [x, v] = disc;
    return {{x.x, x.y + gravity * time * time / 2}, {v.x, v.y + gravity * time}};
  }

  /// When and at which wall the flight of a disc ends, if in this stretch, of which this is the
  /// motion at the time `since`, in the falling frame.
  KOKKOS_INLINE_FUNCTION WallHit<Real> next_wall(Motion<Real> const& disc, Real since) const
  {
    WallHit<Real> const nothing{end, partner::none};
    if (!has_walls())
      return nothing;
    auto const now = in_lab(disc, since);
    if (misses_walls(now, end - since))
      return nothing;
    auto const& [p, v] = now;
    Real const x = v.x > 0 ? time_to_cover(ahead(wall_x - p.x), v.x, Real(0))
                           : time_to_cover(ahead(wall_x + p.x), -v.x, Real(0));
    Real const floor = time_to_cover(ahead(wall_y + p.y), -v.y, gravity);
    Real const ceiling = time_to_cover(ahead(wall_y - p.y), v.y, -gravity);
    Real const y = floor < ceiling ? floor : ceiling;
    WallHit<Real> const hit = x <= y ? WallHit<Real>{since + x, partner::wall_x}
                                     : WallHit<Real>{since + y, partner::wall_y};
    return hit.due < end ? hit : nothing;
  }

  KOKKOS_INLINE_FUNCTION bool has_walls() const
  {
    constexpr Real nowhere = std::numeric_limits<Real>::infinity();
    return wall_x < nowhere || wall_y < nowhere;
  }

  /// Whether a disc, in the lab, surely stays between the walls for a time.
  KOKKOS_INLINE_FUNCTION bool misses_walls(Motion<Real> const& disc, Real time) const
  {
    auto const& [p, v] = disc;
    Real const fall = gravity * time * time / 2;
    Real const x = p.x + v.x * time, straight = p.y + v.y * time, y = straight - fall;
    // Neither end of an arc is its highest point when it first rises, against the fall; the end
    // without the fall is higher.
    return fabs(x) < wall_x && fabs(y) < wall_y && fabs(straight) < wall_y && fabs(p.x) < wall_x &&
           fabs(p.y) < wall_y;
  }

  /// Whether a disc at `p` cannot meet an image of a disc across an end of the box.
  KOKKOS_INLINE_FUNCTION bool is_inner(Vec2<Real> p) const
  {
    return fabs(p.x) < inner_x && fabs(p.y) < inner_y;
  }

  /// Calls use(domain) with the domain in which a disc at `p` can be compared with its neighbours:
  /// the plane, without images, unless it is near an end of a periodic box.
  template <class Use>
  KOKKOS_INLINE_FUNCTION void with_ends(Vec2<Real> p, Use const& use) const
  {
    domain.with_ends(!periodic || is_inner(p), use);
  }

  /// Time until two discs touch whose nearest images are `d` apart, if not clearly later than
  /// `limit`. `met`: whether they have just met. Discs that have do not meet again, in the same
  /// image, before one of them meets someone else.
  KOKKOS_FORCEINLINE_FUNCTION Real time_to_touch(Vec2<Real> d, Vec2<Real> w, bool met,
                                                 Real limit) const
  {
    if constexpr (periodic)
      if (images_x + images_y > 0)
        return first_of_images(d, w, met, limit);
    return met ? std::numeric_limits<Real>::infinity() : time_to_meet(d, w, diameter2, limit);
  }

 private:
  /// A disc that rounding has put beyond a wall is at it.
  KOKKOS_INLINE_FUNCTION static Real ahead(Real gap) { return gap > 0 ? gap : Real(0); }

  KOKKOS_INLINE_FUNCTION Real first_of_images(Vec2<Real> d, Vec2<Real> w, bool met,
                                              Real limit) const
  {
    Real first = std::numeric_limits<Real>::infinity();
    for (int kx = -images_x; kx <= images_x; ++kx)
      for (int ky = -images_y; ky <= images_y; ++ky) {
        if (met && kx == 0 && ky == 0)
          continue;
        Vec2<Real> const image{images_x > 0 ? d.x + static_cast<Real>(kx) * period_x : d.x,
                               images_y > 0 ? d.y + static_cast<Real>(ky) * period_y : d.y};
        Real const time = time_to_meet(image, w, diameter2, limit);
        first = time < first ? time : first;
      }
    return first;
  }
};

} // namespace ricochet
