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
  KOKKOS_FORCEINLINE_FUNCTION int at(double position) const
  {
    return clamped((position - low) * per_length);
  }

  /// How far a coordinate is from a cell, in cells; not positive inside.
  KOKKOS_INLINE_FUNCTION double cells_away(double position, int cell) const
  {
    double const below = cell - (position - low) * per_length;
    return below > -below - 1 ? below : -below - 1;
  }

  /// Whether cells at the two ends are neighbours, and not next to each other in any case.
  KOKKOS_INLINE_FUNCTION bool wraps() const { return periodic && count > 2; }

  /// The cell before, or after, `cell`, if there is one.
  static constexpr int none = -1;
  KOKKOS_INLINE_FUNCTION int before(int cell) const
  {
    return cell > 0 ? cell - 1 : (wraps() ? count - 1 : none);
  }
  KOKKOS_INLINE_FUNCTION int after(int cell) const
  {
    return cell + 1 < count ? cell + 1 : (wraps() ? 0 : none);
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
  KOKKOS_FORCEINLINE_FUNCTION int clamped(double u) const
  {
    double const last = count - 1;
    double const from_0 = u > 0 ? u : 0;
    return static_cast<int>(from_0 < last ? from_0 : last);
  }
};

/// Discs stored in a block of up to 3 x 3 cells: three runs of consecutive slots begin[k]...end[k]
/// - 1, one a row of cells; a run is empty if end[k] <= begin[k].
struct Runs {
  int begin[3], end[3];
};

/// The grid on the device: which cell a point is in, and which slots a cell holds.
///
/// Cells are numbered row by row, so that neighbouring cells of a row, and therefore their discs,
/// follow each other in memory. Empty cells surround the box (a column of them after each row,
/// which is also before the next, and a row before the first and after the last), so that every
/// cell of the box has neighbours.
template <class Space>
struct Cells {
  CellAxis x, y;
  /// Cell c holds the slots start(c) ... start(c + 1) - 1, in no particular order.
  Kokkos::View<int*, Space> start;

  /// Number of cells, with those around the box.
  int count() const { return stride() * (y.count + 2) + 1; }

  template <class Real>
  KOKKOS_FORCEINLINE_FUNCTION int at(Vec2<Real> p) const
  {
    return index(y.at(static_cast<double>(p.y)), x.at(static_cast<double>(p.x)));
  }
  KOKKOS_INLINE_FUNCTION int index(int row, int column) const
  {
    return (row + 1) * stride() + column + 1;
  }
  KOKKOS_INLINE_FUNCTION int row(int cell) const { return (cell - 1) / stride() - 1; }
  KOKKOS_INLINE_FUNCTION int column(int cell) const { return (cell - 1) % stride(); }

  /// Whether a cell is at least `margin` cells from every end across which the box is periodic.
  KOKKOS_INLINE_FUNCTION bool is_inner(int cell, int margin) const
  {
    int const c = column(cell), r = row(cell);
    return (!x.periodic || (c >= margin && c < x.count - margin)) &&
           (!y.periodic || (r >= margin && r < y.count - margin));
  }

  /// Shortest side of a cell [length].
  KOKKOS_INLINE_FUNCTION double side() const
  {
    double const width = 1 / x.per_length, height = 1 / y.per_length;
    return width < height ? width : height;
  }

  /// Calls visit(runs) so that together the runs are the discs stored in `cell` and in the cells
  /// around it, each once: all that can be closer than side() to a point in `cell`.
  template <bool periodic, class Visit>
  KOKKOS_INLINE_FUNCTION void for_runs_around(int cell, Visit const& visit) const
  {
    Runs runs;
    if constexpr (periodic) {
      int const rows[3] = {y.before(row(cell)), row(cell), y.after(row(cell))};
      for_columns(column(cell), [&](int first, int last) {
        for (int k = 0; k < 3; ++k)
          set_run(runs, k, rows[k], first, last);
        visit(runs);
      });
    } else {
      for (int k = 0; k < 3; ++k)
        set_run(runs, k, cell + (k - 1) * stride());
      visit(runs);
    }
  }

