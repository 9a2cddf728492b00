// A uniform grid over the box: which cell a point is in, and which cells are around it.
#pragma once

#include "ricochet/kokkos_compat.hpp"
#include "ricochet/vec2.hpp"

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
  KOKKOS_INLINE_FUNCTION int count() const { return stride() * (y.count + 2) + 1; }

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

  /// The cell beyond `cell` in the next row; after the last row the last cell.
  KOKKOS_INLINE_FUNCTION int in_next_row(int cell) const
  {
    int const next = cell + stride(), last = count() - 1;
    return next < last ? next : last;
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

} // namespace ricochet
