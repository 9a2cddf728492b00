// The pair step of engine `sweep`: every overlapping pair responds, in lexicographic order of ids.
//
// The original tests all pairs (i, j), i < j, row by row, and changes the discs in place:
// velocities of both follow the contact law, and disc j is pushed out of the overlap along the
// normal. Row i moves only discs j > i, so disc i stands still during its row, and restricted to
// one disc the order is that of its partners' ids.
//
// Here the loop runs in parallel, with every bit of the result:
//  1. Discs that overlap are united to islands.
//  2. Each island is executed as the original would, alone, on copies of its discs.
//  3. What was pushed is compared with its surroundings, at the time of each pair's row. Islands
//     that met are united, and executed again, until none meets another. Then every pair has had
//     its turn: inside an island in order, and between islands none overlapped in its turn.
// Islands too large for one work item are a crowd, executed by one thread; where the crowd holds
// too many of the discs, one thread executes the loop as it is written. On a device, where one
// thread is slow, rounds of pairs take the place of both.
#pragma once

#include "ricochet/sweep_in_order.hpp"
#include "ricochet/sweep_islands.hpp"
#include "ricochet/sweep_rounds.hpp"

#include <algorithm>

namespace ricochet {

/// Pair step of engine `sweep`.
template <class Space, class Real>
class OrderedPairs {
 public:
  OrderedPairs(CellGrid<Space, Real> const& grid, double diameter, Execution execution, int discs)
    : execution_(execution),
      strays_(grid),
      participants_(discs, far_path(grid, diameter)),
      part_("ricochet::part_of_pair_books")
  {
  }

  template <class LawType, bool periodic>
  void resolve(Space const& space, PairState<Space, Real, periodic> const& state,
               LawType const& law);

  /// How the pair steps so far were executed.
  ExecutionCounts executions() const { return executions_; }

  /// For checkpoints.
  template <class Visit>
  void visit_numbers(Visit const& visit)
  {
    visit("executions.islands", executions_.islands);
    visit("executions.crowd", executions_.crowd);
    visit("executions.rounds", executions_.rounds);
    visit("executions.in_order", executions_.in_order);
    visit("pause", pause_);
    visit("steps_to_pause", steps_to_pause_);
  }

 private:
  /// Where a crowd is more than this part of the discs one thread is done sooner in order; and
  /// where islands take more passes than this. To execute a crowd costs about as much as to verify
  /// a tenth of the discs.
  static constexpr int largest_crowd_part = 4, most_passes = 12, crowd_part = 10;
  /// So it is where more than this share of the discs takes part, each counted in every pass that
  /// it is executed in or verified: more of many, which the loop in order does not find in a cache.
  static constexpr double worthwhile_of_few = 0.45, worthwhile_of_many = 0.7;
  static constexpr int few = 50000;
  /// The kernels of a further pass take a host as long to start as so many discs to execute.
  static constexpr int further_pass = shares_host_memory<Space> ? 150 : 0;
  /// After a step that was not worth it, islands are left alone for a while, twice as long each
  /// time.
  static constexpr int longest_pause = 32;

  bool by_islands() const
  {
    return execution_ != Execution::rounds && execution_ != Execution::in_order;
  }
  bool by_rounds() const
  {
    return execution_ == Execution::rounds ||
           (execution_ == Execution::automatic && !shares_host_memory<Space>);
  }

  /// A longer path is far: discs pushed so far look around again in each pass, while all that are
  /// executed again look as far. That is as far as the cells around reach, and few of a gas are.
  static double far_path(CellGrid<Space, Real> const& grid, double diameter)
  {
    return std::max(0.0, grid.cells().side() * (1 - 1e-4) - diameter);
  }

  /// Larger islands are for the crowd.
  int largest_island() const { return execution_ == Execution::crowd ? 1 : island_limit; }

  static bool is_too_much(int pass, int work, int discs)
  {
    double const share =
        shares_host_memory<Space> && discs <= few ? worthwhile_of_few : worthwhile_of_many;
    return pass > most_passes || work > share * discs;
  }
  int largest_crowd(int discs) const
  {
    return shares_host_memory<Space> ? discs / largest_crowd_part : 0;
  }

