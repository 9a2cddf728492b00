// Who is near: the searches of all engines.
#pragma once

#include "ricochet/cells.hpp"
#include "ricochet/domain.hpp"

#include <limits>

namespace ricochet {

/// Finds discs closer than a given distance among discs that are sorted into cells.
template <class Space, class Real, bool periodic>
class Neighbours {
 public:
  Neighbours(Discs<Space, Real> const& discs, Cells<Space> const& cells, Box const& box)
    : discs_(discs),
      cells_(cells),
      domain_(box),
      // Rounding moves a computed separation by a few units in the last place of the coordinates;
      // a search must not be narrower than the test.
      rounding_(8 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
                (box.width > box.height ? box.width : box.height))
  {
  }

  /// The distance up to which a search by cells must go, to find all that are closer than `reach`.
  KOKKOS_INLINE_FUNCTION double margin(double reach) const
  {
    return reach * (1 + 1e-6) + rounding_;
  }

  /// Calls visit(slot, separation) for every disc stored in or next to `cell` whose centre is
  /// closer to `p` than the root of `reach2`; a disc at `p` may be one of them.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_around(int cell, Vec2<Real> p, Real reach2,
                                              Visit const& visit) const
  {
    for_each_around<false>(cell, p, reach2, 0, visit);
  }

