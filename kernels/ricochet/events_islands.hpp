// One window of the engine `events`: islands of discs that meet, evolved exactly, and the proof
// that no two islands touch. kernels/README.md gives the argument; events.hpp calls these kernels
// in order.
//
// Every disc is in one of two places: `flights` holds all discs as the window begins and is not
// written while it lasts; `trial` holds the members of islands as far as they have been evolved.
// Only the thread of an island writes its members' trials, so nothing depends on scheduling: lists
// may be filled in any order because every choice among their entries has one answer.
#pragma once

#include "ricochet/contacts.hpp"
#include "ricochet/events_flight.hpp"
#include "ricochet/islands.hpp"

namespace ricochet {

/// For discs that have had events, the slots of all discs that they can meet in the interval: the
/// first count(i) entries of row i. Lists are written when they are first needed.
template <class Space>
struct NeighbourLists {
  static constexpr int longest = 16; ///< discs with more neighbours have no list; they search
  static constexpr int unknown = -1; ///< number of neighbours before the first search

  Kokkos::View<int* [longest], Space> slot;
  Kokkos::View<int*, Space> count;

  explicit NeighbourLists(int n)
    : slot(uninitialised<decltype(slot)>("ricochet::neighbours", n)),
      count(uninitialised<decltype(count)>("ricochet::neighbour_count", n))
  {
  }
};

/// What has happened in an island.
struct IslandEvents {
  double lost_pairs = 0, lost_walls = 0, virial = 0;
  int collisions = 0, wall_hits = 0;

  KOKKOS_INLINE_FUNCTION int events() const { return collisions + wall_hits; }
};

/// A flight that ended inside the window, and the entry of the one before it.
template <class Real>
struct PastFlight {
  Flight<Real> flight;
  int before;
};

/// Where an island has more events than a window can have without lasting contact.
template <class Real>
struct Stuck {
  static constexpr int nowhere = std::numeric_limits<int>::max();
  int first = nowhere; ///< id
  int second = 0;      ///< id, or a wall as in `partner`
  Real x = 0, y = 0;   ///< of the first, in the lab
  Real time = 0;
};

/// How a pass over islands went.
template <class Real>
struct Outcome {
  int too_large = 0; ///< islands that were left alone because of their size
  Real leaves = std::numeric_limits<Real>::infinity(); ///< first time a disc leaves its lists
  Stuck<Real> stuck;                                   ///< of several, the one with the lowest id

  KOKKOS_INLINE_FUNCTION void merge(Outcome const& other)
  {
    too_large += other.too_large;
    leaves = other.leaves < leaves ? other.leaves : leaves;
    if (other.stuck.first < stuck.first)
      stuck = other.stuck;
  }
};

/// All memory of the windows, by slot unless it says otherwise.
template <class Space, class Real>
struct WindowMemory {
  template <class Value>
  using List = Kokkos::View<Value*, Space>;

  List<Flight<Real>> flights;         ///< as the window begins
  List<Prediction<Real>> predictions; ///< how those flights end; may be void, never too late
  List<Flight<Real>> trial;           ///< members of islands: as far as they are evolved
  List<Prediction<Real>> trial_predictions;
  List<int> past;             ///< members: latest entry of `log`, or -1
  List<PastFlight<Real>> log; ///< in any order
  Forest<Space> forest;       ///< its trees are the islands to be; nodes are slots
  Chains<Space> chains;       ///< by root: the members of its island
  List<int> marks;            ///< bits, see `mark`
  List<int> finished;         ///< by root: pass in which the island reached the end, or 0
  List<int> evolved;          ///< by root of a grown island: how many of its parts are islands
  List<IslandEvents> tallies; ///< by root
  List<int> members;          ///< all discs in islands, and some that turned out not to be

  struct Counts {
    int members = 0; ///< entries of that list
    int log = 0;     ///< entries of the log, or more if it is too short
    int joints = 0;  ///< pairs in this pass that join islands
  };
  Kokkos::View<Counts, Space> counts;

