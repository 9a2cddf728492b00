// The discs that take part in a pair step of the ordered loop, and what is noted about them.
#pragma once

#include "ricochet/call_ups.hpp"
#include "ricochet/contacts.hpp"
#include "ricochet/islands.hpp"

#include <algorithm>
#include <limits>

namespace ricochet {

/// What befell one disc in a pair step. A disc's contacts have the same order however the loop is
/// executed, so this is the same, bit for bit, and the books are made up of it afterwards.
template <class Real>
struct Tally {
  double virial = 0; ///< of the contacts in which it was the second disc
  Real closest = std::numeric_limits<Real>::max(); ///< distance in those
  int received = 0;                                ///< how many those were
  int separating = 0;                              ///< and without approach
};

/// When, and how far, a disc was pushed in a pair step.
struct Pushes {
  static constexpr int never = std::numeric_limits<int>::max();

  int first_row = never; ///< id of the disc that pushed it first
  int last_row = -1;     ///< and last
  float path = 0;        ///< length of its way, not rounded down [length]

  KOKKOS_INLINE_FUNCTION bool any() const { return last_row >= 0; }

  KOKKOS_INLINE_FUNCTION void add(int row, double length)
  {
    first_row = row < first_row ? row : first_row;
    last_row = row;
    // More than rounding takes away, here and in the positions.
    path = static_cast<float>((static_cast<double>(path) + length) * (1 + 1e-6) + 1e-37);
  }
};

/// A disc that takes part in a pair step, as far as that has been executed. It works on this copy,
/// so that what turns out to be premature can be forgotten.
template <class Real>
struct Participant {
  Vec2<Real> position, velocity;
  int slot, id;
  bool was_pushed; ///< in a pass before this one
  Pushes pushes;
  Tally<Real> tally;
};

/// In place of the number of those that took part, where a way of execution was given up.
constexpr int not_done = -1;

/// The discs that take part in a pair step. They are numbered in the order of storage, those that
/// are called up for a further pass after those of the passes before, also if they have a number
/// already. Between steps no disc takes part.
template <class Space, class Real>
struct Participants {
  template <class Value>
  using List = Kokkos::View<Value*, Space>;
  static constexpr int none = -1, no_island = std::numeric_limits<int>::max();

  /// What the host must know to go on.
  struct Counts {
    int called = 0;               ///< for this pass
    int far = 0;                  ///< discs that were pushed far
    int crowd = 0;                ///< discs of the islands that were too large in this pass
    int crowd_island = no_island; ///< the first of these
  };

  /// What a disc is in a step.
  struct Role {
    int number; ///< the latest, if it takes part, or none
    int island; ///< number of the root of its island, or none
  };

  // By slot:
  List<Role> role;
  Forest<Space> forest; ///< its trees are the islands to be
  CallUps<Space> calls;
  // By number:
  List<Participant<Real>> list;
  Chains<Space> chains; ///< by root: the members of its island
  List<int> far;        ///< numbers of those that were pushed far, in any order

  Kokkos::View<Counts, Space> counts;
  float far_from; ///< which is a path longer than this [length]

  Participants(int discs, double far_path)
    : role("ricochet::role_in_step", discs),
      forest(discs),
      calls(discs, first_room(discs)),
      counts("ricochet::participant_counts"),
      far_from(static_cast<float>(far_path))
  {
    Kokkos::parallel_for("ricochet::reset_participants", Range<Space>(0, discs), Reset{*this});
    make_room(first_room(discs));
  }

  /// Numbers that there is room for at first: enough for a gas.
  static int first_room(int discs) { return std::min(discs, discs / 4 + 256); }

  int room() const { return static_cast<int>(list.extent(0)); }

  /// Sees to it that there is room for as many numbers. Nobody may take part.
  void need_room(int numbers)
  {
    if (numbers <= room())
      return;
    list = {}; // or there would be two of each for a while
    chains = {};
    far = {};
    make_room(numbers);
    calls.keep_listed(numbers);
  }

