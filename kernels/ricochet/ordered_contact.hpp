// One contact of the ordered loop, and what is noted about it.
#pragma once

#include "ricochet/contacts.hpp"

#include <limits>

namespace ricochet {

/// What befell one disc in a pair step. A disc's contacts have the same order however the loop is
/// executed, so this is the same, bit for bit, and the books are made up of it afterwards.
struct Tally {
  double virial = 0;  ///< of the contacts in which it was the second disc
  double deepest = 0; ///< overlap of those [diameters]
  int received = 0;   ///< how many those were
  int separating = 0; ///< and without approach
};

/// When, and how far, a disc was pushed in a pair step.
struct Pushes {
  static constexpr int never = std::numeric_limits<int>::max();

  int first_row = never; ///< id of the disc that pushed it first
  int last_row = -1;     ///< and last
  float path = 0;        ///< length of its way, not rounded down [length]

  KOKKOS_INLINE_FUNCTION void add(int row, double length)
  {
    first_row = row < first_row ? row : first_row;
    last_row = row;
    // More than rounding takes away, here and in the positions.
    path = static_cast<float>((static_cast<double>(path) + length) * (1 + 1e-6) + 1e-37);
  }
};

/// The pushes of a pair step, by slot, and a list of the discs that were pushed far.
template <class Space>
struct PushLog {
  Kokkos::View<Pushes*, Space> pushes;
  Kokkos::View<char*, Space> is_far; ///< or was, before it was taken back
  Kokkos::View<int*, Space> far;     ///< those discs, each once
  Kokkos::View<int, Space> far_count;
  float far_from; ///< the path from which on they are [length]

  PushLog(int discs, double far_path)
    : pushes("ricochet::pushes", discs),
      is_far("ricochet::is_far", discs),
      far(uninitialised<Kokkos::View<int*, Space>>("ricochet::pushed_far", discs)),
      far_count("ricochet::pushed_far_count"),
      far_from(static_cast<float>(far_path))
  {
  }

  KOKKOS_INLINE_FUNCTION Pushes const& operator()(int slot) const { return pushes(slot); }

  KOKKOS_INLINE_FUNCTION void add(int slot, int row, double length) const
  {
    pushes(slot).add(row, length);
    if (pushes(slot).path <= far_from || is_far(slot) != 0)
      return;
    is_far(slot) = 1;
    far(fetch_add<Space>(far_count(), 1)) = slot;
  }

  KOKKOS_INLINE_FUNCTION void take_back(int slot) const { pushes(slot) = Pushes{}; }
  KOKKOS_INLINE_FUNCTION void reset(int slot) const
  {
    take_back(slot);
    is_far(slot) = 0;
  }
};

/// The response of two overlapping discs, i before j in the order of ids: both velocities follow
/// the law, and j is pushed along the normal until the two just touch.
///
/// It works on a copy, in the spare memory, of the discs that take part, so that what turns out to
/// be premature can be taken back.
template <class Space, class Real, class LawType, bool periodic>
struct OrderedContact {
  PairState<Space, Real, periodic> state;
  Kokkos::View<Tally*, Space> tally;
  Kokkos::View<char*, Space> takes_part; ///< whether it does, by slot
  LawType law;

  /// Copies a disc that is to take part.
  KOKKOS_INLINE_FUNCTION void take(int slot) const
  {
    takes_part(slot) = 1;
    state.spare.set_position(slot, state.discs.position(slot));
    state.spare.set_velocity(slot, state.discs.velocity(slot));
  }

  /// Returns by how much j was pushed.
  KOKKOS_INLINE_FUNCTION Real operator()(int i, int j) const
  {
    auto const& discs = state.spare;
    auto const from = discs.position(j);
    auto const separation = state.domain.separation(discs.position(i), from);
    Real const distance = sqrt(dot(separation, separation));
    auto const normal = contact_normal(separation, distance);
    PairVelocity<Real> const before{discs.velocity(i), discs.velocity(j)};
    auto const after = law(normal, before);
    Real const push = state.diameter - distance;
    discs.set_velocity(i, after.first);
    discs.set_velocity(j, after.second);
    discs.set_position(j, state.domain.wrapped(from + push * normal));

    Tally& second = tally(j);
    double const depth = overlap(distance, state.diameter);
    second.virial += virial_of(before, after, separation);
    second.deepest = depth > second.deepest ? depth : second.deepest;
    ++second.received;
    second.separating += dot(before.second - before.first, normal) >= 0 ? 1 : 0;
    return push;
  }
};

} // namespace ricochet