  /// Half of for_runs_around(): what follows `slot`, which `cell` holds, in its own cell, and the
  /// cells to the right and in the next row. Over all slots each pair of discs is met once.
  template <bool periodic, class Visit>
  KOKKOS_INLINE_FUNCTION void for_runs_ahead(int cell, int slot, Visit const& visit) const
  {
    Runs runs;
    runs.begin[0] = slot + 1;
    if constexpr (periodic) {
      int const own = row(cell), next = y.after(own);
      bool across = false;
      for_columns(column(cell), [&](int first, int last) {
        if (!across)
          runs.end[0] = start(index(own, last) + 1);
        else // to the right of the last column is the first
          set_run(runs, 0, last == 0 ? own : CellAxis::none, first, last);
        set_run(runs, 1, next, first, last);
        visit(runs);
        across = true;
      });
    } else {
      runs.end[0] = start(cell + 2);
      set_run(runs, 1, cell + stride());
      visit(runs);
    }
  }

  /// The first of the slots that for_runs_around() visits in the next row, or the one that would be
  /// there.
  KOKKOS_INLINE_FUNCTION int first_of_next_row(int cell) const
  {
    return start(cell + stride() - 1);
  }

  /// Calls visit(c) for all cells of the box that for_runs_around() looks into, each once; and for
  /// some outside, which are empty, where nothing is periodic.
  template <bool periodic, class Visit>
  KOKKOS_INLINE_FUNCTION void for_cells_around(int cell, Visit const& visit) const
  {
    if constexpr (periodic) {
      int const rows[3] = {y.before(row(cell)), row(cell), y.after(row(cell))};
      for (int const r : rows)
        if (r != CellAxis::none)
          for_columns(column(cell), [&](int first, int last) {
            for (int c = first; c <= last; ++c)
              visit(index(r, c));
          });
    } else {
      for (int middle = cell - stride(); middle <= cell + stride(); middle += stride())
        for (int c = middle - 1; c <= middle + 1; ++c)
          visit(c);
    }
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
  KOKKOS_INLINE_FUNCTION int stride() const { return x.count + 1; }

  /// A cell and those to its left and right.
  KOKKOS_INLINE_FUNCTION void set_run(Runs& runs, int k, int middle) const
  {
    runs.begin[k] = start(middle - 1);
    runs.end[k] = start(middle + 2);
  }

  /// Columns first...last of a row, or nothing.
  KOKKOS_INLINE_FUNCTION void set_run(Runs& runs, int k, int row, int first, int last) const
  {
    bool const any = row != CellAxis::none;
    runs.begin[k] = any ? start(index(row, first)) : 0;
    runs.end[k] = any ? start(index(row, last) + 1) : 0;
  }

  /// Calls visit(first, last) for the columns next to and at `column`, and again for the one across
  /// the edge of a periodic box.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_columns(int column, Visit const& visit) const
  {
    visit(column > 0 ? column - 1 : 0, column + 1 < x.count ? column + 1 : column);
    if (x.wraps() && (column == 0 || column + 1 == x.count)) {
      int const across = column == 0 ? x.count - 1 : 0;
      visit(across, across);
    }
  }

  template <bool periodic, class Real, class Visit>
  KOKKOS_INLINE_FUNCTION void for_rows(Span rows, Vec2<Real> p, double reach, Span columns,
                                       Visit const& visit) const
  {
    for (int row = rows.first; row <= rows.last; ++row) {
      int const start_of_row = index(row, 0);
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
  Kokkos::View<int*, Space> start, order, id;

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

/// The order of discs inside a cell.
enum class Inside { any_order, by_id };

/// Keeps discs stored in cell order. Owns the grid and all scratch of the sort.
template <class Space, class Real>
class CellGrid {
 public:
  using Ints = Kokkos::View<int*, Space>;

  /// Least side of a cell that suits engines which sort in every step [diameters].
  static constexpr double default_side = 1.375;

  /// A grid for `count` discs of `model`, whose cells are at least `least_side` diameters wide,
  /// where the box is.
  CellGrid(Model const& model, int count, double least_side = default_side)
    : spare_(count),
      unsorted_cell_(uninitialised<Ints>("ricochet::unsorted_cell", count)),
      rank_(uninitialised<Ints>("ricochet::rank_in_cell", count)),
      cell_(uninitialised<Ints>("ricochet::cell_of_slot", count))
  {
    Box const& box = model.box;
    // Larger cells where discs are sparse, or there would be many empty ones to go through. No
    // larger than that, for where discs settle three cells in a row would hold more of them than a
    // search reads at once.
    double const sparse = std::sqrt(0.3 * box.width / std::max(count, 1) * box.height);
    double const side = std::max(least_side * 2 * model.radius, sparse);
    cells_.x = axis(box.width, box.x, side, count);
    cells_.y = axis(box.height, box.y, side, count);
    cells_.start = Ints("ricochet::cell_start", static_cast<std::size_t>(cells_.count()) + 1);
  }

  /// Stores the discs by cell. Inside a cell their order is whatever the scheduler made it, so
  /// nothing may depend on it; or it is that of their ids, which takes longer and makes the order
  /// of storage a function of the state. Slots change; `discs` and the grid's spare memory change
  /// places.
  void sort(Space const& space, Discs<Space, Real>& discs, Inside inside = Inside::any_order);

  Cells<Space> const& cells() const { return cells_; }

  /// Of each slot, as of the last sort: its cell.
  Ints const& cell() const { return cell_; }

  /// Memory for N discs, and for two numbers a disc, that is free between sorts. Its contents are
  /// lost in the next sort.
  Discs<Space, Real> const& spare() const { return spare_; }
  Ints const& scratch() const { return unsorted_cell_; }
  Ints const& more_scratch() const { return rank_; }

 private:
  static CellAxis axis(double length, Boundary boundary, double side, int discs)
  {
    // A box may be much longer than wide, but never needs more cells along it than this.
    double const most = 1.0 * discs + 1;
    auto const count = static_cast<int>(std::max(1.0, std::min(std::floor(length / side), most)));
    return {-length / 2, length, count / length, count, boundary == Boundary::periodic};
  }

  Cells<Space> cells_;
  Discs<Space, Real> spare_;
  Ints unsorted_cell_, rank_, cell_;
};

template <class Space, class Real>
void CellGrid<Space, Real>::sort(Space const& space, Discs<Space, Real>& discs, Inside inside)
{
  int const n = discs.count();
  auto const from = discs, to = spare_;
  auto const cells = cells_;
  auto const start = cells_.start, unsorted_cell = unsorted_cell_, rank = rank_, cell = cell_;

  Kokkos::deep_copy(space, start, 0);
  Kokkos::parallel_for(
      "ricochet::count_in_cells", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int i) {
        int const c = cells.at(from.position(i));
        unsorted_cell(i) = c;
        rank(i) = fetch_add<Space>(start(c), 1);
      });
  // In blocks, whose sums stay in a register.
  constexpr int block = block_on_host<Space, 64>;
  int const counts = cells.count() + 1;
  scan(
      "ricochet::scan_cells", space, blocks_of(block, counts),
      KOKKOS_LAMBDA(int b, int& before, bool final) {
        int const first = b * block, last = first + block < counts ? first + block : counts;
        int sum = before;
        for (int c = first; c < last; ++c) {
          int const here = start(c);
          if (final)
            start(c) = sum;
          sum += here;
        }
        before = sum;
      });
  if (inside == Inside::by_id) {
    auto const order = cell_; // not needed yet
    Kokkos::parallel_for(
        "ricochet::list_cells", Range<Space>(space, 0, n),
        KOKKOS_LAMBDA(int i) { order(start(unsorted_cell(i)) + rank(i)) = i; });
    Kokkos::parallel_for("ricochet::sort_cells_by_id", Range<Space>(space, 0, cells.count()),
                         SortCellById<Space>{start, order, from.id});
    Kokkos::parallel_for(
        "ricochet::rank_by_id", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int slot) {
          int const i = order(slot);
          rank(i) = slot - start(unsorted_cell(i));
        });
  }
  Kokkos::parallel_for(
      "ricochet::store_by_cell", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int i) {
        int const c = unsorted_cell(i), slot = start(c) + rank(i);
        to.set_position(slot, from.position(i));
        to.set_velocity(slot, from.velocity(i));
        to.id(slot) = from.id(i);
        cell(slot) = c;
      });
  std::swap(discs, spare_);
}

} // namespace ricochet
