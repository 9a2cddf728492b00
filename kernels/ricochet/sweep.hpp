// The pair step of engine `sweep`: every overlapping pair responds, in lexicographic order of ids.
//
// The original tests all pairs (i, j), i < j, row by row, and changes the discs in place:
// velocities of both follow the contact law, and disc j is pushed out of the overlap along the
// normal. Row i moves only discs j > i, so disc i stands still during its row, and restricted to
// one disc the order is that of its partners' ids.
//
// Here the loop runs in parallel, with every bit of the result:
//  1. Discs that overlap are united to islands.
//  2. Each island is executed as the original would, alone.
//  3. What was pushed is compared with its surroundings, at the time of each pair's row. Islands
//     that met are united, taken back and executed again, until none meets another. Then every pair
//     has had its turn: inside an island in order, and between islands none overlapped in its turn.
// Islands too large for one work item are a crowd, executed by one thread; where the crowd holds
// too many of the discs, one thread executes the loop as it is written. On a device, where one
// thread is slow, rounds of pairs take the place of both.
#pragma once

#include "ricochet/sweep_in_order.hpp"
#include "ricochet/sweep_islands.hpp"
#include "ricochet/sweep_rounds.hpp"

#include <algorithm>
#include <utility>

namespace ricochet {

/// Pair step of engine `sweep`.
template <class Space, class Real>
class OrderedPairs {
 public:
  OrderedPairs(CellGrid<Space, Real> const& grid, double diameter, Execution execution, int discs)
    : execution_(execution),
      strays_(grid),
      // So that most searches keep to the cells around.
      islands_(discs, (grid.cells().side() - diameter) / 2),
      tally_("ricochet::tally", discs),
      takes_part_("ricochet::takes_part", discs),
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
  /// Where a crowd is more than this part of the discs, or as many must be verified again, one
  /// thread is done sooner in order; and where it takes more passes than this. To execute a crowd
  /// costs about as much as to verify a tenth of the discs.
  static constexpr int worthwhile_part = 4, most_passes = 12, crowd_part = 10;
  /// After a step that was not worth it, islands are left alone for a while, twice as long each
  /// time.
  static constexpr int longest_pause = 32;
  static constexpr int too_much = std::numeric_limits<int>::max();

  static bool is_too_much(int pass, int again, int crowd, int discs)
  {
    return pass > most_passes || again > discs / worthwhile_part ||
           crowd > (shares_host_memory<Space> ? discs / worthwhile_part : 0);
  }

  bool by_islands() const
  {
    return execution_ != Execution::rounds && execution_ != Execution::in_order;
  }
  bool by_rounds() const
  {
    return execution_ == Execution::rounds ||
           (execution_ == Execution::automatic && !shares_host_memory<Space>);
  }

 public: // nvcc takes device lambdas only from public functions
  template <bool periodic>
  int find_islands(Space const& space, PairState<Space, Real, periodic> const& state);
  template <class LawType, bool periodic>
  int resolve_islands(Space const& space,
                      OrderedContact<Space, Real, LawType, periodic> const& contact);
  template <class LawType, bool periodic>
  bool resolve_rounds(Space const& space,
                      OrderedContact<Space, Real, LawType, periodic> const& contact);
  template <class LawType, bool periodic>
  void execute_islands(Space const& space,
                       OrderedContact<Space, Real, LawType, periodic> const& contact, int islands);
  template <class LawType, bool periodic>
  void execute_crowd(Space const& space,
                     OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd);
  template <bool periodic>
  int verify(Space const& space, PairState<Space, Real, periodic> const& state, int islands,
             int crowd, bool all);
  void take_back(Space const& space, int wrong);
  void take_all_back(Space const& space, int discs);
  template <class LawType, bool periodic>
  void resolve_in_order(Space const& space,
                        OrderedContact<Space, Real, LawType, periodic> const& contact,
                        bool everyone);

