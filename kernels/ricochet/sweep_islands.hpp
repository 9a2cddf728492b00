// The ordered loop in parallel: islands of discs that cannot have met are loops of their own.
#pragma once

#include "ricochet/islands.hpp"
#include "ricochet/ordered_contact.hpp"

namespace ricochet {

/// The islands of a pair step. Node s + 1 is disc s; node 0 is the crowd: all islands too large for
/// one work item, taken together. An island is called by the root of its tree. Between steps every
/// disc is an island of its own, and nothing is noted.
template <class Space>
struct Islands {
  using Ints = Kokkos::View<int*, Space>;

  /// What the host must know to go on.
  struct Counts {
    int found = 0;       ///< islands of more than one disc at the start
    int wrong = 0;       ///< islands that have met others
    int crowd = 0;       ///< discs in the crowd
    int crowd_wrong = 0; ///< whether it has met others
  };

  Forest<Space> forest;
  Chains<Space> members; ///< of each island, except for its own disc
  Ints of_disc;          ///< island of each disc, as of when it was last executed
  Ints list;             ///< islands to execute
  Ints wrong;            ///< islands that have met others; the next list
  Ints is_wrong;         ///< whether a node is in it
  Ints crowd;            ///< discs of the crowd
  PushLog<Space> pushes;
  Kokkos::View<Counts, Space> counts;

  Islands(int discs, double far_path)
    : forest(discs + 1),
      members(discs + 1, discs),
      of_disc(uninitialised<Ints>("ricochet::island_of_disc", discs)),
      list(uninitialised<Ints>("ricochet::islands", discs + 1)),
      wrong(uninitialised<Ints>("ricochet::wrong_islands", discs + 1)),
      is_wrong("ricochet::is_wrong_island", discs + 1),
      crowd(uninitialised<Ints>("ricochet::crowd", discs)),
      pushes(discs, far_path),
      counts("ricochet::island_counts")
  {
    Kokkos::parallel_for("ricochet::reset_islands", Range<Space>(0, discs), Reset{*this});
  }

  static KOKKOS_INLINE_FUNCTION int node(int slot) { return slot + 1; }

  /// Calls visit(slot) for each disc of island `root`, which is not the crowd.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_members(int root, Visit const& visit) const
  {
    members.for_each(root, visit);
    visit(root - 1);
  }

  /// Makes a disc an island of its own, of which nothing is noted.
  KOKKOS_INLINE_FUNCTION void reset(int slot) const
  {
    forest.reset(node(slot));
    members.reset(node(slot));
    of_disc(slot) = node(slot);
    is_wrong(node(slot)) = 0;
    pushes.reset(slot);
  }
  struct Reset {
    Islands islands;
    KOKKOS_INLINE_FUNCTION void operator()(int slot) const { islands.reset(slot); }
  };

  /// Makes the crowd empty, and all counts 0.
  KOKKOS_INLINE_FUNCTION void reset_counts() const
  {
    forest.reset(0);
    counts() = Counts{};
    pushes.far_count() = 0;
  }

  /// Adds a disc to the island of another, as of its start.
  KOKKOS_INLINE_FUNCTION void join(int root, int slot) const
  {
    of_disc(slot) = root;
    if (members.append(root, slot))
      list(fetch_add<Space>(counts().found, 1)) = root;
  }

  /// Adds a disc to an island, or to the crowd.
  KOKKOS_INLINE_FUNCTION void add_member(int root, int slot) const
  {
    if (root == 0)
      crowd(fetch_add<Space>(counts().crowd, 1)) = slot;
    else
      members.append(root, slot);
  }

  KOKKOS_INLINE_FUNCTION void forget_wrong() const
  {
    counts().wrong = counts().crowd_wrong = 0;
    is_wrong(0) = 0;
  }

  /// Notes that an island has met another.
  KOKKOS_INLINE_FUNCTION void note_wrong(int root) const
  {
    if (exchange<Space>(is_wrong(root), 1) != 0)
      return;
    if (root == 0)
      counts().crowd_wrong = 1;
    else
      wrong(fetch_add<Space>(counts().wrong, 1)) = root;
  }
};

/// Finds all pairs of discs that overlap.
template <class Space, class Real, bool periodic, class Pairs>
struct FindOverlapping {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours;
  Pairs pairs; ///< notes them

