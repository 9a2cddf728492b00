// One contact of the ordered loop.
#pragma once

#include "ricochet/participants.hpp"

namespace ricochet {

/// The response of two overlapping discs, i before j in the order of ids: both velocities follow
/// the law, and j is pushed along the normal until the two just touch.
template <class Space, class Real, class LawType, bool periodic>
struct OrderedContact {
  PairState<Space, Real, periodic> state;
  Participants<Space, Real> participants;
  LawType law;

  /// Returns by how much j was pushed.
  KOKKOS_INLINE_FUNCTION Real operator()(Participant<Real>& i, Participant<Real>& j) const
  {
    auto const separation = state.domain.separation(i.position, j.position);
    Real const distance = sqrt(dot(separation, separation));
    auto const normal = contact_normal(separation, distance);
    PairVelocity<Real> const before{i.velocity, j.velocity};
    auto const after = law(normal, before);
    Real const push = state.diameter - distance;
    i.velocity = after.first;
    j.velocity = after.second;
    j.position = state.domain.wrapped(j.position + push * normal);

    j.tally.virial += virial_of(before, after, separation);
    j.tally.closest = distance < j.tally.closest ? distance : j.tally.closest;
    ++j.tally.received;
    j.tally.separating += dot(before.second - before.first, normal) >= 0 ? 1 : 0;
    return push;
  }
};

} // namespace ricochet
