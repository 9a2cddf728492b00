// The ordered loop as it is written, by one thread, at a cost about linear in the number of discs.
#pragma once

#include "ricochet/sweep_islands.hpp"

#include <cstdint>

namespace ricochet {

/// Which cell each disc is in now, and lists of the strays: discs that were pushed too far from the
/// cell they are stored in to be found there.
template <class Space>
struct Strays {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int not_astray = -2, none = -1;

  Ints cell;  ///< where each disc is, by slot; a stray is in the list of that cell
  Ints first; ///< in each cell's list, or none
  Ints next;  ///< after each slot in its list, none, or not_astray
  Ints slot_of_id;
  /// Whether there ever was one in each cell or around it.
  Kokkos::View<char*, Space> near;

  template <class Real>
  explicit Strays(CellGrid<Space, Real> const& grid)
    : cell(grid.more_scratch()),
      first(uninitialised<Ints>("ricochet::first_stray", grid.cells().count())),
      next(grid.scratch()),
      slot_of_id(uninitialised<Ints>("ricochet::slot_of_id", next.extent(0))),
      near("ricochet::strays_near_cell", grid.cells().count())
  {
  }

  /// Puts all discs into the cells they are stored in.
  void clear(Space const& space, Ints const& stored) const
  {
    Kokkos::deep_copy(space, cell, stored);
    Kokkos::deep_copy(space, first, none);
    Kokkos::deep_copy(space, near, char{0});
    Kokkos::deep_copy(space, next, not_astray);
  }

  KOKKOS_INLINE_FUNCTION bool is_astray(int slot) const { return next(slot) != not_astray; }

  /// Notes that disc `slot` is now in cell `now`, as a stray.
  template <bool periodic>
  KOKKOS_INLINE_FUNCTION void stray(int slot, int now, Cells<Space> const& cells) const
  {
    if (is_astray(slot)) {
      if (cell(slot) == now)
        return;
      remove(slot);
    }
    next(slot) = first(now);
    first(now) = slot;
    cell(slot) = now;
    cells.template for_cells_around<periodic>(now, [&](int c) { near(c) = 1; });
  }

 private:
  KOKKOS_INLINE_FUNCTION void remove(int slot) const
  {
    int* link = &first(cell(slot));
    while (*link != slot)
      link = &next(*link);
    *link = next(slot);
  }
};

/// All rows in order, of the discs that take part. A disc's row looks for its partners once: no
/// pair of the row moves the disc, or another of its partners, before that partner's turn. The
/// places of all who take part are kept in the spare memory too, where they are found; those of
/// others are `nowhere` there, which is not near anything.
template <class Space, class Real, class LawType, bool periodic>
class ResolveInOrder {
 public:
  static constexpr Real nowhere = std::numeric_limits<Real>::infinity(); ///< as x, with any y

  /// With `notes`, pushes are noted.
  ResolveInOrder(OrderedContact<Space, Real, LawType, periodic> const& contact,
                 Strays<Space> const& strays, bool notes)
    : contact_(contact),
      neighbours_(contact.state.neighbours_among(contact.state.spare)),
      strays_(strays),
      notes_(notes)
  {
    auto const& state = contact.state;
    double const reach = neighbours_.margin(static_cast<double>(state.diameter));
    slack_x_ = 1 - reach * state.cells.x.per_length;
    slack_y_ = 1 - reach * state.cells.y.per_length;
  }

  KOKKOS_INLINE_FUNCTION void operator()(int) const
  {
    int const n = contact_.state.discs.count();
    for (int id = 0; id < n; ++id) {
      int const slot = strays_.slot_of_id(id);
      if (contact_.state.spare.x(slot) != nowhere)
        resolve_row(id, slot);
    }
  }

 private:
  /// The partners of a row that come next: the lowest ids above those done so far, with their
  /// slots, in order. They are few, and how they are put in order depends on how many, not on which
  /// they are: what costs is mispredicted branches.
  class Batch {
   public:
    KOKKOS_INLINE_FUNCTION int size() const { return size_; }
    KOKKOS_INLINE_FUNCTION bool is_full() const { return size_ == capacity; }
    KOKKOS_INLINE_FUNCTION int id(int k) const { return static_cast<int>(entry_[k] >> 32); }
    KOKKOS_INLINE_FUNCTION int slot(int k) const { return static_cast<int>(entry_[k]); }

