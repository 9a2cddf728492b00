// The pair step of engine `sweep`: every overlapping pair responds, in lexicographic order of ids.
//
// The original tests all pairs (i, j), i < j, row by row, and changes the discs in place:
// velocities of both follow the contact law, and disc j is pushed out of the overlap along the
// normal. Two facts make this cheap without changing a bit of it:
//  - Row i moves only discs j > i, so disc i stands still during its row, and which partners it has
//    is fixed when the row starts.
//  - A pair that overlaps when its turn comes did so at the start of the step, or became so when
//    one of the two was last pushed. So it suffices to visit the rows that overlapped at the start
//    and, after each push, those of the pushed disc's new contacts.
#pragma once

#include "ricochet/contact_law.hpp"
#include "ricochet/contacts.hpp"

namespace ricochet {

/// Finds discs by where they are now, while some of them are being pushed about.
///
/// The cells keep the discs they held at the last sort; a disc pushed into another cell is a stray
/// and is listed there as well. Who meets a disc twice meets the same disc.
template <class Space>
struct Strays {
  using Ints = Kokkos::View<int*, typename Space::memory_space>;

  Ints first_in_cell; ///< first stray of each cell, or none
  Ints next;          ///< next stray of the same cell, by slot
  Ints cell;          ///< cell in which a disc is listed as a stray, or none, by slot
  static constexpr int none = -1;

  Strays() = default;
  Strays(int cells, int discs)
    : first_in_cell("ricochet::first_stray_in_cell", cells),
      next(uninitialised<Ints>("ricochet::next_stray", discs)),
      cell("ricochet::stray_cell", discs)
  {
    Kokkos::deep_copy(first_in_cell, none);
    Kokkos::deep_copy(cell, none);
  }

  /// Notes that disc `slot` is now in cell `c`.
  KOKKOS_INLINE_FUNCTION void moved(Cells<Space> const& cells, int slot, int c) const
  {
    if (cell(slot) == c)
      return;
    forget(slot);
    bool const at_home = slot >= cells.start(c) && slot < cells.start(c + 1);
    if (!at_home) {
      next(slot) = first_in_cell(c);
      first_in_cell(c) = slot;
      cell(slot) = c;
    }
  }

  /// Takes disc `slot` off the list it is on, if any.
  KOKKOS_INLINE_FUNCTION void forget(int slot) const
  {
    if (cell(slot) == none)
      return;
    int* link = &first_in_cell(cell(slot));
    while (*link != slot)
      link = &next(*link);
    *link = next(slot);
    cell(slot) = none;
  }

  /// Takes all `discs` discs off their lists.
  KOKKOS_INLINE_FUNCTION void clear(int discs) const
  {
    for (int slot = 0; slot < discs; ++slot) {
      if (cell(slot) == none)
        continue;
      first_in_cell(cell(slot)) = none;
      cell(slot) = none;
    }
  }
};

/// All rows in order, by one thread.
template <class Space, class Real, class LawType, bool periodic>
struct ResolveInOrder {
  PairState<Space, Real, periodic> state; ///< rows still to come are marked in its contacts
  Strays<Space> strays;
  LawType law;

  KOKKOS_INLINE_FUNCTION void operator()(int) const
  {
    Books books;
    int const n = state.discs.count();
    int flagged = 0;
    for (int id = 0; id < n; ++id)
      flagged += state.contacts(id) == contact::with_higher_id ? 1 : 0;
    // Where most rows have partners anyway, looking at all of them is cheaper than finding out
    // after each push which are to be looked at.
    bool const every_row = flagged > n / 4;
    for (int id = 0; id < n; ++id)
      if (every_row || state.contacts(id) == contact::with_higher_id)
        resolve_row(id, !every_row, books);
    strays.clear(n);
    state.books().merge(books);
  }

 private:
  /// The partners of a row that come next: the lowest ids above those done so far.
  struct Batch {
    static constexpr int capacity = 16;
    int id[capacity], slot[capacity];
    int size = 0;

