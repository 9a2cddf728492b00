// Motion of a disc between contacts.
#pragma once

#include "ricochet/discs.hpp"

namespace ricochet {

/// The original's motion over one step, semi-implicit Euler: v' = v - g dt, x' = x + v' dt.
/// Each step changes a disc's energy by exactly -(g dt)^2 / 2, see flight_error().
template <class Real, bool gravity>
struct Fly {
  static constexpr bool accelerates = gravity;

  Real dt;
  Real velocity_gain; ///< g dt

  KOKKOS_INLINE_FUNCTION Motion<Real> operator()(Motion<Real> disc) const
  {
    if constexpr (gravity)
      disc.velocity.y = disc.velocity.y - velocity_gain;
    disc.place = disc.place + dt * disc.velocity;
    return disc;
  }
};

/// Calls use(fly) with the motion through one step, of discs that walls and others ignore.
template <class Real, class Use>
void with_flight(double gravity, double dt, Use const& use)
{
  auto const step = static_cast<Real>(dt);
  auto const gain = static_cast<Real>(gravity) * step;
  if (gravity != 0)
    use(Fly<Real, true>{step, gain});
  else
    use(Fly<Real, false>{step, gain});
}

/// Energy that Fly gives a disc in one step. With G = g dt:
///   kinetic: ((v - G)^2 - v^2)/2 = -v G + G^2/2,   potential: g (v - G) dt = v G - G^2.
template <class Real>
double flight_error(double gravity, double dt)
{
  auto const gain = static_cast<double>(static_cast<Real>(gravity) * static_cast<Real>(dt));
  return -0.5 * gain * gain;
}

} // namespace ricochet
