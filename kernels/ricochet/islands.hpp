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

/// Lists of some of the numbers 0...n - 1, one for each of these, that any number of threads may
/// append to. No number is in more than one list.
template <class Space>
struct Chains {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int none = -1;

  Ints first; ///< of each list, or none
  Ints next;  ///< after each number in its list, or none

  Chains() = default;
  explicit Chains(int n)
    : first(Kokkos::view_alloc(Kokkos::WithoutInitializing, "ricochet::first_in_chain"), n),
      next(Kokkos::view_alloc(Kokkos::WithoutInitializing, "ricochet::next_in_chain"), n)
  {
  }

  KOKKOS_INLINE_FUNCTION void reset(int list) const { first(list) = none; }

  /// No thread may read the list meanwhile.
  KOKKOS_INLINE_FUNCTION void append(int list, int k) const
  {
    next(k) = exchange<Space>(first(list), k);
  }

  /// Calls visit(k) for each number of a list; it may append that number to another list.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each(int list, Visit const& visit) const
  {
    for (int k = first(list), after = none; k != none; k = after) {
      after = next(k);
      visit(k);
    }
  }
};

} // namespace ricochet
