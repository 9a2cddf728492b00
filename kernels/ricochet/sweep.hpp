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
// too many of the discs, one thread executes the loop as it is written.
#pragma once

#include "ricochet/sweep_in_order.hpp"
#include "ricochet/sweep_islands.hpp"

#include <algorithm>
#include <utility>

namespace ricochet {

/// Pair step of engine `sweep`.
template <class Space, class Real>
class OrderedPairs {
 public:
  OrderedPairs(CellGrid<Space, Real> const& grid, Execution execution, int discs)
    : execution_(execution),
      strays_(grid),
      islands_(discs),
      tally_("ricochet::tally", discs),
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
    visit("executions.in_order", executions_.in_order);
    visit("pause", pause_);
    visit("steps_to_pause", steps_to_pause_);
  }

 private:
  using Range = Kokkos::RangePolicy<Space>;
  using Counts = typename Islands<Space>::Counts;

  /// A crowd of more than this part of the discs is not worth its islands, nor is a state that
  /// needs more passes than this.
  static constexpr int crowded = 4, most_passes = 12;
  /// After a step that was not, steps are taken in order for a while, twice as long each time.
  static constexpr int longest_pause = 32;

 public: // nvcc takes device lambdas only from public functions
  template <bool periodic>
  int find_islands(Space const& space, PairState<Space, Real, periodic> const& state);
  template <class LawType, bool periodic>
  bool resolve_islands(Space const& space,
                       OrderedContact<Space, Real, LawType, periodic> const& contact);
  template <class LawType, bool periodic>
  float execute_islands(Space const& space,
                        OrderedContact<Space, Real, LawType, periodic> const& contact, int islands);
  template <class LawType, bool periodic>
  float execute_crowd(Space const& space,
                      OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd);
  template <bool periodic>
  Counts verify(Space const& space, PairState<Space, Real, periodic> const& state, int islands,
                int crowd, bool all, float longest);
  void take_back(Space const& space, int wrong);
  template <class LawType, bool periodic>
  void resolve_in_order(Space const& space,
                        OrderedContact<Space, Real, LawType, periodic> const& contact,
                        bool everyone);

 private:
  Counts counts(Space const& space) const
  {
    Counts counts;
    space.fence();
    Kokkos::deep_copy(counts, islands_.counts);
    return counts;
  }

  Execution execution_;
  Strays<Space> strays_;
  Islands<Space> islands_;
  Kokkos::View<Tally*, typename Space::memory_space> tally_; ///< all zero between steps
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
  OrderedContact<Space, Real, LawType, periodic> const contact{state, tally_, law};
  Range const all(space, 0, state.discs.count());
  if (execution_ == Execution::in_order || steps_to_pause_ > 0) {
    steps_to_pause_ = std::max(steps_to_pause_ - 1, 0);
    resolve_in_order(space, contact, true);
  } else if (resolve_islands(space, contact)) {
    pause_ = 0;
  } else {
    pause_ = std::min(std::max(2 * pause_, 1), longest_pause);
    steps_to_pause_ = pause_;
    Kokkos::deep_copy(space, islands_.is_wrong, 0);
    Kokkos::parallel_for("ricochet::take_back_all", all, TakeBack<Space>{tally_, islands_.pushes});
    resolve_in_order(space, contact, true);
  }
  Kokkos::parallel_reduce("ricochet::conclude", all, Conclude<Space, Real, periodic>{state, tally_},
                          Merge<Books, Space>(part_));
  enter<Space>(space, state.books, part_);
}

/// Resolves all contacts by islands. Returns false, with the state half done, where that does not
/// pay.
template <class Space, class Real>
template <class LawType, bool periodic>
bool OrderedPairs<Space, Real>::resolve_islands(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact)
{
  auto const& state = contact.state;
  bool const any_size = execution_ != Execution::automatic;
  int islands = find_islands(space, state);
  float longest = 0;
  int crowd = 0; // as it was last executed
  Counts found;
  for (int pass = 1; islands > 0 || found.crowd_wrong != 0; ++pass) {
    if (!any_size && pass > most_passes)
      return false;
    longest = std::max(longest, execute_islands(space, contact, islands));
    bool const again = found.crowd_wrong != 0;
    found = counts(space);
    if (!any_size && found.crowd > state.discs.count() / crowded)
      return false;
    int crowd_to_verify = 0;
    if (again || found.crowd > crowd) {
      crowd_to_verify = crowd = found.crowd;
      longest = std::max(longest, execute_crowd(space, contact, crowd));
    }
    found = verify(space, state, islands, crowd_to_verify, pass == 1, longest);
    islands = found.wrong;
    take_back(space, islands);
  }
  ++(crowd > 0 ? executions_.crowd : executions_.islands);
  return true;
}