  explicit WindowMemory(int n)
    : flights("ricochet::flights", n),
      predictions("ricochet::predictions", n),
      trial("ricochet::trial_flights", n),
      trial_predictions("ricochet::trial_predictions", n),
      past(uninitialised<List<int>>("ricochet::past_flight", n)),
      log("ricochet::past_flights", n / 8 + 1024),
      forest(n),
      chains(n, n),
      marks(uninitialised<List<int>>("ricochet::island_marks", n)),
      finished(uninitialised<List<int>>("ricochet::island_finished", n)),
      evolved(uninitialised<List<int>>("ricochet::evolved_parts", n)),
      tallies("ricochet::island_tally", n),
      members(uninitialised<List<int>>("ricochet::island_members", n)),
      counts("ricochet::window_counts")
  {
  }
};

namespace mark {
constexpr int member = 1;    ///< of an island
constexpr int listed = 2;    ///< in `members`
constexpr int touched = 4;   ///< has met a disc of another island in this pass
constexpr int contested = 8; ///< is a neighbour of a disc in another island
} // namespace mark

/// What all kernels of a window work on.
template <class Space, class Real, bool periodic>
struct Window {
  WindowMemory<Space, Real> m;
  NeighbourLists<Space> lists;
  Discs<Space, Real> discs;                     ///< as the interval began
  Neighbours<Space, Real, periodic> neighbours; ///< then
  Real reach;                                   ///< within which discs can meet in the interval
  Arena<Real, periodic> arena;
  Real end; ///< of the window

  /// How the flight of disc i ends if it meets no other disc.
  KOKKOS_INLINE_FUNCTION Prediction<Real> alone(int i, Flight<Real> const& flight) const
  {
    auto const wall = arena.next_wall(flight);
    Real const leaves = arena.leaving(flight, discs.position(i));
    return leaves < wall.due ? Prediction<Real>{leaves, partner::leaves, 0} : wall;
  }

  /// Of two ways in which a flight can end, the second being to meet disc j at `time`, the one to
  /// come first; of simultaneous ones a disc before a wall, and of discs the lower id.
  KOKKOS_INLINE_FUNCTION void consider(Real time, int j, int flight, Prediction<Real>& first) const
  {
    if (time < first.due || (time == first.due && is_before(j, first.with)))
      first = {time, j, flight};
  }

  KOKKOS_INLINE_FUNCTION bool is_before(int j, int with) const
  {
    if (with < 0)
      return with == partner::wall_x || with == partner::wall_y;
    return discs.id(j) < discs.id(with);
  }

  /// How the flight `mine` of disc i ends, where flight_of(j) is that of disc j.
  template <class FlightOf>
  KOKKOS_INLINE_FUNCTION Prediction<Real> predict(int i, Flight<Real> const& mine,
                                                  FlightOf const& flight_of) const
  {
    auto first = alone(i, mine);
    bool const inner = arena.is_inner(discs.position(i));
    for_each_neighbour(i, [&](int j) {
      Flight<Real> const& other = flight_of(j);
      bool const met = mine.met == j && other.met == i;
      consider(arena.meeting(mine, other, inner, met, first.due), j, other.number, first);
    });
    return first;
  }

  /// Calls visit(j) for every disc that disc i can meet in the interval. One thread at a time may
  /// do so for a disc.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_neighbour(int i, Visit const& visit) const
  {
    if (lists.count(i) == lists.unknown)
      write_list(i);
    int const count = lists.count(i);
    if (count <= lists.longest)
      for (int k = 0; k < count; ++k)
        visit(lists.slot(i, k));
    else
      neighbours.for_each_within(discs.position(i), reach, [&](int j, Vec2<Real>) {
        if (j != i)
          visit(j);
      });
  }

  KOKKOS_FUNCTION void write_list(int i) const
  {
    int count = 0;
    auto const note = [&](int j) {
      if (j == i)
        return;
      if (count < lists.longest)
        lists.slot(i, count) = j;
      ++count;
    };
    auto const p = discs.position(i);
    Real const *const x = discs.x.data(), *const y = discs.y.data(), reach2 = reach * reach;
    arena.with_ends(p, [&](auto const& ends) {
      auto const domain = ends;
      auto const is_near = [=](int j) {
        auto const d = domain.separation(p, {x[j], y[j]});
        return dot(d, d) < reach2;
      };
      neighbours.template for_each_near_that<std::decay_t<decltype(ends)>::wraps>(
          p, static_cast<double>(reach), 0, is_near, note);
    });
    lists.count(i) = count;
  }

  /// When two discs touch, if not clearly later than `limit`.
  KOKKOS_INLINE_FUNCTION Real meeting(int i, Flight<Real> const& a, int j, Flight<Real> const& b,
                                      Real limit) const
  {
    return arena.meeting(a, b, false, a.met == j && b.met == i, limit);
  }

