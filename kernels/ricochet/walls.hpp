// What happens to a disc at the ends of the box.
#pragma once

#include "ricochet/books.hpp"
#include "ricochet/discs.hpp"
#include "ricochet/domain.hpp"
#include "ricochet/model.hpp"

#include <limits>

namespace ricochet {

/// How far a disc's edge is beyond a wall [diameters]; negative inside. A periodic axis has no
/// walls.
struct Outside {
  double high_x, high_y, radius, diameter;

  explicit Outside(Model const& model)
    : high_x(model.box.x == Boundary::walls ? model.box.width / 2
                                            : std::numeric_limits<double>::infinity()),
      high_y(model.box.y == Boundary::walls ? model.box.height / 2
                                            : std::numeric_limits<double>::infinity()),
      radius(model.radius),
      diameter(2 * model.radius)
  {
  }

  /// Raises `farthest` to that of a disc at `p`.
  template <class Real>
  KOKKOS_INLINE_FUNCTION void enter(Vec2<Real> p, double& farthest) const
  {
    double const x = fabs(static_cast<double>(p.x)) + radius - high_x;
    double const y = fabs(static_cast<double>(p.y)) + radius - high_y;
    double const beyond = (x > y ? x : y);
    if (beyond > 0 && beyond / diameter > farthest)
      farthest = beyond / diameter;
  }
};

/// The most that |x| and |y| of a centre can be; infinite on a periodic axis.
template <class Real>
Vec2<Real> centre_limits(Model const& model)
{
  auto const limit = [&](Boundary boundary, double length) {
    return boundary == Boundary::walls ? static_cast<Real>(length / 2 - model.radius)
                                       : std::numeric_limits<Real>::infinity();
  };
  return {limit(model.box.x, model.box.width), limit(model.box.y, model.box.height)};
}

/// A coordinate brought between -`most` and `most`.
template <class Real>
KOKKOS_INLINE_FUNCTION Real clamped(Real place, Real most)
{
  Real const low = place < -most ? -most : place;
  return low > most ? most : low;
}

/// Calls use(gravity, walls, periodic): whether there is gravity, and any axis that has walls, or
/// is periodic.
template <class Use>
void with_terms(Model const& model, Use const& use)
{
  std::true_type const yes;
  std::false_type const no;
  bool const x = model.box.x == Boundary::walls, y = model.box.y == Boundary::walls;
  auto const with_boundaries = [&](auto gravity) {
    if (x && y)
      use(gravity, yes, no);
    else if (x || y)
      use(gravity, yes, yes);
    else
      use(no, no, yes); // discs would fall for ever
  };
  if (model.gravity != 0)
    with_boundaries(yes);
  else
    with_boundaries(no);
}

/// One wall's rule: the position is mirrored at the wall, the normal velocity multiplied by -alpha
/// and the tangential velocity by beta.
template <class Real, bool dissipative>
struct WallRule {
  Real alpha, beta;

  KOKKOS_INLINE_FUNCTION Real normal(Real v) const
  {
    if constexpr (dissipative)
      return -(alpha * v);
    else
      return -v;
  }

  KOKKOS_INLINE_FUNCTION Real tangential(Real v) const
  {
    if constexpr (dissipative)
      return beta * v;
    else
      return v;
  }

  /// A disc after the left or the right wall, or the floor or the ceiling, where it is now; its
  /// centre is `high` from the middle there.
  KOKKOS_INLINE_FUNCTION Motion<Real> off_side(Motion<Real> disc, Real high) const
  {
    auto const v = disc.velocity;
    disc.place.x = v.x < 0 ? -high : high;
    disc.velocity = {normal(v.x), tangential(v.y)};
    return disc;
  }
  KOKKOS_INLINE_FUNCTION Motion<Real> off_level(Motion<Real> disc, Real high, bool is_floor) const
  {
    auto const v = disc.velocity;
    disc.place.y = is_floor ? -high : high;
    disc.velocity = {tangential(v.x), normal(v.y)};
    return disc;
  }
};

/// The original's walls: at most one wall a step, in the order left, right, top, bottom. A disc in
/// a corner therefore meets its second wall one step later.
template <class Real, bool walls_x, bool walls_y, bool dissipative>
struct BounceOffWalls {
  Domain<Real, !(walls_x && walls_y)> domain;
  WallRule<Real, dissipative> rule;
  Real high_x, high_y; ///< the right and the top wall; the others are opposite
  Real radius;
  Outside outside;
  double gravity;
  Scales scales;

  /// Whether a disc is beyond a wall.
  KOKKOS_INLINE_FUNCTION bool hits(Vec2<Real> p) const
  {
    bool const in_x = walls_x && fabs(p.x) + radius > high_x;
    bool const in_y = walls_y && fabs(p.y) + radius > high_y;
    return in_x || in_y;
  }

  /// What becomes of disc i of these places and velocities, which is.
  RICOCHET_APART void operator()(Real* x, Real* y, Real* vx, Real* vy, int i, Books& books) const
  {
    Vec2<Real> const p{x[i], y[i]}, v{vx[i], vy[i]};
    bool const in_x = walls_x && fabs(p.x) + radius > high_x;
    auto mirrored = p;
    if (in_x && p.x < 0)
      mirrored.x = p.x + 2 * ((-high_x - p.x) + radius);
    else if (in_x)
      mirrored.x = p.x - 2 * ((p.x + radius) - high_x);
    else if (p.y > 0)
      mirrored.y = p.y - 2 * ((p.y + radius) - high_y);
    else
      mirrored.y = p.y + 2 * ((-high_y - p.y) + radius);
    Vec2<Real> const after = in_x ? Vec2<Real>{rule.normal(v.x), rule.tangential(v.y)}
                                  : Vec2<Real>{rule.tangential(v.x), rule.normal(v.y)};
    x[i] = mirrored.x;
    y[i] = mirrored.y;
    vx[i] = after.x;
    vy[i] = after.y;
    ++books.wall_hits;
    outside.enter(mirrored, books.max_outside); // nobody else can be
    books.lost_walls.add(kinetic_energy(v) - kinetic_energy(after), scales.energy);
    books.numerical.add(gravity * (static_cast<double>(mirrored.y) - static_cast<double>(p.y)),
                        scales.energy);
  }
};

/// Calls use(bounce) with the walls, or the periodicity, of each axis.
template <class Real, class Use>
void with_walls(Model const& model, Scales const& scales, Use const& use)
{
  auto const alpha = static_cast<Real>(model.contact.restitution);
  auto const beta = static_cast<Real>(model.contact.friction);
  auto const launch = [&](auto walls_x, auto walls_y, auto dissipative) {
    use(BounceOffWalls<Real, walls_x, walls_y, dissipative>{
        Domain<Real, !(walls_x && walls_y)>(model.box),
        {alpha, beta},
        static_cast<Real>(model.box.width / 2),
        static_cast<Real>(model.box.height / 2),
        static_cast<Real>(model.radius),
        Outside(model),
        model.gravity,
        scales});
  };
  auto const with_boundaries = [&](auto dissipative) {
    std::true_type const walls;
    std::false_type const periodic;
    bool const x = model.box.x == Boundary::walls, y = model.box.y == Boundary::walls;
    if (x && y)
      launch(walls, walls, dissipative);
    else if (x)
      launch(walls, periodic, dissipative);
    else if (y)
      launch(periodic, walls, dissipative);
    else
      launch(periodic, periodic, std::false_type{});
  };
  if (alpha != 1 || beta != 1)
    with_boundaries(std::true_type{});
  else
    with_boundaries(std::false_type{});
}

} // namespace ricochet