 public: // nvcc takes device lambdas only from public functions
  template <class LawType, bool periodic>
  int resolve_islands(Space const& space, PairState<Space, Real, periodic> const& state,
                      LawType const& law);
  template <class LawType, bool periodic>
  int resolve_in_order(Space const& space, PairState<Space, Real, periodic> const& state,
                       LawType const& law);
  template <class LawType, bool periodic>
  typename Participants<Space, Real>::Counts
  execute_islands(Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact,
                  int begin, int end);
  template <class LawType, bool periodic>
  void execute_crowd(Space const& space,
                     OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd,
                     int begin, int end);
  template <class LawType, bool periodic>
  void execute_in_order(Space const& space,
                        OrderedContact<Space, Real, LawType, periodic> const& contact, bool notes);

 private:
  Execution execution_;
  Strays<Space> strays_;
  Participants<Space, Real> participants_;
  Rounds<Space, Real> rounds_;
  BooksView<Space> part_;
  int pause_ = 0, steps_to_pause_ = 0;
  ExecutionCounts executions_;
};

template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::resolve(Space const& space,
                                        PairState<Space, Real, periodic> const& state,
                                        LawType const& law)
{
  int end = not_done; // of the numbers of those that took part
  if (steps_to_pause_ > 0) {
    --steps_to_pause_;
  } else if (by_islands()) {
    end = resolve_islands(space, state, law);
    pause_ = end != not_done ? 0 : std::min(std::max(2 * pause_, 1), longest_pause);
    steps_to_pause_ = pause_;
  }
  if (end == not_done && by_rounds()) {
    end = rounds_.resolve(space, state, law, participants_, execution_ == Execution::rounds);
    executions_.rounds += end != not_done ? 1 : 0;
  }
  if (end == not_done)
    end = resolve_in_order(space, state, law);
  using Finish = Conclude<Space, Real, LawType, periodic>;
  Kokkos::parallel_reduce("ricochet::conclude",
                          Range<Space>(space, 0, blocks_of(Finish::block, end)),
                          Finish{{state, participants_, law}, end}, Merge<Books, Space>(part_));
  enter<Space>(space, state.books, part_);
}

/// Resolves all contacts by islands. Returns how many numbers were given, or `not_done` where
/// islands do not pay; nobody takes part then.
template <class Space, class Real>
template <class LawType, bool periodic>
int OrderedPairs<Space, Real>::resolve_islands(Space const& space,
                                               PairState<Space, Real, periodic> const& state,
                                               LawType const& law)
{
  int const n = state.discs.count();
  participants_.reset_counts(space);
  find_overlapping("ricochet::unite_overlapping", space, state,
                   UniteOverlapping<Space>{participants_.forest, participants_.calls});
  int work = 0; // discs that are executed or verified, in each pass
  bool any_crowd = false;
  int begin = 0, end = 0; // of the numbers of a pass
  for (int pass = 1;; ++pass) {
    end = begin + participants_.list_called(space, pass);
    if (end == begin)
      break;
    work += end - begin + (pass > 1 ? further_pass : 0);
    if (execution_ == Execution::automatic && is_too_much(pass, work, n)) {
      participants_.dissolve(space);
      return not_done;
    }
    if (end > participants_.room()) {
      participants_.dissolve(space);
      participants_.need_room(end + end / 4);
      return resolve_islands(space, state, law);
    }
    OrderedContact<Space, Real, LawType, periodic> const contact{state, participants_, law};
    auto const& participants = contact.participants;
    participants.begin_listed(space, state, begin, end);
    auto counts = execute_islands(space, contact, begin, end);
    if (execution_ == Execution::automatic && counts.crowd > largest_crowd(n)) {
      participants.dissolve(space);
      return not_done;
    }
    if (counts.crowd > 0) {
      execute_crowd(space, contact, counts.crowd_island, begin, end);
      counts = value_after(space, participants.counts);
      any_crowd = true;
      work += n / crowd_part;
    }
    work += pass == 1 ? 0 : counts.far;
    verify(space, state, participants, UniteIslands<Space, Real>{participants, pass}, pass, begin,
           end, counts.far);
    begin = end;
  }
  ++(any_crowd ? executions_.crowd : executions_.islands);
  return end;
}

/// Puts those who begin a pass into their islands, and executes these, but for the crowd.
template <class Space, class Real>
template <class LawType, bool periodic>
typename Participants<Space, Real>::Counts OrderedPairs<Space, Real>::execute_islands(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int begin,
    int end)
{
  auto const participants = contact.participants;
  Kokkos::parallel_for(
      "ricochet::join_islands", Range<Space>(space, begin, end), KOKKOS_LAMBDA(int k) {
        participants.join(k, participants.number(participants.forest.root(participants(k).slot)));
      });
  Kokkos::parallel_for("ricochet::execute_islands", Range<Space>(space, begin, end),
                       ExecuteIsland<Space, Real, LawType, periodic>{contact, largest_island()});
  return value_after(space, participants.counts);
}

/// Makes the islands that are too large one, the crowd, and executes it.
template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::execute_crowd(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd,
    int begin, int end)
{
  ProfilingRegion const region("ricochet::execute_crowd");
  auto const participants = contact.participants;
  auto const spare = contact.state.spare;
  int const largest = largest_island();
  Kokkos::parallel_for(
      "ricochet::join_crowd", Range<Space>(space, begin, end), KOKKOS_LAMBDA(int root) {
        if (root == crowd || participants.island_size(root) <= largest)
          return;
        participants.forest.unite(participants(root).slot, participants(crowd).slot);
        participants.chains.for_each(root, [&](int k) { participants.join(k, crowd); });
      });
  using Resolve = ResolveInOrder<Space, Real, LawType, periodic>;
  Kokkos::deep_copy(space, spare.x, Resolve::nowhere);
  Kokkos::parallel_for(
      "ricochet::begin_crowd", Range<Space>(space, begin, end), KOKKOS_LAMBDA(int k) {
        int const slot = participants(k).slot;
        if (participants.island(slot) == crowd)
          spare.set_position(slot, participants(k).position);
      });
  execute_in_order(space, contact, true);
  Kokkos::parallel_for(
      "ricochet::forget_crowd", Range<Space>(space, 0, 1),
      KOKKOS_LAMBDA(int) { participants.forget_crowd(); });
}

/// Executes the loop as it is written. Returns how many numbers were given: one to each disc.
template <class Space, class Real>
template <class LawType, bool periodic>
int OrderedPairs<Space, Real>::resolve_in_order(Space const& space,
                                                PairState<Space, Real, periodic> const& state,
                                                LawType const& law)
{
  int const n = state.discs.count();
  participants_.need_room(n);
  OrderedContact<Space, Real, LawType, periodic> const contact{state, participants_, law};
  auto const participants = contact.participants;
  Kokkos::parallel_for(
      "ricochet::begin_all", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int slot) {
        participants.begin(state, slot, slot);
        state.spare.set_position(slot, state.discs.position(slot));
      });
  execute_in_order(space, contact, false);
  ++executions_.in_order;
  return n;
}

/// Executes the loop as it is written, for those whose places are in the spare memory.
template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::execute_in_order(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, bool notes)
{
  strays_.clear(space, contact.state.cell);
  auto const id = contact.state.discs.id;
  auto const slot_of_id = strays_.slot_of_id;
  Kokkos::parallel_for(
      "ricochet::find_ids", Range<Space>(space, 0, contact.state.discs.count()),
      KOKKOS_LAMBDA(int slot) { slot_of_id(id(slot)) = slot; });
  Kokkos::parallel_for("ricochet::resolve_in_order", Range<Space>(space, 0, 1),
                       ResolveInOrder<Space, Real, LawType, periodic>(contact, strays_, notes));
}

} // namespace ricochet
