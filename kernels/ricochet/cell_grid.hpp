// A uniform grid over the box, and the sort that stores discs in the order of its cells.
#pragma once

#include "ricochet/discs.hpp"
#include "ricochet/model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet {

/// Cells first...last along an axis; none if last < first.
struct Span {
  int first, last;
};

/// The cells along one axis of the box. Points outside the box count as in the nearest cell.
struct CellAxis {
  double low = 0;        ///< where the box begins
  double length = 1;     ///< of the box
  double per_length = 1; ///< cells per length
  int count = 1;
  bool periodic = false;

  /// Cell of a coordinate.
  KOKKOS_INLINE_FUNCTION int at(double position) const
  {
    return clamped((position - low) * per_length);
  }

  /// Cells with a point closer than `reach`, this side of the ends.
  KOKKOS_INLINE_FUNCTION Span near(double position, double reach) const
  {
    double const u = (position - low) * per_length, width = reach * per_length;
    return {clamped(u - width), clamped(u + width)};
  }

  /// Those beyond the low end of a periodic axis, which are at its high end. None is in `near` too.
  KOKKOS_INLINE_FUNCTION Span across_low_end(double position, double reach, Span near) const
  {
    if (!periodic || position - reach >= low)
      return {0, -1};
    int const first = at(position - reach + length);
    return {first > near.last ? first : near.last + 1, count - 1};
  }

  /// Those beyond the high end of a periodic axis, which are at its low end. None is in `near` too.
  KOKKOS_INLINE_FUNCTION Span across_high_end(double position, double reach, Span near) const
  {
    if (!periodic || position + reach < low + length)
      return {0, -1};
    int const last = at(position + reach - length);
    return {0, last < near.first ? last : near.first - 1};
  }

 private:
  /// No number is cast that does not fit, whatever it is.
  KOKKOS_INLINE_FUNCTION int clamped(double u) const
  {
    double const last = count - 1;
    double const from_0 = u > 0 ? u : 0;
    return static_cast<int>(from_0 < last ? from_0 : last);
  }
};

/// The grid on the device: which cell a point is in, and which slots a cell holds.
///
/// Cells are numbered row by row, so that neighbouring cells of a row, and therefore their discs,
/// follow each other in memory.
template <class Space>
struct Cells {
  CellAxis x, y;
  /// Cell c holds the slots start(c) ... start(c + 1) - 1, in the order of their ids.
  Kokkos::View<int*, typename Space::memory_space> start;

  int count() const { return x.count * y.count; }

  template <class Real>
  KOKKOS_INLINE_FUNCTION int at(Vec2<Real> p) const
  {
    return y.at(static_cast<double>(p.y)) * x.count + x.at(static_cast<double>(p.x));
  }

  /// Calls visit(first, last) for blocks of cells first...last, contiguous in number, which
  /// together are all cells with a point closer than `reach` to `p` along each axis, each cell
  /// once.
  template <bool periodic, class Real, class Visit>
  KOKKOS_INLINE_FUNCTION void for_blocks_near(Vec2<Real> p, double reach, Visit const& visit) const
  {
    Span const columns = x.near(static_cast<double>(p.x), reach);
    Span const rows = y.near(static_cast<double>(p.y), reach);
    for_rows<periodic>(rows, p, reach, columns, visit);
    if constexpr (periodic) {
      for_rows<periodic>(y.across_low_end(static_cast<double>(p.y), reach, rows), p, reach, columns,
                         visit);
      for_rows<periodic>(y.across_high_end(static_cast<double>(p.y), reach, rows), p, reach,
                         columns, visit);
    }
  }

 private:
  template <bool periodic, class Real, class Visit>
  KOKKOS_INLINE_FUNCTION void for_rows(Span rows, Vec2<Real> p, double reach, Span columns,
                                       Visit const& visit) const
  {
    for (int row = rows.first; row <= rows.last; ++row) {
      int const start_of_row = row * x.count;
      visit(start_of_row + columns.first, start_of_row + columns.last);
      if constexpr (periodic) {
        Span const low = x.across_low_end(static_cast<double>(p.x), reach, columns);
        if (low.first <= low.last)
          visit(start_of_row + low.first, start_of_row + low.last);
        Span const high = x.across_high_end(static_cast<double>(p.x), reach, columns);
        if (high.first <= high.last)
          visit(start_of_row + high.first, start_of_row + high.last);
      }
    }
  }
};

/// Sorts order(first)...order(last - 1) by the id of the slot each entry names.
template <class Space>
struct SortCellById {
  Kokkos::View<int*, typename Space::memory_space> start, order, id;

  KOKKOS_INLINE_FUNCTION void operator()(int cell) const
  {
    int const first = start(cell), n = start(cell + 1) - first;
    if (n < 2)
      return;
    constexpr int few = 32;
    if (n <= few)
      insertion_sort(&order(first), n);
    else
      heap_sort(&order(first), n);
  }

 private:
  KOKKOS_INLINE_FUNCTION bool before(int a, int b) const { return id(a) < id(b); }