 private:
  Execution execution_;
  Strays<Space> strays_;
  Islands<Space> islands_;
  Kokkos::View<Tally*, Space> tally_;     ///< all zero between steps
  Kokkos::View<char*, Space> takes_part_; ///< and this too
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
  OrderedContact<Space, Real, LawType, periodic> const contact{state, tally_, takes_part_, law};
  Range<Space> const all(space, 0, state.discs.count());
  auto const islands = islands_;
  Kokkos::parallel_for(
      "ricochet::reset_counts", Range<Space>(space, 0, 1),
      KOKKOS_LAMBDA(int) { islands.reset_counts(); });
  bool done = false;
  if (steps_to_pause_ > 0) {
    --steps_to_pause_;
  } else if (by_islands()) {
    int const again = resolve_islands(space, contact);
    done = again != too_much;
    if (!done)
      take_all_back(space, state.discs.count());
    bool const paid =
        execution_ != Execution::automatic || again <= state.discs.count() / worthwhile_part;
    pause_ = paid ? 0 : std::min(std::max(2 * pause_, 1), longest_pause);
    steps_to_pause_ = pause_;
  }
  if (!done && by_rounds()) {
    done = resolve_rounds(space, contact);
    if (!done)
      take_all_back(space, state.discs.count());
  }
  if (!done)
    resolve_in_order(space, contact, true);
  Kokkos::parallel_reduce("ricochet::conclude", all,
                          Conclude<Space, Real, LawType, periodic>{contact, islands_},
                          Merge<Books, Space>(part_));
  enter<Space>(space, state.books, part_);
}

/// Resolves all contacts by islands. Returns how many discs had to be verified again, or
/// `too_much`, with the state half done, where islands do not pay.
template <class Space, class Real>
template <class LawType, bool periodic>
int OrderedPairs<Space, Real>::resolve_islands(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact)
{
  auto const& state = contact.state;
  int const n = state.discs.count();
  int islands = find_islands(space, state);
  int crowd = 0; // as it was last executed
  int again = 0;
  typename Islands<Space>::Counts found;
  for (int pass = 1; islands > 0 || found.crowd_wrong != 0; ++pass) {
    execute_islands(space, contact, islands);
    bool const crowd_was_wrong = found.crowd_wrong != 0;
    found = value_after(space, islands_.counts);
    if (execution_ == Execution::automatic && is_too_much(pass, again, found.crowd, n))
      return too_much;
    int crowd_to_verify = 0;
    if (crowd_was_wrong || found.crowd > crowd) {
      crowd_to_verify = crowd = found.crowd;
      execute_crowd(space, contact, crowd);
      again += n / crowd_part;
    }
    int const verified = verify(space, state, islands, crowd_to_verify, pass == 1);
    again += pass == 1 ? 0 : verified;
    found = value_after(space, islands_.counts);
    islands = found.wrong;
    take_back(space, islands);
  }
  ++(crowd > 0 ? executions_.crowd : executions_.islands);
  return again;
}

/// Unites discs that overlap, and lists the islands of more than one disc. Returns their number.
template <class Space, class Real>
template <bool periodic>
int OrderedPairs<Space, Real>::find_islands(Space const& space,
                                            PairState<Space, Real, periodic> const& state)
{
  auto const islands = islands_;
  int const n = state.discs.count();
  Kokkos::parallel_for("ricochet::unite_overlapping", Range<Space>(space, 0, n),
                       FindOverlapping<Space, Real, periodic, UnitePairs<Space>>{
                           state, state.neighbours(), {islands.forest}});
  Kokkos::parallel_for(
      "ricochet::join_islands", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int slot) {
        int const node = Islands<Space>::node(slot), root = islands.forest.root(node);
        if (root != node)
          islands.join(root, slot);
      });
  return value_after(space, islands.counts).found;
}

/// Executes the islands of the list.
template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::execute_islands(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int islands)
{
  int const largest = execution_ == Execution::crowd ? 1 : island_limit;
  Kokkos::parallel_for("ricochet::execute_islands", Range<Space>(space, 0, islands),
                       ExecuteIsland<Space, Real, LawType, periodic>{contact, islands_, largest});
}

/// Executes the crowd, from the start.
template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::execute_crowd(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd)
{
  auto const islands = islands_;
  TakeBack<Space> const take_back{tally_, islands.pushes};
  Kokkos::parallel_for(
      "ricochet::start_crowd", Range<Space>(space, 0, crowd), KOKKOS_LAMBDA(int k) {
        take_back(islands.crowd(k));
        contact.take(islands.crowd(k));
      });
  resolve_in_order(space, contact, false);
}

