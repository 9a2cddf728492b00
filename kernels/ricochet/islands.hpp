// Islands: which discs are connected, directly or through others.
#pragma once

#include "ricochet/kokkos_compat.hpp"

namespace ricochet {

/// Disjoint sets of nodes 0...n - 1, united in any order by any number of threads: the sets, and
/// the lowest node of each, which is its root, depend only on what was united. After Anderson and
/// Woll 1991 (doi 10.1145/103418.103458): a root is linked below a lower one by compare-and-swap.
template <class Space>
struct Forest {
  Kokkos::View<int*, Space> parent;

  Forest() = default;
  explicit Forest(int nodes)
    : parent(Kokkos::view_alloc(Kokkos::WithoutInitializing, "ricochet::forest"), nodes)
  {
  }

  /// Makes `node` a set of its own.
  KOKKOS_INLINE_FUNCTION void reset(int node) const { parent(node) = node; }

  /// The root of the set of `node`.
  KOKKOS_INLINE_FUNCTION int root(int node) const
  {
    int above = peek(parent(node));
    while (above != node) {
      node = above;
      above = peek(parent(node));
    }
    return node;
  }

  /// Unites the sets of two nodes.
  KOKKOS_INLINE_FUNCTION void unite(int a, int b) const
  {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b)
        return;
      int const low = a < b ? a : b, high = a < b ? b : a;
      if (compare_exchange<Space>(parent(high), high, low) == high)
        return;
    }
  }
};

/// Makes each of the first `nodes` nodes a set of its own.
template <class Space>
void reset_all(Space const& space, Forest<Space> const& forest, int nodes)
{
  Kokkos::parallel_for(
      "ricochet::reset_forest", Range<Space>(space, 0, nodes),
      KOKKOS_LAMBDA(int node) { forest.reset(node); });
}

/// Lists of slots, one a node, that any number of threads may append to.
template <class Space>
struct Chains {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int none = -1;

  Ints first; ///< of each node's list, or none
  Ints next;  ///< after each slot in its list, or none

  Chains() = default;
  Chains(int nodes, int slots)
    : first(Kokkos::view_alloc(Kokkos::WithoutInitializing, "ricochet::first_in_chain"), nodes),
      next(Kokkos::view_alloc(Kokkos::WithoutInitializing, "ricochet::next_in_chain"), slots)
  {
  }

  KOKKOS_INLINE_FUNCTION void reset(int node) const { first(node) = none; }

  /// Returns whether the list was empty before. No thread may read the list of `node` meanwhile.
  KOKKOS_INLINE_FUNCTION bool append(int node, int slot) const
  {
    next(slot) = exchange<Space>(first(node), slot);
    return next(slot) == none;
  }

  /// Calls visit(slot) for each slot of the list of `node`; it may append that slot to another
  /// list.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each(int node, Visit const& visit) const
  {
    for (int slot = first(node), after = none; slot != none; slot = after) {
      after = next(slot);
      visit(slot);
    }
  }
};

} // namespace ricochet
