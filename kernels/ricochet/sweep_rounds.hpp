// The ordered loop in rounds, for devices on which one thread is slow.
//
// To each disc the order of the loop is that of its partners' ids. So a pair may respond as soon as
// it is the next of both its discs: in each round all pairs do of which that is true, and the
// result is that of the loop. (The order of deterministic reservations, Blelloch, Fineman, Gibbons
// and Shun 2012, doi 10.1145/2145816.2145840, without reserving anything.)
#pragma once

#include "ricochet/sweep_islands.hpp"

#include <algorithm>

namespace ricochet {

/// Pairs of discs, and each disc's partners in them in the order of their ids.
template <class Space>
struct PairLists {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int none = -1;

  /// What the host must know to go on.
  struct Counts {
    int pairs = 0;          ///< more than there is room for, if there is not enough
    int active[2] = {0, 0}; ///< in each list of those that have pairs to go
  };

  Kokkos::View<int* [2], Space> pairs; ///< slots; a pair may occur twice
  Ints partner;                        ///< begin(s) ... end(s) - 1 are those of disc s, each once
  Ints begin, end;
  Ints next;      ///< of each disc, entry of the partner whose turn it is
  Ints points_at; ///< that partner as of this round, or none
  Ints is_new;    ///< whether a disc is the root of an island with new pairs
  Ints active[2];
  Kokkos::View<Counts, Space> counts;

  PairLists() = default;
  explicit PairLists(int discs)
    : begin(uninitialised<Ints>("ricochet::partners_begin", discs + 1)),
      end(uninitialised<Ints>("ricochet::partners_end", discs)),
      next(uninitialised<Ints>("ricochet::next_partner", discs)),
      points_at(uninitialised<Ints>("ricochet::points_at", discs)),
      is_new(uninitialised<Ints>("ricochet::has_new_pairs", discs)),
      active{uninitialised<Ints>("ricochet::active", discs),
             uninitialised<Ints>("ricochet::still_active", discs)},
      counts("ricochet::pair_counts")
  {
  }

  /// Adds a pair, if there is room.
  KOKKOS_INLINE_FUNCTION void add(int a, int b) const
  {
    int const room = static_cast<int>(pairs.extent(0));
    if (counts().pairs > room)
      return; // or in a dense crowd the count would overflow
    int const at = fetch_add<Space>(counts().pairs, 1);
    if (at >= room)
      return;
    pairs(at, 0) = a;
    pairs(at, 1) = b;
  }

  /// Sorts the partners of a disc by id, each once.
  KOKKOS_INLINE_FUNCTION void tidy(int slot, Ints const& id) const
  {
    int size = 0;
    int* const own = partner.data() + begin(slot);
    for (int entry = 0; entry < begin(slot + 1) - begin(slot); ++entry) {
      int const k = own[entry];
      int at = size;
      while (at > 0 && id(own[at - 1]) > id(k))
        --at;
      if (at > 0 && own[at - 1] == k)
        continue;
      for (int above = size; above > at; --above)
        own[above] = own[above - 1];
      own[at] = k;
      ++size;
    }
    next(slot) = begin(slot);
    end(slot) = begin(slot) + size;
  }

  /// Whether a pair is not among those that have their turn.
  KOKKOS_INLINE_FUNCTION bool apart(int a, int b) const
  {
    for (int entry = begin(a); entry < end(a); ++entry)
      if (partner(entry) == b)
        return false;
    return a != b;
  }
};

/// A round's first half: each disc that has pairs to go points at its next partner.
template <class Space>
struct PointAtNext {
  PairLists<Space> lists;
  int from; ///< which list of active discs; the other is made

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    auto const& counts = lists.counts();
    if (k >= counts.active[from])
      return;
    int const slot = lists.active[from](k);
    bool const any = lists.next(slot) < lists.end(slot);
    lists.points_at(slot) = any ? lists.partner(lists.next(slot)) : PairLists<Space>::none;
    if (any)
      lists.active[1 - from](fetch_add<Space>(lists.counts().active[1 - from], 1)) = slot;
  }
};

/// A round's second half: discs that point at each other respond.
template <class Space, class Real, class LawType, bool periodic>
struct RespondMutually {
  OrderedContact<Space, Real, LawType, periodic> contact;
  PairLists<Space> lists;
  int from;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    if (k >= lists.counts().active[from])
      return;
    auto const& state = contact.state;
    auto const& participants = contact.participants;
    int const a = lists.active[from](k), b = lists.points_at(a);
    if (lists.points_at(b) != a || state.discs.id(b) < state.discs.id(a))
      return;
    ++lists.next(a);
    ++lists.next(b);
    int const second = participants.number(b);
    auto &i = participants(participants.number(a)), &j = participants(second);
    auto const d = state.domain.separation(i.position, j.position);
    if (dot(d, d) < state.diameter * state.diameter)
      participants.note_push(second, i.id, static_cast<double>(contact(i, j)));
  }
};

