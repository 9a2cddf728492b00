// The ordered loop in parallel: islands of discs that cannot have met are loops of their own.
#pragma once

#include "ricochet/ordered_contact.hpp"

namespace ricochet {

/// Finds all pairs of discs that overlap, a block of discs at a time.
template <class Space, class Real, bool periodic, class Pairs>
struct FindOverlapping {
  static constexpr int block = block_on_host<Space, 256>;

  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours;
  Pairs pairs; ///< notes them

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    // A copy can stay in registers; what is reached through `this` is read again for every disc.
    auto const own = *this;
    Real const reach2 = own.state.diameter * own.state.diameter;
    for_each_in_block(b, block, own.state.discs.count(), [&](int slot) {
      own.neighbours.for_each_ahead(own.state.cell(slot), slot, reach2,
                                    [&](int k, Vec2<Real>) { own.pairs.note(slot, k); });
    });
  }
};

/// Calls pairs.note(j, k) for all pairs of discs that overlap.
template <class Space, class Real, bool periodic, class Pairs>
void find_overlapping(char const* label, Space const& space,
                      PairState<Space, Real, periodic> const& state, Pairs const& pairs)
{
  using Find = FindOverlapping<Space, Real, periodic, Pairs>;
  Kokkos::parallel_for(label, Range<Space>(space, 0, blocks_of(Find::block, state.discs.count())),
                       Find{state, state.neighbours(), pairs});
}

/// What becomes of pairs that overlap at the start: one island.
template <class Space>
struct UniteOverlapping {
  Forest<Space> forest;
  CallUps<Space> calls;

  KOKKOS_INLINE_FUNCTION void note(int j, int k) const
  {
    forest.unite(j, k);
    calls.call_up(j, 1);
    calls.call_up(k, 1);
  }
};

/// What becomes of pairs of different islands, or of none, that overlap in their turn: they are one
/// island in the next pass.
template <class Space, class Real>
struct UniteIslands {
  Participants<Space, Real> participants;
  int pass;

  KOKKOS_INLINE_FUNCTION bool apart(Participant<Real> const& j, int k) const
  {
    return participants.island(j.slot) != participants.island(k);
  }
  KOKKOS_INLINE_FUNCTION void note(int j, int k) const
  {
    participants.forest.unite(j, k);
    call_up_island(j);
    call_up_island(k);
  }

 private:
  KOKKOS_INLINE_FUNCTION void call_up_island(int slot) const
  {
    auto const& calls = participants.calls;
    int const root = participants.island(slot);
    if (root < 0)
      calls.call_up(slot, pass + 1);
    else if (calls.call_up(participants(root).slot, pass + 1)) // or somebody else does this
      participants.chains.for_each(root,
                                   [&](int k) { calls.call_up(participants(k).slot, pass + 1); });
  }
};

/// Most discs that one work item executes as an island.
constexpr int island_limit = 32;

/// Executes an island: the original's loop over all pairs of its discs.
template <class Space, class Real, class LawType, bool periodic>
struct ExecuteIsland {
  OrderedContact<Space, Real, LawType, periodic> contact;
  int largest; ///< larger islands are for the crowd; at most island_limit

  KOKKOS_INLINE_FUNCTION void operator()(int root) const
  {
    auto const& participants = contact.participants;
    int member[island_limit], size = 0;
    participants.chains.for_each(root, [&](int k) {
      if (size < largest)
        insert(member, size, k);
      ++size;
    });
    if (size <= largest)
      execute(member, size); // of no disc, if this is not a root
    else
      participants.note_crowd(root, size);
  }

 private:
  KOKKOS_INLINE_FUNCTION void insert(int* member, int at, int k) const
  {
    auto const& participants = contact.participants;
    for (; at > 0 && participants(member[at - 1]).id > participants(k).id; --at)
      member[at] = member[at - 1];
    member[at] = k;
  }

  KOKKOS_INLINE_FUNCTION void execute(int const* member, int size) const
  {
    auto const& participants = contact.participants;
    auto const& state = contact.state;
    Real const reach2 = state.diameter * state.diameter;
    for (int a = 0; a < size; ++a) {
      auto& i = participants(member[a]);
      for (int b = a + 1; b < size; ++b) {
        auto& j = participants(member[b]);
        auto const d = state.domain.separation(i.position, j.position);
        if (!(dot(d, d) < reach2))
          continue;
        Real const push = contact(i, j);
        participants.note_push(member[b], i.id, static_cast<double>(push));
      }
    }
  }
};