  KOKKOS_INLINE_FUNCTION void insertion_sort(int* entries, int n) const
  {
    for (int i = 1; i < n; ++i) {
      int const entry = entries[i];
      int k = i;
      for (; k > 0 && before(entry, entries[k - 1]); --k)
        entries[k] = entries[k - 1];
      entries[k] = entry;
    }
  }

  // For cells that a crowd of discs has gathered in.
  KOKKOS_INLINE_FUNCTION void heap_sort(int* entries, int n) const
  {
    for (int root = n / 2 - 1; root >= 0; --root)
      sift_down(entries, root, n);
    for (int end = n - 1; end > 0; --end) {
      int const largest = entries[0];
      entries[0] = entries[end];
      entries[end] = largest;
      sift_down(entries, 0, end);
    }
  }

  KOKKOS_INLINE_FUNCTION void sift_down(int* entries, int root, int n) const
  {
    int const entry = entries[root];
    for (int child = 2 * root + 1; child < n; child = 2 * root + 1) {
      if (child + 1 < n && before(entries[child], entries[child + 1]))
        ++child;
      if (!before(entry, entries[child]))
        break;
      entries[root] = entries[child];
      root = child;
    }
    entries[root] = entry;
  }
};

/// Keeps discs stored in cell order. Owns the grid and all scratch of the sort.
template <class Space, class Real>
class CellGrid {
 public:
  using Ints = Kokkos::View<int*, typename Space::memory_space>;

  /// A grid for `count` discs of `model`.
  CellGrid(Model const& model, int count)
    : spare_(count),
      cell_(uninitialised<Ints>("ricochet::cell_of_disc", count)),
      rank_(uninitialised<Ints>("ricochet::rank_in_cell", count)),
      order_(uninitialised<Ints>("ricochet::sort_order", count)),
      slot_of_id_(uninitialised<Ints>("ricochet::slot_of_id", count))
  {
    Box const& box = model.box;
    // Larger cells where discs are sparse, or there would be many empty ones to go through.
    double const sparse = std::sqrt(0.3 * box.width / std::max(count, 1) * box.height);
    double const side = std::max(2 * model.radius, sparse);
    cells_.x = axis(box.width, box.x, side, count);
    cells_.y = axis(box.height, box.y, side, count);
    cells_.start = Ints("ricochet::cell_start", static_cast<std::size_t>(cells_.count()) + 1);
  }

  /// Stores the discs by cell and, inside a cell, by id: an order that depends on nothing but the
  /// state. Slots change; `discs` and the grid's spare memory change places.
  void sort(Space const& space, Discs<Space, Real>& discs);

  Cells<Space> const& cells() const { return cells_; }

  /// Slot of each id, as of the last sort.
  Ints const& slot_of_id() const { return slot_of_id_; }

  /// Memory for N discs that is free between sorts. Its contents are lost in the next sort.
  Discs<Space, Real>& spare() { return spare_; }

 private:
  static CellAxis axis(double length, Boundary boundary, double side, int discs)
  {
    // A box may be much longer than wide, but never needs more cells along it than this.
    double const most = 2.0 * discs + 1;
    auto const count = static_cast<int>(std::max(1.0, std::min(std::floor(length / side), most)));
    return {-length / 2, length, count / length, count, boundary == Boundary::periodic};
  }

  Cells<Space> cells_;
  Discs<Space, Real> spare_;
  Ints cell_, rank_, order_, slot_of_id_;
};

template <class Space, class Real>
void CellGrid<Space, Real>::sort(Space const& space, Discs<Space, Real>& discs)
{
  using Range = Kokkos::RangePolicy<Space>;
  int const n = discs.count();
  auto const from = discs, to = spare_;
  auto const cells = cells_;
  auto const start = cells_.start, cell = cell_, rank = rank_, order = order_,
             slot_of_id = slot_of_id_;

  Kokkos::deep_copy(space, start, 0);
  // The rank inside a cell is whatever the scheduler made it; the sort by id repairs that.
  Kokkos::parallel_for(
      "ricochet::count_in_cells", Range(space, 0, n), KOKKOS_LAMBDA(int i) {
        int const c = cells.at(from.position(i));
        cell(i) = c;
        rank(i) = Kokkos::atomic_fetch_add(&start(c), 1);
      });
  Kokkos::parallel_scan(
      "ricochet::scan_cells", Range(space, 0, cells.count() + 1),
      KOKKOS_LAMBDA(int c, int& before, bool final) {
        int const here = start(c);
        if (final)
          start(c) = before;
        before += here;
      });
  Kokkos::parallel_for(
      "ricochet::fill_cells", Range(space, 0, n),
      KOKKOS_LAMBDA(int i) { order(start(cell(i)) + rank(i)) = i; });
  Kokkos::parallel_for("ricochet::sort_cells_by_id", Range(space, 0, cells.count()),
                       SortCellById<Space>{start, order, from.id});
  Kokkos::parallel_for(
      "ricochet::store_by_cell", Range(space, 0, n), KOKKOS_LAMBDA(int slot) {
        int const i = order(slot);
        to.set_position(slot, from.position(i));
        to.set_velocity(slot, from.velocity(i));
        to.id(slot) = from.id(i);
        slot_of_id(from.id(i)) = slot;
      });
  std::swap(discs, spare_);
}

} // namespace ricochet
