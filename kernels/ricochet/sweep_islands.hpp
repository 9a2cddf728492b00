// The ordered loop in parallel: islands of discs that cannot have met are loops of their own.
#pragma once

#include "ricochet/islands.hpp"
#include "ricochet/ordered_contact.hpp"

namespace ricochet {

/// The islands of a pair step. Node s + 1 is disc s; node 0 is the crowd: all islands too large for
/// one work item, taken together. An island is called by the root of its tree.
template <class Space>
struct Islands {
  using Ints = Kokkos::View<int*, typename Space::memory_space>;

  /// What the host must know to go on.
  struct Counts {
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
  Kokkos::View<Pushes*, typename Space::memory_space> pushes;
  Kokkos::View<Counts, typename Space::memory_space> counts;

  explicit Islands(int discs)
    : forest(discs + 1),
      members(discs + 1, discs),
      of_disc(uninitialised<Ints>("ricochet::island_of_disc", discs)),
      list(uninitialised<Ints>("ricochet::islands", discs + 1)),
      wrong(uninitialised<Ints>("ricochet::wrong_islands", discs + 1)),
      is_wrong("ricochet::is_wrong_island", discs + 1),
      crowd(uninitialised<Ints>("ricochet::crowd", discs)),
      pushes("ricochet::pushes", discs),
      counts("ricochet::island_counts")
  {
  }

  static KOKKOS_INLINE_FUNCTION int node(int slot) { return slot + 1; }

  /// Calls visit(slot) for each disc of island `root`, which is not the crowd.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_members(int root, Visit const& visit) const
  {
    members.for_each(root, visit);
    visit(root - 1);
  }

  /// Makes `node` an island of its own, or the crowd empty.
  KOKKOS_INLINE_FUNCTION void reset(int node) const
  {
    forest.reset(node);
    members.reset(node);
    if (node == 0)
      counts() = Counts{};
    else
      pushes(node - 1) = Pushes{};
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

/// Unites all discs that overlap.
template <class Space, class Real, bool periodic>
struct UniteOverlapping {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours;
  Forest<Space> forest;

  KOKKOS_INLINE_FUNCTION void operator()(int slot) const
  {
    Real const reach2 = state.diameter * state.diameter;
    neighbours.for_each_ahead(state.cell(slot), slot, reach2, [&](int k, Vec2<Real>) {
      forest.unite(Islands<Space>::node(slot), Islands<Space>::node(k));
    });
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

  KOKKOS_INLINE_FUNCTION void operator()(int k, float& longest) const
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
      execute(slot, size, longest);
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

  KOKKOS_INLINE_FUNCTION void execute(int const* slot, int size, float& longest) const
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
        Pushes& pushes = islands.pushes(j);
        pushes.add(state.discs.id(i), static_cast<double>(push));
        longest = longest < pushes.path ? pushes.path : longest;
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

/// Compares what was executed with what was not: finds the pairs of discs of different islands that
/// overlapped when it was their turn, and unites their islands.
///
/// In row a, disc a is where it will stay, and disc b > a is where the rows before a have pushed
/// it. Each disc that was pushed looks around its final place, where it can have met others in
/// three ways: one that stayed, or was yet to be pushed, and is found within a diameter; one that
/// had been pushed, which the disc with the longer path finds, as the other's start is within a
/// diameter and its path; and, if it was pushed more than once, at a place on its path.
template <class Space, class Real, bool periodic>
struct Verify {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours; ///< where discs started
  Islands<Space> islands;
  /// Whether every island is verified; or only some, whose discs must look for all others.
  bool all;
  double longest; ///< path of any disc

  KOKKOS_INLINE_FUNCTION void disc(int j) const
  {
    auto const own = islands.pushes(j);
    if (all && own.last_row < 0)
      return; // it stayed
    double const path = static_cast<double>(own.path);
    double reach = static_cast<double>(state.diameter) + path;
    if (!all)
      reach += longest;
    else if (own.first_row != own.last_row)
      reach += path;
    auto const visit = [&](int k, Vec2<Real>) {
      if (islands.of_disc(k) == islands.of_disc(j) || !overlapped_in_turn(j, k))
        return;
      islands.forest.unite(islands.of_disc(j), islands.of_disc(k));
      islands.note_wrong(islands.of_disc(j));
      islands.note_wrong(islands.of_disc(k));
    };
    auto const p = own.last_row < 0 ? state.discs.position(j) : state.spare.position(j);
    double const margin = neighbours.margin(reach);
    auto const r = static_cast<Real>(margin);
    if (margin <= state.cells.side())
      neighbours.for_each_around(state.cells.at(p), p, r * r, -1, visit);
    else
      neighbours.for_each_within(p, r, visit);
  }

 private:
  KOKKOS_INLINE_FUNCTION bool overlapped_in_turn(int j, int k) const
  {
    bool const j_first = state.discs.id(j) < state.discs.id(k);
    int const a = j_first ? j : k, b = j_first ? k : j;
    int const row = state.discs.id(a);
    auto const pushes = islands.pushes(b);
    Real reach = state.diameter;
    if (pushes.first_row < row && row < pushes.last_row)
      // It was somewhere on its path; and to unite islands that have not met does no harm.
      reach = static_cast<Real>(
          neighbours.margin(static_cast<double>(reach) + static_cast<double>(pushes.path)));
    auto const d = state.domain.separation(at(a, true), at(b, row > pushes.first_row));
    return dot(d, d) < reach * reach;
  }

  /// Where a disc started, or ended.
  KOKKOS_INLINE_FUNCTION Vec2<Real> at(int slot, bool end) const
  {
    return end && islands.pushes(slot).last_row >= 0 ? state.spare.position(slot)
                                                     : state.discs.position(slot);
  }
};

/// Takes back what was done to a disc in this pair step.
template <class Space>
struct TakeBack {
  Kokkos::View<Tally*, typename Space::memory_space> tally;
  Kokkos::View<Pushes*, typename Space::memory_space> pushes;

  KOKKOS_INLINE_FUNCTION void operator()(int slot) const
  {
    tally(slot) = Tally{};
    pushes(slot) = Pushes{};
  }
};

} // namespace ricochet