/// Rounds until no pair is left, by one team of threads: few pairs take many rounds.
template <class Space, class Real, class LawType, bool periodic>
struct FinishRounds {
  PointAtNext<Space> point;
  RespondMutually<Space, Real, LawType, periodic> respond;

  using Member = typename Kokkos::TeamPolicy<Space>::member_type;

  KOKKOS_INLINE_FUNCTION void operator()(Member const& team) const
  {
    auto const& lists = point.lists;
    auto at = point;
    auto then = respond;
    for (int from = 0; lists.counts().active[from] > 0; from = 1 - from) {
      at.from = from;
      then.from = 1 - from;
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, lists.counts().active[from]), at);
      team.team_barrier();
      Kokkos::parallel_for(Kokkos::TeamThreadRange(team, lists.counts().active[1 - from]), then);
      team.team_barrier();
      Kokkos::single(Kokkos::PerTeam(team), [&]() { lists.counts().active[from] = 0; });
      team.team_barrier();
    }
  }
};

/// Lists what was found to overlap at the start or in its turn.
template <class Space>
struct ListPairs {
  PairLists<Space> lists;
  Forest<Space> forest;

  template <class Real>
  KOKKOS_INLINE_FUNCTION bool apart(Participant<Real> const& j, int k) const
  {
    return lists.apart(j.slot, k);
  }
  KOKKOS_INLINE_FUNCTION void note(int j, int k) const
  {
    forest.unite(j, k);
    lists.add(j, k);
  }
};

/// Executes pair steps in rounds. Its memory is allocated when it is first used.
template <class Space, class Real>
class Rounds {
 public:
  /// Resolves all contacts. Returns how many numbers were given, or `not_done`, with nobody taking
  /// part, if that takes memory out of proportion; or many passes, unless `at_any_cost`.
  template <class LawType, bool periodic>
  int resolve(Space const& space, PairState<Space, Real, periodic> const& state, LawType const& law,
              Participants<Space, Real>& participants, bool at_any_cost);

 private:
  /// Rounds by all threads, an even number; then one team finishes. So many see to 99 % of the
  /// pairs of a gas.
  static constexpr int rounds_by_all = 8;
  /// A state with more pairs a disc than this is not for rounds.
  static constexpr int most_pairs = 16;
  /// Nor is one that takes more passes, or executes each disc more often.
  static constexpr int most_passes = 12, most_numbers = 4;

 public: // nvcc takes device lambdas only from public functions
  template <class Find>
  int find_pairs(Space const& space, int discs, int known, Find const& find);
  void forget_pairs(Space const& space, int but);
  void list_partners(Space const& space, typename PairLists<Space>::Ints const& id, int pairs);
  void call_up_islands(Space const& space, Participants<Space, Real> const& participants, int pass,
                       int first_pair, int pairs);
  template <class LawType, bool periodic>
  void execute(Space const& space, OrderedContact<Space, Real, LawType, periodic> const& contact,
               int begin, int end);

 private:
  PairLists<Space> lists_;
};

template <class Space, class Real>
template <class LawType, bool periodic>
int Rounds<Space, Real>::resolve(Space const& space, PairState<Space, Real, periodic> const& state,
                                 LawType const& law, Participants<Space, Real>& participants,
                                 bool at_any_cost)
{
  int const n = state.discs.count();
  if (lists_.begin.extent(0) == 0)
    lists_ = PairLists<Space>(n);
  participants.reset_counts(space);
  int begin = 0, end = 0; // of the numbers of a pass
  int known = 0;          // pairs that have had their turn
  int found = find_pairs(space, n, 0, [&] {
    find_overlapping("ricochet::list_overlapping", space, state,
                     ListPairs<Space>{lists_, participants.forest});
  });
  for (int pass = 1; found > known; ++pass) {
    call_up_islands(space, participants, pass, known, found);
    end = begin + participants.list_called(space, pass);
    if (!at_any_cost && (pass > most_passes || end / most_numbers > n))
      break;
    if (end > participants.room()) {
      participants.dissolve(space);
      participants.need_room(2 * end);
      return resolve(space, state, law, participants, at_any_cost);
    }
    list_partners(space, state.discs.id, found);
    participants.begin_listed(space, state, begin, end);
    execute(space, OrderedContact<Space, Real, LawType, periodic>{state, participants, law}, begin,
            end);
    int const far = value_after(space, participants.counts).far;
    known = found;
    found = find_pairs(space, n, known, [&] {
      verify(space, state, participants, ListPairs<Space>{lists_, participants.forest}, pass, begin,
             end, far);
    });
    begin = end;
  }
  if (found == known)
    return end;
  participants.dissolve(space);
  reset_all(space, participants.forest, n); // some were united and not called up
  return not_done;
}