  /// Gives a disc marks, and makes sure that it is listed among the members.
  KOKKOS_INLINE_FUNCTION void enlist(int i, int marks) const
  {
    int const before = fetch_or<Space>(m.marks(i), marks | mark::member | mark::listed);
    if ((before & mark::listed) == 0)
      m.members(fetch_add<Space>(m.counts().members, 1)) = i;
  }

  /// Notes that discs i, a member of an island, and j, of another island or none, meet.
  KOKKOS_INLINE_FUNCTION void join(int i, int j) const
  {
    m.forest.unite(i, j);
    enlist(i, mark::touched);
    enlist(j, mark::touched);
    fetch_add<Space>(m.counts().joints, 1);
  }

  /// Puts a disc in the island of `root`.
  KOKKOS_INLINE_FUNCTION void enter_island(int i, int root) const
  {
    m.flights(i).island = root;
    m.trial(i).island = root;
    m.chains.append(root, i);
  }

  /// Takes a member back to the beginning of the window.
  KOKKOS_INLINE_FUNCTION void reset(int i) const
  {
    m.trial(i) = m.flights(i);
    m.trial_predictions(i) = m.predictions(i);
    m.past(i) = -1;
  }

  /// Takes a disc out of its island. Outside a window no disc is in one.
  KOKKOS_INLINE_FUNCTION void dissolve(int i) const
  {
    m.flights(i).island = partner::none;
    m.forest.reset(i);
    m.chains.reset(i);
    m.marks(i) = 0;
    m.finished(i) = 0;
    m.evolved(i) = 0;
  }

  KOKKOS_INLINE_FUNCTION bool is_contested(int i) const
  {
    return (*static_cast<int const volatile*>(&m.marks(i)) & mark::contested) != 0;
  }
  KOKKOS_INLINE_FUNCTION void contest(int i) const
  {
    if (!is_contested(i))
      fetch_or<Space>(m.marks(i), mark::contested);
  }

  /// Whether a member's flight in this window is another than without its island.
  KOKKOS_INLINE_FUNCTION bool changed(int i) const
  {
    return m.trial(i).number != m.flights(i).number;
  }
};

/// Begins an interval: every disc starts a flight and predicts how it ends. Each pair is looked at
/// once, by the disc that comes first; one prediction of a meeting is enough. Reports the least
/// distance of two discs, squared, among those that overlap or may meet.
template <class Space, class Real, bool periodic>
struct TakeOff {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Real& closest2) const
  {
    auto const p = w.discs.position(i), v = w.discs.velocity(i);
    Flight<Real> const flight{p, v, Real(0), 0, partner::none, partner::none};
    auto first = w.alone(i, flight);
    Real least = closest2;
    Real const reach2 = w.reach * w.reach;
    auto const consider = [&](int j) {
      auto const d = w.arena.domain.separation(p, w.discs.position(j));
      Real const distance2 = dot(d, d);
      least = distance2 < least ? distance2 : least;
      if (distance2 < reach2)
        w.consider(w.arena.time_to_touch(d, w.discs.velocity(j) - v, false, first.due), j, 0,
                   first);
    };
    w.arena.with_ends(p, [&](auto const& ends) {
      using Ends = std::decay_t<decltype(ends)>;
      MayMeet<Real, Ends, true> const may_meet(
          w.discs.x.data(), w.discs.y.data(), w.discs.vx.data(), w.discs.vy.data(), ends, p, v, 0,
          w.arena.diameter2, first.due, w.arena.images_x + w.arena.images_y > 0);
      w.neighbours.template for_each_near_that<Ends::wraps>(p, static_cast<double>(w.reach), i + 1,
                                                            may_meet, consider);
    });
    closest2 = least;
    w.lists.count(i) = w.lists.unknown;
    w.m.flights(i) = flight;
    w.m.predictions(i) = first;
    w.dissolve(i);
  }
};

/// Ends an interval: every disc is where its flight is at the end of the last window.
template <class Space, class Real, bool periodic>
struct Land {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int i) const
  {
    auto const& f = w.m.flights(i);
    w.discs.set_position(i, w.arena.domain.wrapped(w.arena.lab_position(f.at(w.end), w.end)));
    w.discs.set_velocity(i, w.arena.lab_velocity(f.velocity, w.end));
  }
};

