// How discs come to the end of their lines.
#pragma once

#include "ricochet/lines.hpp"

namespace ricochet {

/// Takes every disc to the end of its line (see lines.hpp) and back to the lab: with T = dt,
///   x' = p + T w - g T^2/2,   v' = w - g T.
/// For a disc without contacts, p = x and w = v, this is the exact parabola. No disc is left beyond
/// a wall, where rounding could put it, or a contact that was left for later.
template <class Space, class Real, bool gravity, bool walls, bool periodic>
struct Land {
  static constexpr bool has_walls = walls;

  Discs<Space, Real> discs;
  Domain<Real, periodic> domain;
  Real dt;
  Real fall;           ///< g dt^2/2
  Real velocity_gain;  ///< g dt
  Real wall_x, wall_y; ///< the most that |x| and |y| of a centre can be

  KOKKOS_INLINE_FUNCTION void operator()(int i) const
  {
    discs.set_position(i, domain.wrapped(inside(end_of_line(i))));
    if constexpr (gravity)
      discs.vy(i) = discs.vy(i) - velocity_gain;
  }

  KOKKOS_INLINE_FUNCTION Vec2<Real> end_of_line(int i) const
  {
    auto p = discs.position(i) + dt * discs.velocity(i);
    if constexpr (gravity)
      p.y = p.y - fall;
    return p;
  }

  KOKKOS_INLINE_FUNCTION Vec2<Real> inside(Vec2<Real> p) const
  {
    if constexpr (walls)
      return {clamped(p.x, wall_x), clamped(p.y, wall_y)};
    else
      return p;
  }
};

/// Enters in the books what it means that disc i is kept inside when it lands.
template <class LandType>
KOKKOS_FUNCTION void settle(LandType const& land, int i, Outside const& outside, double gravity,
                            Scales const& scales, Books& books)
{
  if constexpr (!LandType::has_walls)
    return;
  auto const p = land.end_of_line(i);
  auto const kept = land.inside(p);
  outside.enter(kept, books.max_outside);
  double const lifted = static_cast<double>(kept.y) - static_cast<double>(p.y);
  if (lifted != 0)
    books.numerical.add(gravity * lifted, scales.energy);
}

/// Calls use(land) with the end of a stretch of time in a scene.
template <class Space, class Real, class Use>
void with_landing(Discs<Space, Real> const& discs, Model const& model, double dt, Use const& use)
{
  auto const step = static_cast<Real>(dt), g = static_cast<Real>(model.gravity);
  auto const limits = centre_limits<Real>(model);
  with_terms(model, [&](auto gravity, auto walls, auto periodic) {
    use(Land<Space, Real, gravity, walls, periodic>{discs, Domain<Real, periodic>(model.box), step,
                                                    g * step * step / 2, g * step, limits.x,
                                                    limits.y});
  });
}

} // namespace ricochet