  /// The same for those of them whose id is above `above`.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_around_above(int cell, Vec2<Real> p, Real reach2, int above,
                                                    Visit const& visit) const
  {
    for_each_around<true>(cell, p, reach2, above, visit);
  }

  /// The same for pairs: over all slots it visits every two discs that are stored in the same cell
  /// or next to each other and closer than the root of `reach2`, once.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_ahead(int cell, int slot, Real reach2,
                                             Visit const& visit) const
  {
    auto const p = discs_.position(slot);
    with_ends(cell, [&](auto const& ends) {
      cells_.template for_runs_ahead<std::decay_t<decltype(ends)>::wraps>(
          cell, slot,
          [&](Runs const& runs) { for_each_in<2, false>(ends, runs, p, reach2, 0, visit); });
    });
  }

  /// The same by any test of slots: visit(k) for every such pair (slot, k) that passes test(k),
  /// which has no side effects and may be asked of any slot, and of some that do not exist.
  /// `across_ends` may be false where no neighbour is across an end of a periodic box.
  template <bool across_ends, class Test, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_ahead_that(int cell, int slot, Test const& test,
                                                  Visit const& visit) const
  {
    cells_.template for_runs_ahead<across_ends>(
        cell, slot, [&](Runs const& runs) { for_each_that<2>(runs, test, visit); });
  }

  /// Calls visit(k) for every disc stored in or next to `cell` that passes test(k), as above.
  template <bool across_ends, class Test, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_around_that(int cell, Test const& test,
                                                   Visit const& visit) const
  {
    cells_.template for_runs_around<across_ends>(
        cell, [&](Runs const& runs) { for_each_that<3>(runs, test, visit); });
  }

  /// Calls visit(slot, separation) for every disc whose centre is closer to `p` than `reach`, which
  /// may be any distance. The discs must be where they were when they were sorted.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_within(Vec2<Real> p, Real reach, Visit const& visit) const
  {
    Real const reach2 = reach * reach;
    for_runs_near<periodic>(p, static_cast<double>(reach), 0, [&](Runs const& runs) {
      for_each_in<3, false>(domain_, runs, p, reach2, 0, visit);
    });
  }

  /// Calls visit(k) for every disc among the slots from `from` on that passes test(k), as above,
  /// and was closer to `p` than `reach` when the discs were sorted; and perhaps for some farther
  /// ones.
  template <bool across_ends, class Test, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_near_that(Vec2<Real> p, double reach, int from,
                                                 Test const& test, Visit const& visit) const
  {
    for_runs_near<across_ends>(p, reach, from,
                               [&](Runs const& runs) { for_each_that<3>(runs, test, visit); });
  }

  /// Begins to fetch what a search in and around `cell` will read and others before it have not,
  /// if cells are searched in the order of their numbers: the next row.
  KOKKOS_FORCEINLINE_FUNCTION void fetch_ahead_around(int cell) const
  {
    int const begin = cells_.first_of_next_row(cell);
    discs_.fetch_motion_ahead(begin);
    discs_.fetch_motion_ahead(begin + Discs<Space, Real>::padding - 1);
  }

 private:
  /// Calls use(domain) with the domain in which discs stored in or next to `cell` are compared: the
  /// plane, without images, unless it is near an end of a periodic box. Two cells from it, discs
  /// are on this side even if they have moved by the width of a cell since they were stored.
  template <class Use>
  KOKKOS_INLINE_FUNCTION void with_ends(int cell, Use const& use) const
  {
    domain_.with_ends(!periodic || cells_.is_inner(cell, 2), use);
  }

  template <bool by_id, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_around(int cell, Vec2<Real> p, Real reach2, int above,
                                              Visit const& visit) const
  {
    with_ends(cell, [&](auto const& ends) {
      cells_.template for_runs_around<std::decay_t<decltype(ends)>::wraps>(
          cell,
          [&](Runs const& runs) { for_each_in<3, by_id>(ends, runs, p, reach2, above, visit); });
    });
  }

  /// Calls visit(runs) so that together the runs are the slots from `from` on of all cells with a
  /// point closer than `reach` to `p`.
  template <bool across_ends, class Visit>
  KOKKOS_INLINE_FUNCTION void for_runs_near(Vec2<Real> p, double reach, int from,
                                            Visit const& visit) const
  {
    Runs runs;
    int row = 0;
    cells_.template for_blocks_near<across_ends>(p, margin(reach), [&](int first, int last) {
      int const begin = cells_.start(first);
      runs.begin[row] = begin < from ? from : begin;
      runs.end[row] = cells_.start(last + 1);
      if (++row < 3)
        return;
      visit(runs);
      row = 0;
    });
    if (row == 0)
      return;
    for (; row < 3; ++row)
      runs.begin[row] = runs.end[row] = 0;
    visit(runs);
  }

  /// Visits those of the first `rows` runs, 2 or 3, that are near `p`; with `by_id`, only those of
  /// them whose id is above `above`.
  template <int rows, bool by_id, class Ends, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_in(Ends const& ends, Runs const& runs, Vec2<Real> p,
                                          Real reach2, int above, Visit const& visit) const
  {
    Real const* const x = discs_.x.data();
    Real const* const y = discs_.y.data();
    int const* const id = discs_.id.data();
    auto const domain = ends;
    auto const near = [=](int k) {
      auto const d = domain.separation(p, {x[k], y[k]});
      bool const close = dot(d, d) < reach2;
      if constexpr (by_id)
        return close & (id[k] > above);
      else
        return close;
    };
    for_each_that<rows>(runs, near, [&](int k) { visit(k, domain.separation(p, {x[k], y[k]})); });
  }

  /// Visits those of the first `rows` runs, 2 or 3, that pass a test.
  template <int rows, class Test, class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_that(Runs runs, Test const test, Visit const& visit) const
  {
    // The start of each run at once, and without a branch: what costs is mispredicted branches. The
    // arrays are padded, so that so many can always be read. Written out for each run, or compilers
    // do not find the vectors in it.
    constexpr int width = Discs<Space, Real>::padding;
    for (bool any_longer = true; any_longer;) {
      int const begin_0 = runs.begin[0], begin_1 = runs.begin[1];
      int const size_0 = runs.end[0] - begin_0, size_1 = runs.end[1] - begin_1;
      int const begin_2 = rows > 2 ? runs.begin[2] : 0;
      int const size_2 = rows > 2 ? runs.end[2] - begin_2 : 0;
      unsigned hits = 0;
#pragma omp simd reduction(| : hits)
      for (int lane = 0; lane < width; ++lane) {
        hits |= (test(begin_0 + lane) & (lane < size_0)) ? 1u << lane : 0u;
        hits |= (test(begin_1 + lane) & (lane < size_1)) ? 1u << width << lane : 0u;
        if constexpr (rows > 2)
          hits |= (test(begin_2 + lane) & (lane < size_2)) ? 1u << 2 * width << lane : 0u;
      }
      while (hits != 0) {
        int const bit = lowest_bit(hits);
        hits &= hits - 1;
        visit(runs.begin[bit / width] + bit % width);
      }
      any_longer = size_0 > width || size_1 > width || size_2 > width;
      for (int row = 0; row < rows && any_longer; ++row) {
        int const next = runs.begin[row] + width;
        runs.begin[row] = next < runs.end[row] ? next : runs.end[row];
      }
    }
  }

  Discs<Space, Real> discs_;
  Cells<Space> cells_;
  Domain<Real, periodic> domain_;
  double rounding_;
};

} // namespace ricochet