/// Compares what was executed with what was not: finds the pairs of discs that overlapped when it
/// would have been their turn, and had none.
///
/// In row a, disc a is where it will stay, and disc b > a is where the rows before a have pushed
/// it. Each disc that was pushed looks around its final place, where it can have met others in
/// three ways: one that stayed, or was yet to be pushed, and is found within a diameter; one that
/// had been pushed, which the disc with the longer path finds, as the other's start is within a
/// diameter and its path; and, if it was pushed more than once, at a place on its path.
///
/// Discs that are executed again must also find those that are not, and were pushed: they look
/// farther, or, which is cheaper where these were pushed far, are looked for. Only one that has
/// never been pushed need not: it is where it was when those others looked.
template <class Space, class Real, bool periodic, class Pairs>
struct Verify {
  static constexpr int ahead = 8; ///< numbers that a work item looks ahead

  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours; ///< where discs started
  Participants<Space, Real> participants;
  Pairs pairs; ///< knows which had no turn, and notes those that should have had one
  /// Whether all discs are verified that were executed in this step; or those that were executed
  /// again, and all that were pushed far.
  bool all;
  int last; ///< number of this pass

  /// Verifies a disc that was executed.
  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    fetch_ahead_around(participants(k + ahead < last ? k + ahead : last).position);
    auto const& own = participants(k);
    double const path = static_cast<double>(own.pushes.path);
    double const far = static_cast<double>(participants.far_from);
    if (all)
      pushed(own);
    else if (own.pushes.any() || own.was_pushed)
      // Others, which do not look for it, may have been pushed up to `far`.
      look_around(own, path + (is_on_a_path(own) && path > far ? path : far));
  }

  /// Verifies one of the discs that were pushed far.
  KOKKOS_INLINE_FUNCTION void far(int entry) const
  {
    int const k = participants.far(entry);
    auto const& own = participants(k);
    if (participants.number(own.slot) == k) // or it was executed again since
      pushed(own);
  }

 private:
  /// Begins to fetch the next row of cells: those before were looked at not long ago.
  KOKKOS_FORCEINLINE_FUNCTION void fetch_ahead_around(Vec2<Real> place) const
  {
    int const next = state.cells.first_of_next_row(state.cells.at(place));
    int const last_slot = state.discs.count() - 1, slot = next < last_slot ? next : last_slot;
    fetch_ahead(state.discs.x(slot));
    fetch_ahead(state.discs.y(slot));
    fetch_ahead(participants.role(slot));
  }

  KOKKOS_INLINE_FUNCTION void pushed(Participant<Real> const& own) const
  {
    double const path = static_cast<double>(own.pushes.path);
    if (own.pushes.any())
      look_around(own, is_on_a_path(own) ? 2 * path : path);
  }

  /// Whether a disc has been at places between its start and its end.
  KOKKOS_INLINE_FUNCTION static bool is_on_a_path(Participant<Real> const& own)
  {
    return own.pushes.first_row < own.pushes.last_row;
  }

  /// Looks for discs stored within a diameter and `more` of a disc's final place.
  KOKKOS_INLINE_FUNCTION void look_around(Participant<Real> const& own, double more) const
  {
    auto const visit = [&](int k, Vec2<Real>) {
      if (pairs.apart(own, k) && overlapped_in_turn(own, k))
        pairs.note(own.slot, k);
    };
    auto const p = own.position;
    double const margin = neighbours.margin(static_cast<double>(state.diameter) + more);
    auto const r = static_cast<Real>(margin);
    if (margin <= state.cells.side())
      neighbours.for_each_around(state.cells.at(p), p, r * r, visit);
    else
      neighbours.for_each_within(p, r, visit);
  }

  KOKKOS_INLINE_FUNCTION bool overlapped_in_turn(Participant<Real> const& own, int slot) const
  {
    auto const start = state.discs.position(slot);
    int const id = state.discs.id(slot), k = participants.number(slot);
    auto const end = k < 0 ? start : participants(k).position;
    if (own.id < id)
      return overlapped(own.id, own.position, k < 0 ? Pushes{} : participants(k).pushes, start,
                        end);
    return overlapped(id, end, own.pushes, state.discs.position(own.slot), own.position);
  }

  /// Whether a disc in its row, where it has come to its end, overlapped one of a higher id.
  KOKKOS_INLINE_FUNCTION bool overlapped(int row, Vec2<Real> place, Pushes const& pushes,
                                         Vec2<Real> start, Vec2<Real> end) const
  {
    Real reach = state.diameter;
    if (pushes.first_row < row && row < pushes.last_row)
      // It was somewhere on its path; and to note a pair that has not met does no harm.
      reach = static_cast<Real>(
          neighbours.margin(static_cast<double>(reach) + static_cast<double>(pushes.path)));
    auto const d = state.domain.separation(place, row > pushes.first_row ? end : start);
    return dot(d, d) < reach * reach;
  }
};