  KOKKOS_INLINE_FUNCTION void operator()(int slot) const
  {
    Real const reach2 = state.diameter * state.diameter;
    neighbours.for_each_ahead(state.cell(slot), slot, reach2,
                              [&](int k, Vec2<Real>) { pairs.note(slot, k); });
  }
};

/// What becomes of pairs that overlap at the start: one island.
template <class Space>
struct UnitePairs {
  Forest<Space> forest;

  KOKKOS_INLINE_FUNCTION void note(int j, int k) const
  {
    forest.unite(Islands<Space>::node(j), Islands<Space>::node(k));
  }
};

/// What becomes of pairs of different islands that overlap in their turn: they are one island that
/// was executed wrongly.
template <class Space>
struct UniteIslands {
  Islands<Space> islands;

  KOKKOS_INLINE_FUNCTION bool apart(int j, int k) const
  {
    return islands.of_disc(j) != islands.of_disc(k);
  }
  KOKKOS_INLINE_FUNCTION void note(int j, int k) const
  {
    islands.forest.unite(islands.of_disc(j), islands.of_disc(k));
    islands.note_wrong(islands.of_disc(j));
    islands.note_wrong(islands.of_disc(k));
  }
};

/// Most discs that one work item executes as an island.
constexpr int island_limit = 32;

/// Executes an island: the original's loop over all pairs of its discs.
template <class Space, class Real, class LawType, bool periodic>
struct ExecuteIsland {
  OrderedContact<Space, Real, LawType, periodic> contact;
  Islands<Space> islands;
  int largest; ///< larger islands join the crowd; at most island_limit

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const root = islands.list(k);
    islands.is_wrong(root) = 0;
    if (islands.forest.root(root) != root)
      return; // it has become part of another
    int slot[island_limit], size = 0;
    islands.for_members(root, [&](int member) {
      if (size < largest)
        insert(slot, size, member);
      ++size;
    });
    if (size <= largest)
      execute(slot, size);
    else
      join_crowd(root, size);
  }

 private:
  KOKKOS_INLINE_FUNCTION void insert(int* slot, int at, int member) const
  {
    auto const& id = contact.state.discs.id;
    for (; at > 0 && id(slot[at - 1]) > id(member); --at)
      slot[at] = slot[at - 1];
    slot[at] = member;
  }

  KOKKOS_INLINE_FUNCTION void execute(int const* slot, int size) const
  {
    auto const& state = contact.state;
    Real const reach2 = state.diameter * state.diameter;
    for (int a = 0; a < size; ++a)
      contact.take(slot[a]);
    for (int a = 0; a < size; ++a) {
      int const i = slot[a];
      auto const p = state.spare.position(i);
      for (int b = a + 1; b < size; ++b) {
        int const j = slot[b];
        auto const d = state.domain.separation(p, state.spare.position(j));
        if (!(dot(d, d) < reach2))
          continue;
        Real const push = contact(i, j);
        islands.pushes.add(j, state.discs.id(i), static_cast<double>(push));
      }
    }
  }