/// Lists the discs whose predictions are due in the window, a block of discs at a time.
template <class Space, class Real, bool periodic>
struct ListDue {
  static constexpr int block = 64;
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    int const n = static_cast<int>(w.m.predictions.extent(0));
    int count = 0;
    for_each_in_block(b, block, n, [&](int i) { count += w.m.predictions(i).due < w.end ? 1 : 0; });
    if (count == 0)
      return;
    int entry = fetch_add<Space>(w.m.counts().members, count);
    for_each_in_block(b, block, n, [&](int i) {
      if (w.m.predictions(i).due < w.end) {
        w.m.members(entry++) = i;
        w.m.marks(i) = mark::listed;
      }
    });
  }
};

/// Renews those predictions that are void, and unites the discs that meet.
template <class Space, class Real, bool periodic>
struct FindMeetings {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k);
    auto& next = w.m.predictions(i);
    auto const& flights = w.m.flights;
    if (next.with >= 0 && flights(next.with).number != next.flight)
      next = w.predict(i, flights(i), [&](int j) -> Flight<Real> const& { return flights(j); });
    if (!(next.due < w.end))
      return;
    fetch_or<Space>(w.m.marks(i), mark::member);
    if (next.with >= 0) {
      w.m.forest.unite(i, next.with);
      w.enlist(next.with, 0);
    }
  }
};

/// Evolves an island from the beginning of the window to its end, event by event, in the order of
/// time; of simultaneous events the one of the lowest ids is first. An island that meets a disc
/// outside it, or is not for this kernel, is left unfinished.
template <class Space, class Real, bool periodic, class Law>
struct EvolveIslands {
  Window<Space, Real, periodic> w;
  Law law;
  WallRule<Real, true> wall_rule;
  int pass;
  int largest; ///< islands with more members are left alone

  KOKKOS_INLINE_FUNCTION void operator()(int k, Outcome<Real>& outcome) const
  {
    int const root = w.m.members(k);
    if (w.m.flights(root).island != root || w.m.finished(root) != 0)
      return;
    int size = 0;
    w.m.chains.for_each(root, [&](int) { ++size; });
    if (size > largest) {
      ++outcome.too_large;
      return;
    }
    IslandEvents& tally = w.m.tallies(root);
    for (;;) {
      int const i = earliest(root);
      Prediction<Real> const next = w.m.trial_predictions(i);
      if (!(next.due < w.end))
        break;
      if (next.with == partner::leaves) {
        outcome.leaves = next.due < outcome.leaves ? next.due : outcome.leaves;
        return;
      }
      if (is_void(root, next)) {
        predict(root, i);
        continue;
      }
      if (next.with >= 0 && w.m.flights(next.with).island != root) {
        w.join(i, next.with);
        return;
      }
      if (tally.events() >= 32 + 16 * size) {
        note_stuck(i, next, outcome);
        return;
      }
      if (next.with >= 0)
        collide(root, i, next.with, next.due, tally);
      else
        hit_wall(root, i, next, tally);
    }
    w.m.finished(root) = pass;
  }

 private:
  /// The present flight of a disc as its island sees it: those outside it fly freely.
  KOKKOS_INLINE_FUNCTION Flight<Real> const& flight(int root, int j) const
  {
    auto const& outside = w.m.flights(j);
    return outside.island == root ? w.m.trial(j) : outside;
  }

  KOKKOS_INLINE_FUNCTION bool is_void(int root, Prediction<Real> const& p) const
  {
    return p.with >= 0 && flight(root, p.with).number != p.flight;
  }

  KOKKOS_INLINE_FUNCTION void predict(int root, int i) const
  {
    bool contested = false;
    w.m.trial_predictions(i) = w.predict(i, w.m.trial(i), [&](int j) -> Flight<Real> const& {
      auto const& outside = w.m.flights(j);
      if (outside.island == root)
        return w.m.trial(j);
      if (outside.island >= 0) {
        contested = true;
        w.contest(j);
      }
      return outside;
    });
    if (contested)
      w.contest(i);
  }

  /// The member whose flight ends first.
  KOKKOS_INLINE_FUNCTION int earliest(int root) const
  {
    int first = w.m.chains.first(root);
    w.m.chains.for_each(root, [&](int i) {
      if (is_before(i, first))
        first = i;
    });
    return first;
  }

