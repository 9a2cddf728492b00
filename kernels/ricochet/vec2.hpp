// Plane vectors, with the few operations the physics needs.
#pragma once

#include "ricochet/kokkos_compat.hpp"

namespace ricochet {

template <class Real>
struct Vec2 {
  Real x, y;
};

template <class Real>
KOKKOS_INLINE_FUNCTION Vec2<Real> operator+(Vec2<Real> a, Vec2<Real> b)
{
  return {a.x + b.x, a.y + b.y};
}

template <class Real>
KOKKOS_INLINE_FUNCTION Vec2<Real> operator-(Vec2<Real> a, Vec2<Real> b)
{
  return {a.x - b.x, a.y - b.y};
}

template <class Real>
KOKKOS_INLINE_FUNCTION Vec2<Real> operator*(Real s, Vec2<Real> a)
{
  return {s * a.x, s * a.y};
}

template <class Real>
KOKKOS_INLINE_FUNCTION bool operator==(Vec2<Real> a, Vec2<Real> b)
{
  return a.x == b.x && a.y == b.y;
}

template <class Real>
KOKKOS_INLINE_FUNCTION Real dot(Vec2<Real> a, Vec2<Real> b)
{
  return a.x * b.x + a.y * b.y;
}

/// The same vector in another number format.
template <class To, class Real>
KOKKOS_INLINE_FUNCTION Vec2<To> as(Vec2<Real> a)
{
  return {static_cast<To>(a.x), static_cast<To>(a.y)};
}

} // namespace ricochet