/// Unites discs that overlap, and lists the islands of more than one disc. Returns their number.
template <class Space, class Real>
template <bool periodic>
int OrderedPairs<Space, Real>::find_islands(Space const& space,
                                            PairState<Space, Real, periodic> const& state)
{
  auto const islands = islands_;
  int const n = state.discs.count();
  Kokkos::parallel_for(
      "ricochet::reset_islands", Range(space, 0, n + 1),
      KOKKOS_LAMBDA(int node) { islands.reset(node); });
  Kokkos::parallel_for(
      "ricochet::unite_overlapping", Range(space, 0, n),
      UniteOverlapping<Space, Real, periodic>{state, state.neighbours(), islands.forest});
  Kokkos::parallel_for(
      "ricochet::join_islands", Range(space, 0, n), KOKKOS_LAMBDA(int slot) {
        int const node = Islands<Space>::node(slot), root = islands.forest.root(node);
        islands.of_disc(slot) = root;
        if (root != node)
          islands.members.append(root, slot);
      });
  int found = 0;
  Kokkos::parallel_scan(
      "ricochet::list_islands", Range(space, 1, n + 1),
      KOKKOS_LAMBDA(int node, int& before, bool final) {
        if (islands.members.first(node) == Chains<Space>::none)
          return;
        if (final)
          islands.list(before) = node;
        ++before;
      },
      found);
  return found;
}

/// Executes the islands of the list. Returns the longest path of a disc in them.
template <class Space, class Real>
template <class LawType, bool periodic>
float OrderedPairs<Space, Real>::execute_islands(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int islands)
{
  int const largest = execution_ == Execution::crowd ? 1 : island_limit;
  float longest = 0;
  Kokkos::parallel_reduce("ricochet::execute_islands", Range(space, 0, islands),
                          ExecuteIsland<Space, Real, LawType, periodic>{contact, islands_, largest},
                          Kokkos::Max<float>(longest));
  return longest;
}

/// Executes the crowd, from the start. Returns the longest path of a disc in it.
template <class Space, class Real>
template <class LawType, bool periodic>
float OrderedPairs<Space, Real>::execute_crowd(
    Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact, int crowd)
{
  auto const islands = islands_;
  TakeBack<Space> const take_back{tally_, islands.pushes};
  Kokkos::parallel_for(
      "ricochet::start_crowd", Range(space, 0, crowd), KOKKOS_LAMBDA(int k) {
        take_back(islands.crowd(k));
        contact.take(islands.crowd(k));
      });
  resolve_in_order(space, contact, false);
  float longest = 0;
  Kokkos::parallel_reduce(
      "ricochet::longest_path_in_crowd", Range(space, 0, crowd),
      KOKKOS_LAMBDA(int k, float& most) {
        float const path = islands.pushes(islands.crowd(k)).path;
        most = most < path ? path : most;
      },
      Kokkos::Max<float>(longest));
  return longest;
}

/// Verifies what was executed in this pass. Returns what was found.
template <class Space, class Real>
template <bool periodic>
typename OrderedPairs<Space, Real>::Counts
OrderedPairs<Space, Real>::verify(Space const& space, PairState<Space, Real, periodic> const& state,
                                  int islands, int crowd, bool all, float longest)
{
  Verify<Space, Real, periodic> const verify{state, state.neighbours(), islands_, all,
                                             static_cast<double>(longest)};
  auto const all_islands = islands_;
  Kokkos::parallel_for(
      "ricochet::forget_wrong_islands", Range(space, 0, 1),
      KOKKOS_LAMBDA(int) { all_islands.forget_wrong(); });
  Kokkos::parallel_for(
      "ricochet::verify_islands", Range(space, 0, islands), KOKKOS_LAMBDA(int k) {
        int const root = all_islands.list(k);
        if (all_islands.of_disc(root - 1) == root) // or it was executed as part of another
          all_islands.for_members(root, [&](int slot) { verify.disc(slot); });
      });
  Kokkos::parallel_for(
      "ricochet::verify_crowd", Range(space, 0, crowd),
      KOKKOS_LAMBDA(int k) { verify.disc(all_islands.crowd(k)); });
  return counts(space);
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
      "ricochet::take_back_islands", Range(space, 0, wrong), KOKKOS_LAMBDA(int k) {
        int const node = islands.list(k), root = islands.forest.root(node);
        islands.for_members(node, [&](int slot) {
          take_back(slot);
          islands.of_disc(slot) = root;
        });
      });
  Kokkos::parallel_for(
      "ricochet::merge_islands", Range(space, 0, wrong), KOKKOS_LAMBDA(int k) {
        int const node = islands.list(k), root = islands.forest.root(node);
        if (root != node)
          islands.for_members(node, [&](int slot) { islands.add_member(root, slot); });
      });
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
        "ricochet::start_everyone", Range(space, 0, contact.state.discs.count()),
        KOKKOS_LAMBDA(int slot) { contact.take(slot); });
  }
  strays_.clear(space);
  Kokkos::parallel_for(
      "ricochet::resolve_in_order", Range(space, 0, 1),
      ResolveInOrder<Space, Real, LawType, periodic>(contact, strays_, islands_, everyone));
}

} // namespace ricochet