  /// Order of events: by time; then pairs before walls, the lower id first, and the other one's.
  KOKKOS_INLINE_FUNCTION bool is_before(int a, int b) const
  {
    auto const &p = w.m.trial_predictions(a), &q = w.m.trial_predictions(b);
    if (p.due != q.due)
      return p.due < q.due;
    if ((p.with >= 0) != (q.with >= 0))
      return p.with >= 0;
    int const a1 = w.discs.id(a), b1 = w.discs.id(b);
    if (p.with < 0)
      return a1 < b1;
    int const a2 = w.discs.id(p.with), b2 = w.discs.id(q.with);
    int const a_low = a1 < a2 ? a1 : a2, b_low = b1 < b2 ? b1 : b2;
    return a_low != b_low ? a_low < b_low : a1 + a2 < b1 + b2;
  }

  KOKKOS_INLINE_FUNCTION void collide(int root, int i, int j, Real time, IslandEvents& tally) const
  {
    auto const &a = w.m.trial(i), &b = w.m.trial(j);
    auto const p = a.at(time), q = b.at(time);
    auto const d = w.arena.domain.separation(p, q);
    PairVelocity<Real> const before{w.arena.lab_velocity(a.velocity, time),
                                    w.arena.lab_velocity(b.velocity, time)};
    auto const after = law(contact_normal(d, static_cast<Real>(sqrt(dot(d, d)))), before);
    ++tally.collisions;
    tally.lost_pairs += (kinetic_energy(before.first) + kinetic_energy(before.second)) -
                        (kinetic_energy(after.first) + kinetic_energy(after.second));
    tally.virial += virial_of(before, after, d);
    begin_flight(i, p, after.first, time, j);
    begin_flight(j, q, after.second, time, i);
    predict(root, i);
    predict(root, j);
  }

  KOKKOS_INLINE_FUNCTION void hit_wall(int root, int i, Prediction<Real> const& next,
                                       IslandEvents& tally) const
  {
    Real const time = next.due;
    auto p = w.m.trial(i).at(time);
    auto const before = w.arena.lab_velocity(w.m.trial(i).velocity, time);
    Vec2<Real> after;
    if (next.with == partner::wall_x) {
      after = {wall_rule.normal(before.x), wall_rule.tangential(before.y)};
      p.x = before.x < 0 ? -w.arena.wall_x : w.arena.wall_x;
    } else {
      after = {wall_rule.tangential(before.x), wall_rule.normal(before.y)};
      bool const floor = before.y < 0 || (before.y == 0 && w.arena.gravity > 0);
      p.y = (floor ? -w.arena.wall_y : w.arena.wall_y) + w.arena.gravity * time * time / 2;
    }
    ++tally.wall_hits;
    tally.lost_walls += kinetic_energy(before) - kinetic_energy(after);
    begin_flight(i, p, after, time, partner::none);
    predict(root, i);
  }

  /// A disc flies on with another velocity, given in the lab. Of its flights, the first is kept in
  /// `flights` and the present one in `trial`; those between go to the log.
  KOKKOS_INLINE_FUNCTION void begin_flight(int i, Vec2<Real> position, Vec2<Real> velocity,
                                           Real time, int met) const
  {
    auto& f = w.m.trial(i);
    if (w.changed(i)) {
      int const entry = fetch_add<Space>(w.m.counts().log, 1);
      if (entry < static_cast<int>(w.m.log.extent(0))) {
        w.m.log(entry) = {f, w.m.past(i)};
        w.m.past(i) = entry;
      }
    }
    f = {position, {velocity.x, velocity.y + w.arena.gravity * time}, time, f.number + 1, met,
         f.island};
  }

  KOKKOS_INLINE_FUNCTION void note_stuck(int i, Prediction<Real> const& next,
                                         Outcome<Real>& outcome) const
  {
    auto const p = w.arena.lab_position(w.m.trial(i).at(next.due), next.due);
    Outcome<Real> here;
    here.stuck = {w.discs.id(i), next.with >= 0 ? w.discs.id(next.with) : next.with, p.x, p.y,
                  next.due};
    outcome.merge(here);
  }
};

