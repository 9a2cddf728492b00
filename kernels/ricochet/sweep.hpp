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

/// The discs of each cell as doubly linked lists, which follow discs that are pushed about.
template <class Space>
struct CellLists {
  using Ints = Kokkos::View<int*, typename Space::memory_space>;

  Ints first;          ///< first disc of each cell, or none, by slot
  Ints next, previous; ///< in the list of its cell, or none, by slot
  Ints cell;           ///< cell of each disc, by slot
  static constexpr int none = -1;

  CellLists(int cells, int discs)
    : first(uninitialised<Ints>("ricochet::first_in_cell", cells)),
      next(uninitialised<Ints>("ricochet::next_in_cell", discs)),
      previous(uninitialised<Ints>("ricochet::previous_in_cell", discs)),
      cell(uninitialised<Ints>("ricochet::listed_cell", discs))
  {
  }

  /// Lists the discs of cell `c` as they are stored.
  KOKKOS_INLINE_FUNCTION void fill(Cells<Space> const& cells, int c) const
  {
    int const begin = cells.start(c), end = cells.start(c + 1);
    first(c) = begin < end ? begin : none;
    for (int slot = begin; slot < end; ++slot) {
      previous(slot) = slot > begin ? slot - 1 : none;
      next(slot) = slot + 1 < end ? slot + 1 : none;
      cell(slot) = c;
    }
  }

  /// Notes that disc `slot` is now in cell `c`.
  KOKKOS_INLINE_FUNCTION void move(int slot, int c) const
  {
    if (cell(slot) == c)
      return;
    if (previous(slot) != none)
      next(previous(slot)) = next(slot);
    else
      first(cell(slot)) = next(slot);
    if (next(slot) != none)
      previous(next(slot)) = previous(slot);

    if (first(c) != none)
      previous(first(c)) = slot;
    next(slot) = first(c);
    previous(slot) = none;
    first(c) = slot;
    cell(slot) = c;
  }
};

/// All rows in order, by one thread.
template <class Space, class Real, class LawType, bool periodic>
struct ResolveInOrder {
  PairState<Space, Real, periodic> state; ///< rows still to come are marked in its contacts
  CellLists<Space> lists;
  LawType law;

  KOKKOS_INLINE_FUNCTION void operator()(int) const
  {
    Books books;
    int const n = state.discs.count();
    int flagged = 0;
    for (int id = 0; id < n; ++id)
      flagged += has_higher_partner(id) ? 1 : 0;
    // Where most rows have partners anyway, looking at all of them is cheaper than finding out
    // after each push which are to be looked at.
    bool const every_row = flagged > n / 4;
    for (int id = 0; id < n; ++id)
      if (every_row || has_higher_partner(id))
        resolve_row(id, !every_row, books);
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
      if (at == capacity)
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

  KOKKOS_INLINE_FUNCTION bool has_higher_partner(int id) const
  {
    return (state.contacts(id) & contact::with_higher_id) != 0;
  }

  KOKKOS_INLINE_FUNCTION void resolve_row(int id, bool mark, Books& books) const
  {
    int const i = state.slot_of_id(id);
    int done = id;
    for (bool more = true; more;) {
      Batch batch;
      for_overlapping(i, done, [&](int k_id, int k) { batch.insert(k_id, k); });
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
    lists.move(j, state.cells.at(state.discs.position(j)));

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
    for_overlapping(j, row, [&](int k_id, int) {
      state.contacts(k_id < id ? k_id : id) |= contact::with_higher_id;
    });
  }

  /// Calls visit(id, slot) for every other disc with an id above `above` that overlaps disc `i`
  /// now.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_overlapping(int i, int above, Visit const& visit) const
  {
    // Plain local variables: what is written to the discs in between cannot change them.
    auto const domain = state.domain;
    Real const reach = state.diameter * state.diameter;
    Real const* const x = state.discs.x.data();
    Real const* const y = state.discs.y.data();
    int const* const id = state.discs.id.data();
    int const* const first_in = lists.first.data();
    int const* const next = lists.next.data();
    auto const p = state.discs.position(i);
    state.neighbours.for_blocks_near(p, [&](int first, int last) {
      for (int c = first; c <= last; ++c)
        for (int k = first_in[c]; k != CellLists<Space>::none; k = next[k]) {
          if (id[k] <= above || k == i)
            continue;
          auto const d = domain.separation(p, {x[k], y[k]});
          if (dot(d, d) < reach)
            visit(id[k], k);
        }
    });
  }
};

/// Pair step of engine `sweep`.
template <class Space, class Real>
class OrderedPairs {
 public:
  OrderedPairs(Cells<Space> const& cells, int discs) : lists_(cells.count(), discs) {}

  template <class LawType, bool periodic>
  void resolve(Space const& space, PairState<Space, Real, periodic> const& state,
               LawType const& law)
  {
    auto const lists = lists_;
    auto const cells = state.cells;
    Kokkos::parallel_for(
        "ricochet::list_cells", Kokkos::RangePolicy<Space>(space, 0, cells.count()),
        KOKKOS_LAMBDA(int c) { lists.fill(cells, c); });
    Kokkos::parallel_for("ricochet::resolve_in_order", Kokkos::RangePolicy<Space>(space, 0, 1),
                         ResolveInOrder<Space, Real, LawType, periodic>{state, lists_, law});
  }

 private:
  CellLists<Space> lists_;
};

} // namespace ricochet