/// Verifies what was executed in this pass. Returns of how many discs that was.
template <class Space, class Real>
template <bool periodic>
int OrderedPairs<Space, Real>::verify(Space const& space,
                                      PairState<Space, Real, periodic> const& state, int islands,
                                      int crowd, bool all)
{
  Verify<Space, Real, periodic, UniteIslands<Space>> const verify{
      state, state.neighbours(), islands_.pushes, {islands_}, all};
  auto const all_islands = islands_;
  int const far = all ? 0 : value_after(space, islands_.pushes.far_count);
  int in_islands = 0;
  Kokkos::parallel_for(
      "ricochet::forget_wrong_islands", Range<Space>(space, 0, 1),
      KOKKOS_LAMBDA(int) { all_islands.forget_wrong(); });
  Kokkos::parallel_reduce(
      "ricochet::verify_islands", Range<Space>(space, 0, islands),
      KOKKOS_LAMBDA(int k, int& verified) {
        int const root = all_islands.list(k);
        if (all_islands.of_disc(root - 1) != root)
          return; // it was executed as part of another
        all_islands.for_members(root, [&](int slot) {
          verify(slot);
          ++verified;
        });
      },
      in_islands);
  Kokkos::parallel_for(
      "ricochet::verify_crowd", Range<Space>(space, 0, crowd),
      VerifyListed<Space, Real, periodic, UniteIslands<Space>>{verify, islands_.crowd});
  Kokkos::parallel_for("ricochet::verify_far", Range<Space>(space, 0, far),
                       VerifyFar<Space, Real, periodic, UniteIslands<Space>>{verify});
  return in_islands + crowd + far;
}

/// Takes back what was done to the islands that were found wrong, and makes them the list.
template <class Space, class Real>
void OrderedPairs<Space, Real>::take_back(Space const& space, int wrong)
{
  if (wrong == 0)
    return;
  std::swap(islands_.list, islands_.wrong);
  auto const islands = islands_;
  TakeBack<Space> const take_back{tally_, islands.pushes};
  Kokkos::parallel_for(
      "ricochet::take_back_islands", Range<Space>(space, 0, wrong), KOKKOS_LAMBDA(int k) {
        int const node = islands.list(k), root = islands.forest.root(node);
        islands.for_members(node, [&](int slot) {
          take_back(slot);
          islands.of_disc(slot) = root;
        });
      });
  Kokkos::parallel_for(
      "ricochet::merge_islands", Range<Space>(space, 0, wrong), KOKKOS_LAMBDA(int k) {
        int const node = islands.list(k), root = islands.forest.root(node);
        if (root != node)
          islands.for_members(node, [&](int slot) { islands.add_member(root, slot); });
      });
}

/// Takes back everything that was done in this step.
template <class Space, class Real>
void OrderedPairs<Space, Real>::take_all_back(Space const& space, int discs)
{
  Kokkos::parallel_for("ricochet::take_all_back", Range<Space>(space, 0, discs),
                       TakeBack<Space>{tally_, islands_.pushes});
}

/// Resolves all contacts in rounds. Returns false, with the state half done, where that does not
/// pay.
template <class Space, class Real>
template <class LawType, bool periodic>
bool OrderedPairs<Space, Real>::resolve_rounds(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact)
{
  bool const any_number = execution_ == Execution::rounds;
  bool const done = rounds_.resolve(space, contact, islands_,
                                    any_number ? std::numeric_limits<int>::max() : most_passes);
  executions_.rounds += done ? 1 : 0;
  return done;
}

/// Executes the loop as it is written, for everyone or for the crowd.
template <class Space, class Real>
template <class LawType, bool periodic>
void OrderedPairs<Space, Real>::resolve_in_order(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact,
    bool everyone)
{
  if (everyone) {
    ++executions_.in_order;
    Kokkos::parallel_for(
        "ricochet::start_everyone", Range<Space>(space, 0, contact.state.discs.count()),
        KOKKOS_LAMBDA(int slot) { contact.take(slot); });
  }
  strays_.clear(space);
  auto const id = contact.state.discs.id;
  auto const slot_of_id = strays_.slot_of_id;
  Kokkos::parallel_for(
      "ricochet::find_ids", Range<Space>(space, 0, contact.state.discs.count()),
      KOKKOS_LAMBDA(int slot) { slot_of_id(id(slot)) = slot; });
  Kokkos::parallel_for(
      "ricochet::resolve_in_order", Range<Space>(space, 0, 1),
      ResolveInOrder<Space, Real, LawType, periodic>(contact, strays_, islands_, everyone));
}

} // namespace ricochet