/// Compares the paths that discs have really taken with those of neighbours in other islands; where
/// two meet, their islands are one.
template <class Space, class Real, bool periodic>
struct VerifyIslands {
  Window<Space, Real, periodic> w;
  int pass;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k), island = w.m.flights(i).island;
    if (island < 0 || w.m.finished(island) != pass || !w.is_contested(i) || !w.changed(i))
      return;
    w.for_each_neighbour(i, [&](int j) {
      int const other = w.m.flights(j).island;
      if (other >= 0 && other != island && w.m.finished(other) > 0 && w.changed(j) && meet(i, j))
        w.join(i, j);
    });
  }

 private:
  /// Calls use(flight, until) for every flight of a disc in this window, the last first, while use
  /// returns true; returns whether it always did.
  template <class Use>
  KOKKOS_INLINE_FUNCTION bool for_each_flight(int i, Use const& use) const
  {
    Real until = w.end;
    if (!use(w.m.trial(i), until))
      return false;
    until = w.m.trial(i).since;
    for (int entry = w.m.past(i); entry >= 0; entry = w.m.log(entry).before) {
      if (!use(w.m.log(entry).flight, until))
        return false;
      until = w.m.log(entry).flight.since;
    }
    return use(w.m.flights(i), until);
  }

  KOKKOS_INLINE_FUNCTION bool meet(int i, int j) const
  {
    return !for_each_flight(i, [&](Flight<Real> const& a, Real a_until) {
      return for_each_flight(j, [&](Flight<Real> const& b, Real b_until) {
        Real const from = a.since > b.since ? a.since : b.since;
        Real const until = a_until < b_until ? a_until : b_until;
        return !(from < until && w.meeting(i, a, j, b, until) < until);
      });
    });
  }
};

/// Prepares the roots of islands that have grown.
template <class Space, class Real, bool periodic>
struct MarkGrownIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k);
    if ((w.m.marks(i) & mark::touched) == 0)
      return;
    int const root = w.m.forest.root(i);
    exchange<Space>(w.m.finished(root), 0);
    exchange<Space>(w.m.chains.first(root), Chains<Space>::none);
    exchange<Space>(w.m.evolved(root), 0);
  }
};

/// Counts the islands in each grown island. The other parts are single discs.
template <class Space, class Real, bool periodic>
struct CountEvolvedParts {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k);
    w.m.marks(i) &= ~mark::touched;
    if (w.m.flights(i).island != i)
      return;
    int const root = w.m.forest.root(i);
    if (w.m.finished(root) == 0 && fetch_add<Space>(w.m.evolved(root), 1) == 0 && root != i)
      w.m.tallies(root) = w.m.tallies(i);
  }
};

/// Puts every member into its island, if that is new or has grown. An island that has met single
/// discs only goes on where it was; where islands have met each other, all begin again.
template <class Space, class Real, bool periodic>
struct FormIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k);
    if ((w.m.marks(i) & mark::member) == 0)
      return;
    int const root = w.m.forest.root(i);
    if (w.m.finished(root) != 0)
      return;
    bool const goes_on = w.m.evolved(root) == 1;
    if (!goes_on || w.m.flights(i).island < 0)
      w.reset(i);
    w.enter_island(i, root);
    if (i == root && !goes_on)
      w.m.tallies(i) = {};
  }
};

/// At the fixpoint: predicts the meetings of discs that have both changed, each in its own island,
/// which neither island knew of.
template <class Space, class Real, bool periodic>
struct PredictBetweenIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const
  {
    int const i = w.m.members(k), island = w.m.flights(i).island;
    if (island < 0 || !w.is_contested(i) || !w.changed(i))
      return;
    auto first = w.m.trial_predictions(i);
    w.for_each_neighbour(i, [&](int j) {
      int const other = w.m.flights(j).island;
      if (other >= 0 && other != island && w.changed(j))
        w.consider(w.meeting(i, w.m.trial(i), j, w.m.trial(j), first.due), j, w.m.trial(j).number,
                   first);
    });
    w.m.trial_predictions(i) = first;
  }
};

/// Makes the trial the truth, enters the islands in the books and dissolves them.
template <class Space, class Real, bool periodic>
struct CommitIslands {
  Window<Space, Real, periodic> w;
  Scales scales;

  KOKKOS_INLINE_FUNCTION void operator()(int k, Books& books) const
  {
    int const i = w.m.members(k), island = w.m.flights(i).island;
    if (island >= 0) {
      w.m.flights(i) = w.m.trial(i);
      w.m.predictions(i) = w.m.trial_predictions(i);
    }
    if (island == i) {
      IslandEvents const& tally = w.m.tallies(i);
      books.lost_pairs.add(tally.lost_pairs, scales.energy);
      books.lost_walls.add(tally.lost_walls, scales.energy);
      books.virial.add(tally.virial, scales.virial);
      books.collisions += tally.collisions;
      books.wall_hits += tally.wall_hits;
    }
    w.dissolve(i);
  }
};

/// Dissolves all islands, and leaves no trace of them.
template <class Space, class Real, bool periodic>
struct DissolveIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int k) const { w.dissolve(w.m.members(k)); }
};

} // namespace ricochet
