// A uniform grid over the box, and the sort that stores discs in the order of its cells.
#pragma once

#include "ricochet/discs.hpp"
#include "ricochet/model.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace ricochet {

/// The grid on the device: which cell a point is in, and which slots a cell holds.
///
/// Cells are numbered row by row, so that neighbouring cells of a row, and therefore their discs,
/// follow each other in memory. Points outside the box count as in the nearest cell: clamping never
/// increases the distance between two cells, so neighbours stay neighbours.
template <class Space>
struct Cells {
  double low_x = 0, low_y = 0;               ///< the box's lower left corner
  double per_length_x = 1, per_length_y = 1; ///< cells per length
  int nx = 1, ny = 1;
  bool periodic_x = false, periodic_y = false;
  /// Cell c holds the slots start(c) ... start(c + 1) - 1, in the order of their ids.
  Kokkos::View<int*, typename Space::memory_space> start;

  int count() const { return nx * ny; }

  template <class Real>
  KOKKOS_INLINE_FUNCTION int column(Real x) const
  {
    return clamped((static_cast<double>(x) - low_x) * per_length_x, nx);
  }

  template <class Real>
  KOKKOS_INLINE_FUNCTION int row(Real y) const
  {
    return clamped((static_cast<double>(y) - low_y) * per_length_y, ny);
  }

  template <class Real>
  KOKKOS_INLINE_FUNCTION int at(Vec2<Real> p) const
  {
    return row(p.y) * nx + column(p.x);
  }

  /// Calls visit(first, last) for blocks of cells first...last, contiguous in number, which
  /// together are the cell of `p` and all its neighbours, each once.
  template <bool periodic, class Real, class Visit>
  KOKKOS_INLINE_FUNCTION void for_neighbours(Vec2<Real> p, Visit const& visit) const
  {
    int const here = row(p.y);
    if (here > 0)
      for_row<periodic>(here - 1, p.x, visit);
    for_row<periodic>(here, p.x, visit);
    if (here + 1 < ny)
      for_row<periodic>(here + 1, p.x, visit);
    if constexpr (periodic) {
      // With fewer than three rows the neighbours across the edge were visited already.
      if (periodic_y && ny >= 3) {
        if (here == 0)
          for_row<periodic>(ny - 1, p.x, visit);
        if (here == ny - 1)
          for_row<periodic>(0, p.x, visit);
      }
    }
  }

 private:
  template <bool periodic, class Real, class Visit>
  KOKKOS_INLINE_FUNCTION void for_row(int r, Real x, Visit const& visit) const
  {
    int const here = column(x), row_start = r * nx;
    visit(row_start + (here > 0 ? here - 1 : 0), row_start + (here + 1 < nx ? here + 1 : here));
    if constexpr (periodic) {
      if (periodic_x && nx >= 3) {
        if (here == 0)
          visit(row_start + nx - 1, row_start + nx - 1);
        if (here == nx - 1)
          visit(row_start, row_start);
      }
    }
  }

  /// Cell coordinate of a grid coordinate: no cast of a number that does not fit, whatever it is.
  KOKKOS_INLINE_FUNCTION static int clamped(double u, int n)
  {
    if (!(u > 0))
      return 0;
    return u < n ? static_cast<int>(u) : n - 1;
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

  /// A grid for `count` discs in which any two discs whose separation is computed to be less than a
  /// diameter are in the same or in neighbouring cells.
  CellGrid(Model const& model, int count)
    : spare_(count),
      cell_(uninitialised<Ints>("ricochet::cell_of_disc", count)),
      rank_(uninitialised<Ints>("ricochet::rank_in_cell", count)),
      order_(uninitialised<Ints>("ricochet::sort_order", count)),
      slot_of_id_(uninitialised<Ints>("ricochet::slot_of_id", count))
  {
    Box const& box = model.box;
    // Rounding moves a computed separation by a few units in the last place of the coordinates, and
    // the place in the grid by less than a part in 10^6.
    double const reach = 2 * model.radius * (1 + 1e-6) +
                         8 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
                             std::max(box.width, box.height);
    // Fewer, larger cells where discs are sparse: 0.6 discs a cell was the fastest.
    double const sparse = std::sqrt(0.6 * box.width / std::max(count, 1) * box.height);
    double const side = std::max(reach, sparse);
    cells_.low_x = -box.width / 2;
    cells_.low_y = -box.height / 2;
    cells_.nx = cells_along(box.width, side, count);
    cells_.ny = cells_along(box.height, side, count);
    cells_.per_length_x = cells_.nx / box.width;
    cells_.per_length_y = cells_.ny / box.height;
    cells_.periodic_x = box.x == Boundary::periodic;
    cells_.periodic_y = box.y == Boundary::periodic;
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
  static int cells_along(double length, double side, int count)
  {
    // A box may be much longer than wide, but never needs more cells along it than this.
    double const most = 2.0 * count + 1;
    return static_cast<int>(std::max(1.0, std::min(std::floor(length / side), most)));
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