    KOKKOS_INLINE_FUNCTION void insert(int new_id, int new_slot)
    {
      auto higher = static_cast<std::uint64_t>(new_id) << 32 | static_cast<std::uint64_t>(new_slot);
      for (int k = 0; k < size_; ++k) {
        std::uint64_t const here = entry_[k];
        entry_[k] = here < higher ? here : higher;
        higher = here < higher ? higher : here;
      }
      if (size_ < capacity)
        entry_[size_++] = higher;
    }

   private:
    static constexpr int capacity = 16;
    std::uint64_t entry_[capacity]; ///< id, slot
    int size_ = 0;
  };

  KOKKOS_INLINE_FUNCTION void resolve_row(int id, int slot) const
  {
    int done = id;
    for (bool more = true; more;) {
      Batch batch;
      for_partners(slot, done, [&](int k) { batch.insert(contact_.state.discs.id(k), k); });
      if (batch.size() > 0) // or a row without partners would wait for its disc
        resolve(id, slot, batch);
      more = batch.is_full();
      done = more ? batch.id(batch.size() - 1) : done;
    }
  }

  /// The next contacts of a row. Only the velocity of its disc changes, which is kept at hand.
  KOKKOS_INLINE_FUNCTION void resolve(int id, int slot, Batch const& batch) const
  {
    auto const& participants = contact_.participants;
    auto& own = participants(participants.number(slot));
    auto i = own;
    for (int k = 0; k < batch.size(); ++k) {
      int const j = participants.number(batch.slot(k));
      Real const push = contact_(i, participants(j));
      if (notes_)
        participants.note_push(j, id, static_cast<double>(push));
      follow(batch.slot(k), participants(j).position);
    }
    own.velocity = i.velocity;
  }

  /// Calls visit(slot) for every disc with an id above `above` that overlaps disc `i` now.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_partners(int i, int above, Visit const& visit) const
  {
    auto const& state = contact_.state;
    auto const p = state.spare.position(i);
    Real const reach2 = state.diameter * state.diameter;
    int const cell = strays_.cell(i);
    neighbours_.for_each_around_above(cell, p, reach2, above, [&](int k, Vec2<Real>) {
      if (!strays_.is_astray(k))
        visit(k);
    });
    if (strays_.near(cell) == 0)
      return;
    state.cells.template for_cells_around<periodic>(cell, [&](int c) {
      for (int k = strays_.first(c); k != Strays<Space>::none; k = strays_.next(k)) {
        auto const d = state.domain.separation(p, state.spare.position(k));
        if (dot(d, d) < reach2 && state.discs.id(k) > above)
          visit(k);
      }
    });
  }

  /// Sees to it that disc `j`, which was pushed, will be found where it is.
  KOKKOS_INLINE_FUNCTION void follow(int j, Vec2<Real> p) const
  {
    contact_.state.spare.set_position(j, p);
    auto const& cells = contact_.state.cells;
    int const now = cells.at(p), stored = contact_.state.cell(j);
    bool const astray = strays_.is_astray(j);
    if (astray || (now != stored && is_too_far(p, stored)))
      strays_.template stray<periodic>(j, now, cells);
    else
      strays_.cell(j) = now;
  }

  /// Whether a disc at `p` is not found in the cell `stored`.
  KOKKOS_INLINE_FUNCTION bool is_too_far(Vec2<Real> p, int stored) const
  {
    auto const& cells = contact_.state.cells;
    return cells.x.cells_away(static_cast<double>(p.x), cells.column(stored)) > slack_x_ ||
           cells.y.cells_away(static_cast<double>(p.y), cells.row(stored)) > slack_y_;
  }

  OrderedContact<Space, Real, LawType, periodic> contact_;
  Neighbours<Space, Real, periodic> neighbours_; ///< where they are now
  Strays<Space> strays_;
  bool notes_;
  double slack_x_, slack_y_; ///< how far from its cell a disc is found there [cells]
};

} // namespace ricochet