  KOKKOS_INLINE_FUNCTION void join_crowd(int root, int size) const
  {
    islands.forest.unite(root, 0);
    int at = fetch_add<Space>(islands.counts().crowd, size);
    islands.for_members(root, [&](int slot) {
      islands.of_disc(slot) = 0;
      islands.crowd(at++) = slot;
    });
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
/// farther, or, which is cheaper where these were pushed far, are looked for.
template <class Space, class Real, bool periodic, class Pairs>
struct Verify {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours; ///< where discs started
  PushLog<Space> pushes;
  Pairs pairs; ///< knows which had no turn, and notes those that should have had one
  /// Whether all discs are verified that were executed in this step; or those that were executed
  /// again, and all that were pushed far.
  bool all;

  /// Verifies a disc that was executed.
  KOKKOS_INLINE_FUNCTION void operator()(int j) const
  {
    double const path = static_cast<double>(pushes(j).path);
    double const far = static_cast<double>(pushes.far_from);
    if (all)
      pushed(j);
    else // others, which do not look for it, may have been pushed up to `far`
      look_around(j, path + (on_a_path(j) && path > far ? path : far));
  }

  /// Verifies a disc if it was pushed.
  KOKKOS_INLINE_FUNCTION void pushed(int j) const
  {
    double const path = static_cast<double>(pushes(j).path);
    if (pushes(j).last_row >= 0)
      look_around(j, on_a_path(j) ? 2 * path : path);
  }

 private:
  /// Whether a disc has been at places between its start and its end.
  KOKKOS_INLINE_FUNCTION bool on_a_path(int j) const
  {
    return pushes(j).first_row < pushes(j).last_row;
  }

  /// Looks for discs stored within a diameter and `more` of a disc's final place.
  KOKKOS_INLINE_FUNCTION void look_around(int j, double more) const
  {
    auto const visit = [&](int k, Vec2<Real>) {
      if (pairs.apart(j, k) && overlapped_in_turn(j, k))
        pairs.note(j, k);
    };
    auto const p = at(j, true);
    double const margin = neighbours.margin(static_cast<double>(state.diameter) + more);
    auto const r = static_cast<Real>(margin);
    if (margin <= state.cells.side())
      neighbours.for_each_around(state.cells.at(p), p, r * r, -1, visit);
    else
      neighbours.for_each_within(p, r, visit);
  }

  KOKKOS_INLINE_FUNCTION bool overlapped_in_turn(int j, int k) const
  {
    bool const j_first = state.discs.id(j) < state.discs.id(k);
    int const a = j_first ? j : k, b = j_first ? k : j;
    int const row = state.discs.id(a);
    Pushes const of_b = pushes(b);
    Real reach = state.diameter;
    if (of_b.first_row < row && row < of_b.last_row)
      // It was somewhere on its path; and to note a pair that has not met does no harm.
      reach = static_cast<Real>(
          neighbours.margin(static_cast<double>(reach) + static_cast<double>(of_b.path)));
    auto const d = state.domain.separation(at(a, true), at(b, row > of_b.first_row));
    return dot(d, d) < reach * reach;
  }

  /// Where a disc started, or ended.
  KOKKOS_INLINE_FUNCTION Vec2<Real> at(int slot, bool end) const
  {
    return end && pushes(slot).last_row >= 0 ? state.spare.position(slot)
                                             : state.discs.position(slot);
  }
};

/// Verifies the discs of a list.
template <class Space, class Real, bool periodic, class Pairs>
struct VerifyListed {
  Verify<Space, Real, periodic, Pairs> verify;
  Kokkos::View<int*, Space> list;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const { verify(list(k)); }
};

/// Verifies the discs that were pushed far, for those of other islands that were executed again.
template <class Space, class Real, bool periodic, class Pairs>
struct VerifyFar {
  Verify<Space, Real, periodic, Pairs> verify;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const { verify.pushed(verify.pushes.far(k)); }
};

/// Takes back what was done to a disc in this pair step.
template <class Space>
struct TakeBack {
  Kokkos::View<Tally*, Space> tally;
  PushLog<Space> pushes;

  KOKKOS_INLINE_FUNCTION void operator()(int slot) const
  {
    tally(slot) = Tally{};
    pushes.take_back(slot);
  }
};

/// Ends a pair step: takes over what was done to the discs that had contacts, makes up the books,
/// and leaves all that was noted as it was before the step.
template <class Space, class Real, class LawType, bool periodic>
struct Conclude {
  OrderedContact<Space, Real, LawType, periodic> contact;
  Islands<Space> islands;

  KOKKOS_INLINE_FUNCTION void operator()(int slot, Books& books) const
  {
    if (contact.takes_part(slot) == 0)
      return;
    contact.takes_part(slot) = 0;
    islands.reset(slot);
    auto const& state = contact.state;
    auto const before = state.discs.velocity(slot), velocity = state.spare.velocity(slot);
    // The sum over a disc's contacts, of energy before less energy after, telescopes; so does that
    // over its pushes.
    books.lost_pairs.add(kinetic_energy(before) - kinetic_energy(velocity), state.scales.energy);
    state.discs.set_velocity(slot, velocity);
    Tally const own = contact.tally(slot);
    contact.tally(slot) = Tally{};
    auto const position = state.spare.position(slot);
    double const rise = static_cast<double>(position.y) - static_cast<double>(state.discs.y(slot));
    books.numerical.add(state.gravity * rise, state.scales.energy);
    books.virial.add(own.virial, state.scales.virial);
    books.collisions += own.received;
    books.separating_hits += own.separating;
    books.max_overlap = own.deepest > books.max_overlap ? own.deepest : books.max_overlap;
    state.discs.set_position(slot, position);
  }
};

} // namespace ricochet