/// Has pairs found beyond those known, in memory that is large enough. Returns how many there are
/// then, or -1 if that would be too large.
template <class Space, class Real>
template <class Find>
int Rounds<Space, Real>::find_pairs(Space const& space, int discs, int known, Find const& find)
{
  for (;;) {
    forget_pairs(space, known);
    find();
    int const found = value_after(space, lists_.counts).pairs,
              room = static_cast<int>(lists_.pairs.extent(0));
    if (found <= room)
      return found;
    if (room >= most_pairs * static_cast<std::int64_t>(discs))
      return -1;
    auto const more = static_cast<std::size_t>(std::max(discs, 2 * room));
    Kokkos::resize(lists_.pairs, more);
    Kokkos::resize(lists_.partner, 2 * more); // whom they met is asked for in the next attempt
  }
}

/// Forgets all but the first pairs.
template <class Space, class Real>
void Rounds<Space, Real>::forget_pairs(Space const& space, int but)
{
  auto const lists = lists_;
  Kokkos::parallel_for(
      "ricochet::forget_pairs", Range<Space>(space, 0, 1),
      KOKKOS_LAMBDA(int) { lists.counts().pairs = but; });
}

/// Makes each disc's list of partners.
template <class Space, class Real>
void Rounds<Space, Real>::list_partners(Space const& space,
                                        typename PairLists<Space>::Ints const& id, int pairs)
{
  auto const lists = lists_;
  auto const n = static_cast<int>(lists.next.extent(0));
  Kokkos::deep_copy(space, lists.begin, 0);
  Kokkos::parallel_for(
      "ricochet::count_partners", Range<Space>(space, 0, pairs), KOKKOS_LAMBDA(int p) {
        fetch_add<Space>(lists.begin(lists.pairs(p, 0)), 1);
        fetch_add<Space>(lists.begin(lists.pairs(p, 1)), 1);
      });
  scan(
      "ricochet::scan_partners", space, n + 1, KOKKOS_LAMBDA(int slot, int& before, bool final) {
        int const here = lists.begin(slot);
        if (final) {
          lists.begin(slot) = before;
          if (slot < n)
            lists.next(slot) = before;
        }
        before += here;
      });
  Kokkos::parallel_for(
      "ricochet::fill_partners", Range<Space>(space, 0, pairs), KOKKOS_LAMBDA(int p) {
        int const a = lists.pairs(p, 0), b = lists.pairs(p, 1);
        lists.partner(fetch_add<Space>(lists.next(a), 1)) = b;
        lists.partner(fetch_add<Space>(lists.next(b), 1)) = a;
      });
  Kokkos::parallel_for(
      "ricochet::sort_partners", Range<Space>(space, 0, n),
      KOKKOS_LAMBDA(int slot) { lists.tidy(slot, id); });
}

/// Calls up the discs of the islands that the pairs from `first_pair` on belong to.
template <class Space, class Real>
void Rounds<Space, Real>::call_up_islands(Space const& space,
                                          Participants<Space, Real> const& participants, int pass,
                                          int first_pair, int pairs)
{
  auto const lists = lists_;
  auto const forest = participants.forest;
  auto const calls = participants.calls;
  auto const n = static_cast<int>(lists.next.extent(0));
  Kokkos::deep_copy(space, lists.is_new, 0);
  Kokkos::parallel_for(
      "ricochet::mark_islands", Range<Space>(space, first_pair, pairs),
      KOKKOS_LAMBDA(int p) { poke(lists.is_new(forest.root(lists.pairs(p, 0))), 1); });
  Kokkos::parallel_for(
      "ricochet::call_up_islands", Range<Space>(space, 0, n), KOKKOS_LAMBDA(int slot) {
        if (lists.is_new(forest.root(slot)) != 0)
          calls.call_up(slot, pass);
      });
}

/// Executes the discs with the numbers begin...end - 1.
template <class Space, class Real>
template <class LawType, bool periodic>
void Rounds<Space, Real>::execute(Space const& space,
                                  OrderedContact<Space, Real, LawType, periodic> const& contact,
                                  int begin, int end)
{
  auto const lists = lists_;
  auto const called = contact.participants.calls.list;
  int const members = end - begin;
  Kokkos::parallel_for(
      "ricochet::start_rounds", Range<Space>(space, 0, members), KOKKOS_LAMBDA(int k) {
        lists.active[0](k) = called(k);
        if (k == 0) {
          lists.counts().active[0] = members;
          lists.counts().active[1] = 0;
        }
      });
  PointAtNext<Space> point{lists, 0};
  RespondMutually<Space, Real, LawType, periodic> respond{contact, lists, 1};
  for (int round = 0; round < rounds_by_all; ++round) {
    int const from = round % 2;
    point.from = from;
    respond.from = 1 - from;
    Kokkos::parallel_for("ricochet::point_at_next", Range<Space>(space, 0, members), point);
    Kokkos::parallel_for("ricochet::respond_mutually", Range<Space>(space, 0, members), respond);
    Kokkos::parallel_for(
        "ricochet::end_round", Range<Space>(space, 0, 1),
        KOKKOS_LAMBDA(int) { lists.counts().active[from] = 0; });
  }
  Kokkos::parallel_for("ricochet::finish_rounds", Kokkos::TeamPolicy<Space>(space, 1, Kokkos::AUTO),
                       FinishRounds<Space, Real, LawType, periodic>{point, respond});
}

} // namespace ricochet
