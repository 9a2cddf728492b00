// The sort that stores discs in the order of the cells of a grid.
#pragma once

#include "ricochet/cells.hpp"
#include "ricochet/discs.hpp"
#include "ricochet/model.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ricochet {

/// Whether discs that stay in their cells are counted apart from those that come, see below.
template <class Space>
constexpr bool counts_staying = shares_host_memory<Space> && !one_at_a_time<Space>;

/// Finds the cell of each disc, and counts and ranks the discs of each cell: a block of discs at a
/// time, first all cells, in vectors, then all counts.
///
/// Threads of a host that share counters pay some twenty cycles a disc. So for them discs that are
/// still in the cell they are stored in are counted apart: they follow each other in memory, so one
/// work item sees them all. Only where they go on from the block before they count as if they came.
template <class Space, class Real>
struct CountInCells {
  static constexpr int block = block_on_host<Space, 64>;

  Discs<Space, Real> discs;
  Cells<Space> cells; ///< starts become numbers of discs, but for those counted apart
  Kokkos::View<int*, Space> staying; ///< by cell: those
  Kokkos::View<int*, Space> stored;  ///< by slot: cell as of the last sort, or 0 before the first
  Kokkos::View<int*, Space> cell;    ///< by slot: cell now
  Kokkos::View<int*, Space> rank;    ///< by slot: for SlotOf

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    int const first = b * block, n = discs.count(), end = first + block < n ? first + block : n;
    for (int i = first; i < end; ++i)
      cell(i) = cells.at(discs.position(i));
    // Discs that come to the next row are the first there, which no hardware foresees.
    for (int i = first; i < end; i += per_cache_line<Real>)
      fetch_ahead(cells.start(cells.in_next_row(cell(i))));
    if constexpr (counts_staying<Space>)
      count_apart(first, end);
    else
      for (int i = first; i < end; ++i)
        rank(i) = fetch_add<Space>(cells.start(cell(i)), 1);
  }

 private:
  KOKKOS_INLINE_FUNCTION void count_apart(int first, int end) const
  {
    int const* const was = stored.data();
    int const* const now = cell.data();
    int* const stayed = staying.data();
    int* const ranks = rank.data();
    int came[block], others = 0;
    int i = first;
    for (; first > 0 && i < end && was[i] == was[first - 1]; ++i)
      came[others++] = i;
    int here = 0;                              // have stayed, of the cell gone through
    for (int cell_before = -1; i < end; ++i) { // without a branch: what costs is mispredicted ones
      int const stays = now[i] == was[i];
      here &= -static_cast<int>(was[i] == cell_before);
      cell_before = was[i];
      ranks[i] = here;
      here += stays;
      stayed[was[i]] = here;
      came[others] = i;
      others += 1 - stays;
    }
    for (int k = 0; k < others; ++k)
      rank(came[k]) = ~fetch_add<Space>(cells.start(now[came[k]]), 1);
  }
};

/// Where discs are stored once it is known where cells start: those of ranks 0, 1, ... from the
/// start of their cell on, those of ranks -1, -2, ... from its end back.
template <class Space>
struct SlotOf {
  Kokkos::View<int*, Space> start, cell, rank;

  KOKKOS_INLINE_FUNCTION int operator()(int i) const
  {
    bool const from_end = counts_staying<Space> && rank(i) < 0;
    return start(cell(i) + (from_end ? 1 : 0)) + rank(i);
  }
};

/// Stores discs in their slots. A block of discs at a time: first all slots, then one array after
/// the other.
template <class Space, class Real>
struct StoreByCell {
  static constexpr int block = block_on_host<Space, 32>;

  Discs<Space, Real> from, to;
  Cells<Space> cells;
  SlotOf<Space> slot_of;
  Kokkos::View<int*, Space> stored_cell; ///< by slot

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    int const first = b * block, n = from.count(), end = first + block < n ? first + block : n;
    auto const& cell = slot_of.cell;
    int slot[block];
    for (int i = first; i < end; ++i)
      slot[i - first] = slot_of(i);
    int const next_row = cells.start(cells.in_next_row(cell(first))) + block;
    for (int k = next_row; k < next_row + block && k < n; k += per_cache_line<Real>) {
      to.fetch_motion_ahead(k);
      fetch_ahead(to.id(k));
      fetch_ahead(stored_cell(k));
    }
    auto const store = [&](auto const& values, auto const& stored) {
      for (int i = first; i < end; ++i)
        stored(slot[i - first]) = values(i);
    };
    store(from.x, to.x);
    store(from.y, to.y);
    store(from.vx, to.vx);
    store(from.vy, to.vy);
    store(from.id, to.id);
    store(cell, stored_cell);
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
      cell_("ricochet::cell_of_slot", count)
  {
    Box const& box = model.box;
    // Larger cells where discs are sparse, or there would be many empty ones to go through. No
    // larger than that, for where discs settle three cells in a row would hold more of them than a
    // search reads at once.
    double const sparse = std::sqrt(0.3 * box.width / std::max(count, 1) * box.height);
    double const side = std::max(least_side * 2 * model.radius, sparse);
    cells_.x = axis(box.width, box.x, side, count);
    cells_.y = axis(box.height, box.y, side, count);
    auto const starts = static_cast<std::size_t>(cells_.count()) + 1;
    cells_.start = Ints("ricochet::cell_start", starts);
    staying_ = Ints("ricochet::staying_in_cell", counts_staying<Space> ? starts : 0);
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
  Ints unsorted_cell_, rank_, cell_, staying_;
};

template <class Space, class Real>
void CellGrid<Space, Real>::sort(Space const& space, Discs<Space, Real>& discs, Inside inside)
{
  int const n = discs.count();
  auto const from = discs, to = spare_;
  auto const cells = cells_;
  auto const start = cells_.start, staying = staying_;
  auto const unsorted_cell = unsorted_cell_, rank = rank_, cell = cell_;
  SlotOf<Space> const slot_of{start, unsorted_cell, rank};

  Kokkos::deep_copy(space, start, 0);
  Kokkos::deep_copy(space, staying, 0);
  using Count = CountInCells<Space, Real>;
  Kokkos::parallel_for("ricochet::count_in_cells",
                       Range<Space>(space, 0, blocks_of(Count::block, n)),
                       Count{from, cells, staying, cell, unsorted_cell, rank});
  // In blocks, whose sums stay in a register.
  constexpr int block = block_on_host<Space, 64>;
  constexpr bool apart = counts_staying<Space>;
  int const counts = cells.count() + 1;
  scan(
      "ricochet::scan_cells", space, blocks_of(block, counts),
      KOKKOS_LAMBDA(int b, int& before, bool final) {
        int const first = b * block, last = first + block < counts ? first + block : counts;
        int sum = before;
        for (int c = first; c < last; ++c) {
          int const here = start(c) + (apart ? staying(c) : 0);
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
        KOKKOS_LAMBDA(int i) { order(slot_of(i)) = i; });
    Kokkos::parallel_for("ricochet::sort_cells_by_id", Range<Space>(space, 0, cells.count()),
                         SortCellById<Space>{start, order, from.id});
    Kokkos::parallel_for(
        "ricochet::rank_by_id", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int slot) {
          int const i = order(slot);
          rank(i) = slot - start(unsorted_cell(i));
        });
  }
  using Store = StoreByCell<Space, Real>;
  Kokkos::parallel_for("ricochet::store_by_cell",
                       Range<Space>(space, 0, blocks_of(Store::block, n)),
                       Store{from, to, cells, slot_of, cell});
  std::swap(discs, spare_);
}

} // namespace ricochet
