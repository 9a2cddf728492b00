// Who takes part in what happens: discs are called up by marks, and then listed in order.
#pragma once

#include "ricochet/kokkos_compat.hpp"

namespace ricochet {

/// The discs that are called up for rounds 1, 2, ... of what happens to a state. Between states
/// nobody is called up.
///
/// A disc is called up by a mark, and those with marks are then listed in the order of slots, so
/// that threads keep to discs of their own and share no counter.
template <class Space>
struct CallUps {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int block = 16; ///< slots; a gas has fewer contacts at a time than blocks
  /// How many places of the list a work item looks ahead, to fetch what items to come will read:
  /// first what says where the rest of it is, and later that. The list is longer by as much; there
  /// it holds slots, whichever.
  static constexpr int far_ahead = 16, ahead = 8;

  Ints called;          ///< by slot: latest round it was called up for, or 0; for whole blocks
  Ints called_in_block; ///< latest round that any of a block was called up for
  Ints list; ///< those called up for a round, in order, and after them those of others if asked for

  /// For n discs, of whose lists as many as `listed` are kept at a time.
  CallUps(int n, int listed)
    : called("ricochet::called_for_round", blocks_of(block, n) * block),
      called_in_block("ricochet::called_in_block", blocks_of(block, n)),
      list("ricochet::called_up", listed + far_ahead)
  {
  }

  /// Returns whether the disc was not called up for this round before; several threads that call it
  /// up at the same time may all be told so.
  KOKKOS_INLINE_FUNCTION bool call_up(int slot, int round) const
  {
    if (peek(called(slot)) == round)
      return false;
    poke(called(slot), round);
    poke(called_in_block(slot / block), round);
    return true;
  }

  KOKKOS_INLINE_FUNCTION int blocks() const { return static_cast<int>(called_in_block.extent(0)); }

  /// Calls visit(slot) for those of a block of slots that were called up, and takes it back.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void dismiss_block(int b, Visit const& visit) const
  {
    if (called_in_block(b) == 0)
      return;
    called_in_block(b) = 0;
    for_each_in_block(b, block, static_cast<int>(called.extent(0)), [&](int slot) {
      if (called(slot) == 0)
        return;
      called(slot) = 0;
      visit(slot);
    });
  }

  /// The same for one disc.
  KOKKOS_INLINE_FUNCTION void dismiss(int slot) const
  {
    called(slot) = 0;
    poke(called_in_block(slot / block), 0); // others of the block do so, too
  }

  void keep_listed(int listed) { list = Ints("ricochet::called_up", listed + far_ahead); }
};

/// Writes a number to memory of the device.
struct WriteTo {
  int* number;
  KOKKOS_INLINE_FUNCTION void operator()(int value) const { *number = value; }
};

/// Lists the discs that are called up for a round, a block of slots at a time: the body of a scan.
template <class Space, class Note>
struct ListCalled {
  CallUps<Space> m;
  int round;
  int place; ///< in the list, of the first
  Note note; ///< is told how many they are, also if there is no room for all

  KOKKOS_INLINE_FUNCTION void operator()(int b, int& before, bool final) const
  {
    if (m.called_in_block(b) == round) {
      int const* const called = &m.called(b * m.block);
      unsigned marks = 0; // without a branch
#pragma omp simd reduction(| : marks)
      for (int k = 0; k < m.block; ++k)
        marks |= called[k] == round ? 1u << k : 0u;
      for (; marks != 0; marks &= marks - 1, ++before)
        if (final && place + before < static_cast<int>(m.list.extent(0)))
          m.list(place + before) = b * m.block + lowest_bit(marks);
    }
    if (final && b + 1 == m.blocks())
      note(before);
  }
};

/// Lists the discs that are called up for a round, from `place` on, and calls note(their number) on
/// the device, also if there was no room for all.
template <class Space, class Note>
void list_called(Space const& space, CallUps<Space> const& calls, int round, int place,
                 Note const& note)
{
  scan("ricochet::list_called", space, calls.blocks(),
       ListCalled<Space, Note>{calls, round, place, note});
}

/// Calls work(place), or work(place, result) for a reduction, for all places of a list whose length
/// the device knows, and the host perhaps does not: `items` work items take turns.
template <class Work, class... Result>
struct ForListed {
  Work work;
  int const* length;
  int items;

  KOKKOS_INLINE_FUNCTION void operator()(int item, Result&... result) const
  {
    for (int place = item, end = *length; place < end; place += items)
      work(place, result...);
  }
};

} // namespace ricochet
