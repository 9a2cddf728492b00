// How two touching discs exchange velocity. Every engine uses these functions.
//
// Notation: n is the unit normal from the first disc to the second, u1 = v1.n and u2 = v2.n the
// normal components, t1 = v1 - u1 n and t2 = v2 - u2 n the tangential parts, alpha the elastic and
// beta the friction coefficient. Only + - * / and sqrt are used, in the order written: this is
// part of what a state hash depends on.
#pragma once

#include "ricochet/model.hpp"
#include "ricochet/vec2.hpp"

#include <variant>

namespace ricochet {

/// Velocities of two discs in contact.
template <class Real>
struct PairVelocity {
  Vec2<Real> first, second;
};

/// Unit normal from the first disc to the second, `distance` = |separation| apart. Discs with the
/// same centre have none; by the original's convention it is then +x.
template <class Real>
KOKKOS_INLINE_FUNCTION Vec2<Real> contact_normal(Vec2<Real> separation, Real distance)
{
  if (distance > 0)
    return {separation.x / distance, separation.y / distance};
  return {1, 0};
}

/// Equal smooth elastic discs exchange their normal components: v1' = u2 n + t1, v2' = u1 n + t2.
/// Both laws below are this one at alpha = beta = 1.
template <class Real>
struct Elastic {
  KOKKOS_INLINE_FUNCTION PairVelocity<Real> operator()(Vec2<Real> n, PairVelocity<Real> v) const
  {
    Real const u1 = dot(v.first, n), u2 = dot(v.second, n);
    auto const t1 = v.first - u1 * n, t2 = v.second - u2 * n;
    return {u2 * n + t1, u1 * n + t2};
  }
};

/// The original's rule: v1' = alpha u2 n + beta t1, v2' = alpha u1 n + beta t2. It damps the motion
/// of the pair as a whole too, so momentum is not conserved unless alpha = beta = 1.
template <class Real>
struct SwapScale {
  Real alpha, beta;

  KOKKOS_INLINE_FUNCTION PairVelocity<Real> operator()(Vec2<Real> n, PairVelocity<Real> v) const
  {
    Real const u1 = dot(v.first, n), u2 = dot(v.second, n);
    auto const t1 = v.first - u1 * n, t2 = v.second - u2 * n;
    return {(alpha * u2) * n + beta * t1, (alpha * u1) * n + beta * t2};
  }
};

/// Newton's law of restitution, with its like for the tangential part: the relative velocity
/// v2 - v1 becomes -alpha along n and beta across it, the mean velocity stays. Hence
///   v1' = (u1 (1 - alpha)/2 + u2 (1 + alpha)/2) n + t1 (1 + beta)/2 + t2 (1 - beta)/2
/// and v2' with 1 and 2 exchanged.
template <class Real>
struct Restitution {
  Real keep_normal, swap_normal;   ///< (1 - alpha)/2, (1 + alpha)/2
  Real keep_tangent, swap_tangent; ///< (1 + beta)/2, (1 - beta)/2

  Restitution(Real alpha, Real beta)
    : keep_normal((1 - alpha) / 2),
      swap_normal((1 + alpha) / 2),
      keep_tangent((1 + beta) / 2),
      swap_tangent((1 - beta) / 2)
  {
  }

  KOKKOS_INLINE_FUNCTION PairVelocity<Real> operator()(Vec2<Real> n, PairVelocity<Real> v) const
  {
    Real const u1 = dot(v.first, n), u2 = dot(v.second, n);
    auto const t1 = v.first - u1 * n, t2 = v.second - u2 * n;
    return {(keep_normal * u1 + swap_normal * u2) * n + (keep_tangent * t1 + swap_tangent * t2),
            (keep_normal * u2 + swap_normal * u1) * n + (keep_tangent * t2 + swap_tangent * t1)};
  }
};

/// The law of a scene; kernels are compiled for each alternative.
template <class Real>
using AnyLaw = std::variant<Elastic<Real>, SwapScale<Real>, Restitution<Real>>;

/// The law that a contact rule asks for, in its cheapest form.
template <class Real>
AnyLaw<Real> contact_law(Contact const& contact)
{
  auto const alpha = static_cast<Real>(contact.restitution);
  auto const beta = static_cast<Real>(contact.friction);
  if (alpha == 1 && beta == 1)
    return Elastic<Real>{};
  if (contact.law == Law::swap_scale)
    return SwapScale<Real>{alpha, beta};
  return Restitution<Real>{alpha, beta};
}

} // namespace ricochet