  void reset_counts(Space const& space) const { Kokkos::deep_copy(space, counts, Counts{}); }

  /// Lists the discs that are called up for a pass. Returns how many they are, also if there is no
  /// room for their numbers.
  int list_called(Space const& space, int pass) const
  {
    ricochet::list_called(space, calls, pass, 0, WriteTo{&counts.data()->called});
    return value_after(space, counts).called;
  }

  /// Makes those listed take part, with the numbers begin...end - 1, from the start of the step on.
  template <bool periodic>
  void begin_listed(Space const& space, PairState<Space, Real, periodic> const& state, int begin,
                    int end) const
  {
    auto const participants = *this;
    Kokkos::parallel_for(
        "ricochet::begin_participants", Range<Space>(space, begin, end),
        KOKKOS_LAMBDA(int k) { participants.begin(state, participants.calls.list(k - begin), k); });
  }

  /// Lets all go of those who were called up, as if they had not taken part.
  void dissolve(Space const& space) const
  {
    auto const participants = *this;
    Kokkos::parallel_for(
        "ricochet::dissolve_islands", Range<Space>(space, 0, calls.blocks()), KOKKOS_LAMBDA(int b) {
          participants.calls.dismiss_block(b, [&](int slot) { participants.reset(slot); });
        });
  }

  KOKKOS_INLINE_FUNCTION Participant<Real>& operator()(int k) const { return list(k); }
  KOKKOS_INLINE_FUNCTION int number(int slot) const { return role(slot).number; }
  KOKKOS_INLINE_FUNCTION int island(int slot) const { return role(slot).island; }

  /// Puts a disc into an island.
  KOKKOS_INLINE_FUNCTION void join(int k, int root) const
  {
    role(list(k).slot).island = root;
    chains.append(root, k);
  }

  /// Makes a disc take part, from the start of the step on.
  template <bool periodic>
  KOKKOS_INLINE_FUNCTION void begin(PairState<Space, Real, periodic> const& state, int slot,
                                    int k) const
  {
    int const before = number(slot);
    bool const was_pushed =
        before != none && (list(before).was_pushed || list(before).pushes.any());
    role(slot) = {k, k};
    chains.reset(k);
    list(k) = {state.discs.position(slot),
               state.discs.velocity(slot),
               slot,
               state.discs.id(slot),
               was_pushed,
               {},
               {}};
  }

  /// Notes that a disc was pushed in a row.
  KOKKOS_INLINE_FUNCTION void note_push(int k, int row, double length) const
  {
    auto& pushes = list(k).pushes;
    bool const was_far = pushes.path > far_from;
    pushes.add(row, length);
    if (!was_far && pushes.path > far_from)
      far(fetch_add<Space>(counts().far, 1)) = k;
  }

  /// Notes that an island is too large for one work item.
  KOKKOS_INLINE_FUNCTION void note_crowd(int root, int size) const
  {
    fetch_add<Space>(counts().crowd, size);
    Kokkos::atomic_fetch_min(&counts().crowd_island, root); // few islands are too large
  }

  KOKKOS_INLINE_FUNCTION void forget_crowd() const
  {
    counts().crowd = 0;
    counts().crowd_island = no_island;
  }

  KOKKOS_INLINE_FUNCTION int island_size(int root) const
  {
    int size = 0;
    chains.for_each(root, [&](int) { ++size; });
    return size;
  }

  /// Makes a disc one that does not take part.
  KOKKOS_INLINE_FUNCTION void reset(int slot) const
  {
    role(slot) = {none, none};
    forest.reset(slot);
  }
  struct Reset {
    Participants participants;
    KOKKOS_INLINE_FUNCTION void operator()(int slot) const { participants.reset(slot); }
  };

 private:
  void make_room(int numbers)
  {
    list = List<Participant<Real>>("ricochet::participants", numbers);
    chains = Chains<Space>(numbers);
    far = uninitialised<List<int>>("ricochet::pushed_far", numbers);
  }
};

} // namespace ricochet