    KOKKOS_INLINE_FUNCTION void insert(int new_id, int new_slot)
    {
      int at = size;
      while (at > 0 && id[at - 1] > new_id)
        --at;
      if (at == capacity || (at > 0 && id[at - 1] == new_id))
        return;
      size = size < capacity ? size + 1 : capacity;
      for (int k = size - 1; k > at; --k) {
        id[k] = id[k - 1];
        slot[k] = slot[k - 1];
      }
      id[at] = new_id;
      slot[at] = new_slot;
    }
  };

  KOKKOS_INLINE_FUNCTION void resolve_row(int id, bool mark, Books& books) const
  {
    int const i = state.slot_of_id(id);
    int done = id;
    for (bool more = true; more;) {
      Batch batch;
      for_overlapping(i, [&](int k) {
        if (state.discs.id(k) > done)
          batch.insert(state.discs.id(k), k);
      });
      for (int k = 0; k < batch.size; ++k) {
        collide(i, batch.slot[k], books);
        if (mark)
          mark_new_contacts(id, batch.slot[k]);
      }
      more = batch.size == Batch::capacity;
      done = more ? batch.id[batch.size - 1] : done;
    }
  }

  /// Both velocities follow the law; the second disc is pushed out of the overlap.
  KOKKOS_INLINE_FUNCTION void collide(int i, int j, Books& books) const
  {
    auto const separation =
        state.domain.separation(state.discs.position(i), state.discs.position(j));
    Real const distance = sqrt(dot(separation, separation));
    auto const normal = contact_normal(separation, distance);
    PairVelocity<Real> const before{state.discs.velocity(i), state.discs.velocity(j)};
    auto const after = law(normal, before);
    state.discs.set_velocity(i, after.first);
    state.discs.set_velocity(j, after.second);

    auto const from = state.discs.position(j);
    auto const to = from + (state.diameter - distance) * normal;
    state.discs.set_position(j, state.domain.wrapped(to));
    strays.moved(state.cells, j, state.cells.at(state.discs.position(j)));

    ++books.collisions;
    if (dot(before.second - before.first, normal) >= 0)
      ++books.separating_hits;
    enter_collision(before, after, separation, state.scales, books);
    books.numerical.add(state.gravity * (static_cast<double>(to.y) - static_cast<double>(from.y)),
                        state.scales.energy);
  }

  /// Marks the rows, later than `row`, of all pairs of disc `j` with a disc it now overlaps.
  KOKKOS_INLINE_FUNCTION void mark_new_contacts(int row, int j) const
  {
    int const id = state.discs.id(j);
    for_overlapping(j, [&](int k) {
      int const lower = state.discs.id(k) < id ? state.discs.id(k) : id;
      if (lower > row)
        state.contacts(lower) = contact::with_higher_id;
    });
  }

  /// Calls visit(k) for every disc that overlaps disc `i` now; for a stray perhaps twice.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_overlapping(int i, Visit const& visit) const
  {
    auto const p = state.discs.position(i);
    auto const visit_others = [&](int k, Vec2<Real>) {
      if (k != i)
        visit(k);
    };
    state.neighbours.for_blocks_near(p, [&](int first, int last) {
      state.neighbours.for_each_in_block(p, first, last, visit_others);
      for (int c = first; c <= last; ++c)
        for (int k = strays.first_in_cell(c); k != Strays<Space>::none; k = strays.next(k))
          state.neighbours.test(p, k, visit_others);
    });
  }
};

/// Pair step of engine `sweep`.
template <class Space, class Real>
class OrderedPairs {
 public:
  OrderedPairs(Cells<Space> const& cells, int discs) : strays_(cells.count(), discs) {}

  template <class LawType, bool periodic>
  void resolve(Space const& space, PairState<Space, Real, periodic> const& state,
               LawType const& law)
  {
    Kokkos::parallel_for("ricochet::resolve_in_order", Kokkos::RangePolicy<Space>(space, 0, 1),
                         ResolveInOrder<Space, Real, LawType, periodic>{state, strays_, law});
  }

 private:
  Strays<Space> strays_;
};

} // namespace ricochet