/// Verifies the discs that were pushed far.
template <class Space, class Real, bool periodic, class Pairs>
struct VerifyFar {
  Verify<Space, Real, periodic, Pairs> verify;

  KOKKOS_INLINE_FUNCTION void operator()(int entry) const { verify.far(entry); }
};

/// Verifies a pass: the discs with the numbers begin...end - 1, and if it was not the first those
/// pushed far, of which there are `far` in all.
template <class Space, class Real, bool periodic, class Pairs>
void verify(Space const& space, PairState<Space, Real, periodic> const& state,
            Participants<Space, Real> const& participants, Pairs const& pairs, int pass, int begin,
            int end, int far)
{
  Verify<Space, Real, periodic, Pairs> const verify{state, state.neighbours(), participants,
                                                    pairs, pass == 1,          end - 1};
  Kokkos::parallel_for("ricochet::verify", Range<Space>(space, begin, end), verify);
  if (pass > 1)
    Kokkos::parallel_for("ricochet::verify_far", Range<Space>(space, 0, far),
                         VerifyFar<Space, Real, periodic, Pairs>{verify});
}

/// Ends a pair step: takes over what was done to the discs that had contacts, makes up the books,
/// and lets them go, a block of them at a time.
template <class Space, class Real, class LawType, bool periodic>
struct Conclude {
  static constexpr int block = block_on_host<Space, 256>;
  static_assert(block <= ExactSum::few, "their sums must not need to carry");

  OrderedContact<Space, Real, LawType, periodic> contact;
  int numbers; ///< that were given

  KOKKOS_INLINE_FUNCTION void operator()(int b, Books& books) const
  {
    Books own;
    Real closest = Tally<Real>{}.closest;
    for_each_in_block(b, block, numbers, [&](int k) { conclude(k, own, closest); });
    // Rounding is monotone: of all overlaps the deepest is, bit for bit, that of the closest pair.
    double const deepest = overlap(closest, contact.state.diameter);
    own.max_overlap = deepest > 0 ? deepest : 0;
    books.merge(own);
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void conclude(int k, Books& books, Real& closest) const
  {
    auto const& own = contact.participants(k);
    int const slot = own.slot;
    if (contact.participants.number(slot) != k)
      return; // it was executed again, with another number
    contact.participants.reset(slot);
    contact.participants.calls.dismiss(slot);
    auto const& state = contact.state;
    // The sum over a disc's contacts, of energy before less energy after, telescopes; so does that
    // over its pushes.
    books.lost_pairs.add_one_of_few(kinetic_energy(state.discs.velocity(slot)) -
                                        kinetic_energy(own.velocity),
                                    state.scales.energy);
    double const rise =
        static_cast<double>(own.position.y) - static_cast<double>(state.discs.y(slot));
    books.numerical.add_one_of_few(state.gravity * rise, state.scales.energy);
    books.virial.add_one_of_few(own.tally.virial, state.scales.virial);
    books.collisions += own.tally.received;
    books.separating_hits += own.tally.separating;
    closest = own.tally.closest < closest ? own.tally.closest : closest;
    state.discs.set_velocity(slot, own.velocity);
    state.discs.set_position(slot, own.position);
  }
};

} // namespace ricochet
