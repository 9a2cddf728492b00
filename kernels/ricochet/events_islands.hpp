// One window of the engine `events`: islands of discs that meet, evolved exactly, and the proof
// that no two islands touch. kernels/README.md gives the argument; events.hpp calls these kernels
// in order.
//
// `discs` holds all lines as the window begins and is not written while it lasts; the members of
// islands, as far as these have been evolved, are numbered in the order of storage, and those of
// islands that are evolved again get new numbers. Only the thread of an island writes its members,
// so nothing depends on scheduling: lists may be filled in any order because every choice among
// their entries has one answer.
#pragma once

#include "ricochet/islands.hpp"
#include "ricochet/landing.hpp"

namespace ricochet {

/// What has happened in an island.
struct IslandEvents {
  double lost_pairs = 0, lost_walls = 0, virial = 0;
  int collisions = 0, wall_hits = 0;

  KOKKOS_INLINE_FUNCTION int events() const { return collisions + wall_hits; }
};

/// The free flight of a disc from a contact on, in the falling frame. Unlike a line, it says where
/// the contact was without rounding.
template <class Real>
struct Flight {
  Vec2<Real> place; ///< at `since`
  Vec2<Real> velocity;
  Real since;

  KOKKOS_INLINE_FUNCTION Vec2<Real> at(Real time) const
  {
    return place + (time - since) * velocity;
  }
  KOKKOS_INLINE_FUNCTION Line<Real> line() const { return {place - since * velocity, velocity}; }
};

/// A member of an island, as far as the island has been evolved. It fills a line of the cache.
template <class Real>
struct alignas(64) Member {
  Flight<Real> flight;
  Real due; ///< when its next event is, if nobody else interferes
  int with; ///< with whom: a member, or see `partner`
  int met;  ///< the member that it met last, or `partner::none`
  int past; ///< latest entry of the log, or none
  int pass; ///< in which this flight began; 0 if the window began with it
};

/// A flight between two contacts, and the entry of the one before it.
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
  int largest = 0;   ///< members of the largest island
  int unlogged = 0;  ///< entries that were missing in the log
  double speed2 = 0; ///< square of the largest speed that came of a contact
  Stuck<Real> stuck; ///< of several, the one with the lowest id

  KOKKOS_INLINE_FUNCTION void merge(Outcome const& other)
  {
    largest = other.largest > largest ? other.largest : largest;
    unlogged += other.unlogged;
    speed2 = other.speed2 > speed2 ? other.speed2 : speed2;
    if (other.stuck.first < stuck.first)
      stuck = other.stuck;
  }
};

/// Memory of the islands of a window. Between windows no disc is in one.
template <class Space, class Real>
struct IslandMemory {
  template <class Value>
  using List = Kokkos::View<Value*, Space>;

  // By slot:
  List<int> number;     ///< of a disc that is a member, or none; longer, as the arrays of discs are
  Forest<Space> forest; ///< its trees are the islands to be
  // By number of a member:
  List<Member<Real>> member;
  List<int> island;           ///< number of the root of its island
  Chains<Space> chains;       ///< by root: the members of its island
  List<IslandEvents> tallies; ///< by root
  List<int> heap; ///< of islands with many members, one after another in any order: numbers
  List<int> place_in_heap; ///< of a member of those

  List<PastFlight<Real>> log; ///< in any order
  Kokkos::View<int, Space> logged, heaped;

  IslandMemory() = default;
  IslandMemory(Space const& space, int n, int room)
    : number(uninitialised<List<int>>("ricochet::member_number", n + Discs<Space, Real>::padding)),
      forest(n),
      member("ricochet::members", room),
      island(uninitialised<List<int>>("ricochet::island", room)),
      chains(room),
      tallies("ricochet::island_tally", room),
      heap(uninitialised<List<int>>("ricochet::heap_of_events", room)),
      place_in_heap(uninitialised<List<int>>("ricochet::place_in_heap", room)),
      log("ricochet::past_flights", n / 16 + 1024),
      logged("ricochet::logged"),
      heaped("ricochet::heaped")
  {
    Kokkos::deep_copy(space, number, partner::none);
    reset_all(space, forest, n);
  }

  /// How many members there is room for.
  int room() const { return static_cast<int>(member.extent(0)); }
};

/// What all kernels of a window work on.
template <class Space, class Real, bool periodic>
struct Window : Lines<Space, Real, periodic> {
  IslandMemory<Space, Real> islands;

  Window(Lines<Space, Real, periodic> const& lines, IslandMemory<Space, Real> const& memory)
    : Lines<Space, Real, periodic>(lines), islands(memory)
  {
  }

  KOKKOS_INLINE_FUNCTION Member<Real>& member(int number) const { return islands.member(number); }
  KOKKOS_INLINE_FUNCTION int slot(int number) const { return this->m.list(number); }
  KOKKOS_INLINE_FUNCTION int id(int number) const { return this->discs.id(slot(number)); }

  /// Number of a disc that is a member of an island, or none.
  KOKKOS_INLINE_FUNCTION int number(int i) const { return islands.number(i); }

  /// Island of a disc, or none.
  KOKKOS_INLINE_FUNCTION int island_of(int i) const
  {
    return number(i) < 0 ? partner::none : islands.island(number(i));
  }

  /// The flight of a disc that the window began with.
  KOKKOS_INLINE_FUNCTION Flight<Real> first_flight(int i) const
  {
    return {this->discs.position(i), this->discs.velocity(i), Real(0)};
  }

  /// Whether a disc has had a contact in this window.
  KOKKOS_INLINE_FUNCTION bool is_deflected(int i) const
  {
    return number(i) >= 0 && member(number(i)).pass > 0;
  }

  /// Calls use(flight, to) for the flights of a disc that began with a contact, the last first,
  /// while it returns true; `to` is when they end. Returns whether it always did.
  template <class Use>
  KOKKOS_INLINE_FUNCTION bool for_each_new_flight(int i, Use const& use) const
  {
    if (!is_deflected(i))
      return true;
    auto const& own = member(number(i));
    if (!use(own.flight, this->arena.end))
      return false;
    Real to = own.flight.since;
    for (int entry = own.past; entry >= 0; entry = islands.log(entry).before) {
      auto const& past = islands.log(entry).flight;
      if (!use(past, to))
        return false;
      to = past.since;
    }
    return true;
  }

  /// When discs on these flights meet, if not clearly after the window.
  KOKKOS_INLINE_FUNCTION Real meeting_of(Flight<Real> const& a, Flight<Real> const& b,
                                         bool met) const
  {
    if (met && !this->any_image)
      return std::numeric_limits<Real>::infinity();
    Real const from = a.since > b.since ? a.since : b.since;
    return this->meeting(b.at(from) - a.at(from), b.velocity - a.velocity, from, met);
  }

  /// Calls visit(k) for all other discs that disc i may meet on a flight up to a time, if they are
  /// on the lines that they began the window with, and for all in islands around it.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_near(int i, Flight<Real> const& flight, Real to,
                                            Visit const& visit) const
  {
    auto const& w = *this;
    int const* const number = islands.number.data();
    w.arena.with_ends(flight.place, [&](auto const& ends) {
      constexpr bool across_ends = std::decay_t<decltype(ends)>::wraps;
      auto const may_meet = w.template may_meet<false>(ends, flight.line(), flight.since, to);
      auto const test = [=](int k) { return (may_meet(k) | (number[k] >= 0)) & (k != i); };
      if (w.is_near)
        w.neighbours.template for_each_around_that<across_ends>(w.cell(i), test, visit);
      else
        w.neighbours.template for_each_near_that<across_ends>(
            flight.place, w.reach(flight.velocity, to - flight.since), 0, test, visit);
    });
  }

  /// Takes a disc out of its island.
  KOKKOS_INLINE_FUNCTION void dissolve(int i) const
  {
    this->m.dismiss(i);
    islands.number(i) = partner::none;
    islands.forest.reset(i);
  }
};

/// Those who meet, if nobody else interferes, are in one island; see FindAmongCandidates.
template <class Space, class Real, bool periodic>
struct UniteMeeting {
  LineMemory<Space> m;
  Forest<Space> forest;

  KOKKOS_INLINE_FUNCTION void pair(int i, int k) const
  {
    forest.unite(i, k);
    m.call_up(i, 1);
    m.call_up(k, 1);
  }
  KOKKOS_INLINE_FUNCTION void wall(int i) const { m.call_up(i, 1); }
};

/// Makes the discs that are called up members, where the window began.
template <class Space, class Real, bool periodic>
struct BeginMembers {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const
  {
    int const i = w.slot(number);
    w.islands.number(i) = number;
    w.islands.chains.reset(number);
    w.member(number) = {w.first_flight(i), Real(0), partner::none, partner::none, partner::none, 0};
  }
};

/// Puts them into their islands.
template <class Space, class Real, bool periodic>
struct FormIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const
  {
    int const root = w.number(w.islands.forest.root(w.slot(number)));
    w.islands.island(number) = root;
    w.islands.chains.append(root, number);
  }
};

/// The order of the next events of members: by time; of simultaneous ones pairs before walls, then
/// by the lower id, then by the other.
template <class Space, class Real, bool periodic>
struct EventOrder {
  Window<Space, Real, periodic> const& w;

  KOKKOS_INLINE_FUNCTION bool operator()(int a, int b) const
  {
    auto const &p = w.member(a), &q = w.member(b);
    if (p.due != q.due)
      return p.due < q.due;
    if ((p.with >= 0) != (q.with >= 0))
      return p.with >= 0;
    int const a1 = w.id(a), b1 = w.id(b);
    if (p.with < 0)
      return a1 < b1;
    int const a2 = w.id(p.with), b2 = w.id(q.with);
    int const a_low = a1 < a2 ? a1 : a2, b_low = b1 < b2 ? b1 : b2;
    return a_low != b_low ? a_low < b_low : a1 + a2 < b1 + b2;
  }
};

/// An island of few members: each can meet all others, and the first event is looked for.
template <class Space, class Real, bool periodic>
class Few {
 public:
  static constexpr int most = 16;

  KOKKOS_INLINE_FUNCTION Few(Window<Space, Real, periodic> const& w, int root) : before_{w}
  {
    w.islands.chains.for_each(root, [&](int i) { member_[size_++] = i; });
  }

  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each(Visit const& visit) const
  {
    for (int k = 0; k < size_; ++k)
      visit(member_[k]);
  }
  /// Calls visit(j) for all members that member i can meet on its flight, and perhaps for i.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_near(int, Visit const& visit) const
  {
    for_each(visit);
  }

  KOKKOS_INLINE_FUNCTION void begin() {}
  KOKKOS_INLINE_FUNCTION void update(int) {}
  KOKKOS_INLINE_FUNCTION int first() const
  {
    int first = member_[0];
    for (int k = 1; k < size_; ++k)
      if (before_(member_[k], first))
        first = member_[k];
    return first;
  }

 private:
  EventOrder<Space, Real, periodic> before_;
  int member_[most];
  int size_ = 0;
};

/// An island of many: those whom a member can meet are looked for around it, and the first event is
/// at the top of a heap.
template <class Space, class Real, bool periodic>
class Many {
 public:
  KOKKOS_FUNCTION Many(Window<Space, Real, periodic> const& w, int root, int size)
    : w_(w),
      before_{w},
      root_(root),
      size_(size),
      heap_(&w.islands.heap(fetch_add<Space>(w.islands.heaped(), size)))
  {
    int k = 0;
    w.islands.chains.for_each(root, [&](int i) { put(i, k++); });
  }

  template <class Visit>
  KOKKOS_FUNCTION void for_each(Visit const& visit) const
  {
    for (int k = 0; k < size_; ++k)
      visit(heap_[k]);
  }
  template <class Visit>
  KOKKOS_FUNCTION void for_each_near(int i, Visit const& visit) const
  {
    w_.for_each_near(w_.slot(i), w_.member(i).flight, w_.arena.end, [&](int k) {
      if (w_.island_of(k) == root_)
        visit(w_.number(k));
    });
  }

  /// Makes a heap of the members, when all have a next event.
  KOKKOS_FUNCTION void begin()
  {
    for (int k = size_ / 2; k-- > 0;)
      sink(k);
  }
  /// Finds the place of a member that has another next event.
  KOKKOS_FUNCTION void update(int i)
  {
    rise(w_.islands.place_in_heap(i));
    sink(w_.islands.place_in_heap(i));
  }
  KOKKOS_FUNCTION int first() const { return heap_[0]; }

 private:
  KOKKOS_FUNCTION void put(int i, int k)
  {
    heap_[k] = i;
    w_.islands.place_in_heap(i) = k;
  }
  KOKKOS_FUNCTION void swap(int k, int l)
  {
    int const i = heap_[k];
    put(heap_[l], k);
    put(i, l);
  }
  KOKKOS_FUNCTION void rise(int k)
  {
    for (; k > 0 && before_(heap_[k], heap_[(k - 1) / 2]); k = (k - 1) / 2)
      swap(k, (k - 1) / 2);
  }
  KOKKOS_FUNCTION void sink(int k)
  {
    for (;;) {
      int least = k;
      for (int child = 2 * k + 1; child <= 2 * k + 2 && child < size_; ++child)
        if (before_(heap_[child], heap_[least]))
          least = child;
      if (least == k)
        return;
      swap(k, least);
      k = least;
    }
  }

  Window<Space, Real, periodic> const& w_;
  EventOrder<Space, Real, periodic> before_;
  int root_, size_;
  int* heap_;
};

/// Evolves an island from the beginning of the window to its end as if no other discs existed,
/// event by event, in the order of time.
template <class Space, class Real, bool periodic, class Law>
struct EvolveIslands {
  Window<Space, Real, periodic> w;
  Law law;
  WallRule<Real, true> wall_rule;
  int pass;
  int largest; ///< islands with more members are left alone

  KOKKOS_INLINE_FUNCTION void operator()(int root, Outcome<Real>& outcome) const
  {
    if (w.islands.island(root) != root)
      return;
    int size = 0;
    w.islands.chains.for_each(root, [&](int) { ++size; });
    outcome.largest = size > outcome.largest ? size : outcome.largest;
    if (size > largest)
      return;
    if (size <= Few<Space, Real, periodic>::most) {
      Few<Space, Real, periodic> few(w, root);
      evolve(few, root, size, outcome);
    } else {
      Many<Space, Real, periodic> many(w, root, size);
      evolve(many, root, size, outcome);
    }
  }

 private:
  template <class Members>
  KOKKOS_INLINE_FUNCTION void evolve(Members& members, int root, int size,
                                     Outcome<Real>& outcome) const
  {
    members.for_each([&](int i) { choose_next(members, i); });
    members.begin();
    IslandEvents tally;
    for (;;) {
      int const i = members.first();
      auto const& next = w.member(i);
      int const other = next.with;
      if (!(next.due < w.arena.end))
        break;
      // It holds if the other is not on another flight by now.
      if (other >= 0 && w.member(other).pass > 0 && meeting_of(i, other) != next.due) {
        choose_again(members, i);
        continue;
      }
      if (tally.events() >= 32 + 16 * size) {
        note_stuck(i, outcome);
        return;
      }
      if (other < 0) {
        hit_wall(i, tally, outcome);
      } else {
        collide(i, other, tally, outcome);
        choose_again(members, other);
      }
      choose_again(members, i);
    }
    w.islands.tallies(root) = tally;
  }

  KOKKOS_INLINE_FUNCTION Real meeting_of(int i, int j) const
  {
    auto const &a = w.member(i), &b = w.member(j);
    return w.meeting_of(a.flight, b.flight, a.met == j && b.met == i);
  }

  /// Determines the next event of a member. It need not be the next of both who take part: one of
  /// them is enough, and the one who got its flight last has looked at all others.
  template <class Members>
  KOKKOS_INLINE_FUNCTION void choose_next(Members const& members, int i) const
  {
    auto& own = w.member(i);
    auto next = w.arena.next_wall({own.flight.place, own.flight.velocity}, own.flight.since);
    members.for_each_near(i, [&](int j) {
      if (j == i)
        return;
      Real const time = meeting_of(i, j);
      if (time < next.due || (time == next.due && is_before(j, next.with)))
        next = {time, j};
    });
    own.due = next.due;
    own.with = next.with;
  }

  KOKKOS_INLINE_FUNCTION bool is_before(int j, int with) const
  {
    return with < 0 ? with != partner::none : w.id(j) < w.id(with);
  }

  template <class Members>
  KOKKOS_INLINE_FUNCTION void choose_again(Members& members, int i) const
  {
    choose_next(members, i);
    members.update(i);
  }

  /// Place and velocity of a member in the lab.
  KOKKOS_INLINE_FUNCTION Motion<Real> motion(int i, Real time) const
  {
    auto const& flight = w.member(i).flight;
    return w.arena.in_lab({flight.at(time), flight.velocity}, time);
  }

  KOKKOS_INLINE_FUNCTION void collide(int i, int j, IslandEvents& tally,
                                      Outcome<Real>& outcome) const
  {
    Real const time = w.member(i).due;
    int const first = w.id(i) < w.id(j) ? i : j, second = first == i ? j : i;
    auto a = motion(first, time), b = motion(second, time);
    auto const d = w.arena.domain.separation(a.place, b.place);
    PairVelocity<Real> const before{a.velocity, b.velocity};
    auto const after = law(contact_normal(d, static_cast<Real>(sqrt(dot(d, d)))), before);
    ++tally.collisions;
    tally.lost_pairs += energy_lost(before, after);
    tally.virial += virial_of(before, after, d);
    begin_flight(first, {a.place, after.first}, time, second, outcome);
    begin_flight(second, {b.place, after.second}, time, first, outcome);
  }

  KOKKOS_INLINE_FUNCTION void hit_wall(int i, IslandEvents& tally, Outcome<Real>& outcome) const
  {
    Real const time = w.member(i).due;
    auto const before = motion(i, time);
    auto const after =
        w.member(i).with == partner::wall_x
            ? wall_rule.off_side(before, w.arena.wall_x)
            : wall_rule.off_level(before, w.arena.wall_y,
                                  is_floor(before.place.y, before.velocity.y, w.arena.gravity));
    ++tally.wall_hits;
    tally.lost_walls += kinetic_energy(before.velocity) - kinetic_energy(after.velocity);
    begin_flight(i, after, time, partner::none, outcome);
  }

  /// A member flies on from where it is `now`, in the lab. The first of its flights is kept in
  /// `discs` and the present one in `member`; those between go to the log.
  KOKKOS_INLINE_FUNCTION void begin_flight(int i, Motion<Real> const& now, Real time, int met,
                                           Outcome<Real>& outcome) const
  {
    auto& own = w.member(i);
    if (own.pass > 0) {
      int const entry = fetch_add<Space>(w.islands.logged(), 1);
      if (entry < static_cast<int>(w.islands.log.extent(0))) {
        w.islands.log(entry) = {own.flight, own.past};
        own.past = entry;
      } else {
        ++outcome.unlogged;
      }
    }
    auto const [place, velocity] = w.arena.falling(now, time);
    own.flight = {place, velocity, time};
    own.met = met;
    own.pass = pass;
    auto const v = as<double>(own.flight.velocity);
    outcome.speed2 = dot(v, v) > outcome.speed2 ? dot(v, v) : outcome.speed2;
  }

  KOKKOS_INLINE_FUNCTION void note_stuck(int i, Outcome<Real>& outcome) const
  {
    Real const time = w.member(i).due;
    int const with = w.member(i).with;
    int const first = with >= 0 && w.id(with) < w.id(i) ? with : i, other = first == i ? with : i;
    auto const p = motion(first, time).place;
    Outcome<Real> here;
    here.stuck = {w.id(first), other >= 0 ? w.id(other) : other, p.x, p.y, time};
    outcome.merge(here);
  }
};

/// Compares the paths that discs have really taken with those of all around them outside their
/// island; where two meet, their islands are one in the next pass. A path is also compared with the
/// line that another disc began the window with, where that was on another then: in a later pass it
/// may leave it later.
///
/// At the same time it lists the candidates that discs have on their last lines: of every two, at
/// least one of which is on another line than when the window began, the one that was evolved last
/// lists them, with the line that the other has then; of two evolved in the same pass, the
/// deflected one, or the one in the lower slot.
template <class Space, class Real, bool periodic>
struct VerifyIslands {
  static constexpr int block = block_on_host<Space, 8>;

  Window<Space, Real, periodic> w;
  int pass;
  int begin, end; ///< numbers of the members, a block of which is a work item

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    CandidateBatch<Space, Real> batch(w.m);
    for_each_in_block(b, block, end - begin, [&](int k) { verify(begin + k, batch); });
    batch.flush();
  }

 private:
  KOKKOS_INLINE_FUNCTION void verify(int number, CandidateBatch<Space, Real>& batch) const
  {
    auto const& own = w.member(number);
    int const i = w.slot(number), island = w.islands.island(number);
    if (own.pass == 0) {
      if (pass > 1 && w.lists_candidates())
        list_those_deflected_before(i, own.flight, batch);
      return;
    }
    auto const& flight = own.flight;
    auto const line = flight.line();
    w.for_each_near(i, flight, w.until, [&](int k) {
      if (w.island_of(k) != island && touches(i, flight, w.arena.end, k))
        join(i, k);
      else if (w.lists_candidates())
        list_candidate(i, line, flight.since, k, batch);
    });
    if (w.lists_candidates())
      w.list_wall(i, line, flight.since, batch);
    if (own.past >= 0)
      verify_past(i, own, island);
  }

  KOKKOS_INLINE_FUNCTION void verify_past(int i, Member<Real> const& own, int island) const
  {
    w.for_each_new_flight(i, [&](Flight<Real> const& flight, Real to) {
      if (flight.since < own.flight.since)
        w.for_each_near(i, flight, to, [&](int k) {
          if (w.island_of(k) != island && touches(i, flight, to, k))
            join(i, k);
        });
      return true;
    });
  }

  /// Whether disc i, on a flight up to a time, touches disc k of another island.
  KOKKOS_INLINE_FUNCTION bool touches(int i, Flight<Real> const& flight, Real to, int k) const
  {
    if (w.is_out_of_reach(i, k))
      return false;
    return w.meeting_of(flight, w.first_flight(k), false) < to ||
           !w.for_each_new_flight(k, [&](Flight<Real> const& other, Real other_to) {
             Real const until = other_to < to ? other_to : to;
             return !(w.meeting_of(flight, other, false) < until);
           });
  }

  KOKKOS_INLINE_FUNCTION void list_candidate(int i, Line<Real> const& line, Real since, int k,
                                             CandidateBatch<Space, Real>& batch) const
  {
    if (!w.is_deflected(k)) {
      w.list_candidate(i, line, k, w.line(k), since, batch);
      return;
    }
    auto const& other = w.member(w.number(k));
    if (other.pass == pass && i > k)
      return; // it lists this pair itself
    Real const from = since > other.flight.since ? since : other.flight.since;
    w.list_candidate(i, line, k, other.flight.line(), from, batch);
  }

  /// Lists the candidates of a disc that is, after all, on the line that it began the window with:
  /// those evolved in earlier passes know it on another.
  KOKKOS_FUNCTION void list_those_deflected_before(int i, Flight<Real> const& flight,
                                                   CandidateBatch<Space, Real>& batch) const
  {
    w.for_each_near(i, flight, w.until, [&](int k) {
      if (w.is_deflected(k) && w.member(w.number(k)).pass < pass)
        list_candidate(i, flight.line(), Real(0), k, batch);
    });
  }

  /// Notes that discs i and k, of different islands or one of none, meet.
  KOKKOS_INLINE_FUNCTION void join(int i, int k) const
  {
    w.islands.forest.unite(i, k);
    call_up_island(i);
    call_up_island(k);
  }

  KOKKOS_INLINE_FUNCTION void call_up_island(int i) const
  {
    int const root = w.island_of(i);
    if (root < 0)
      w.m.call_up(i, pass + 1);
    else if (w.m.call_up(w.slot(root), pass + 1)) // or somebody else does this
      w.islands.chains.for_each(root, [&](int k) { w.m.call_up(w.slot(k), pass + 1); });
  }
};

/// Puts the discs on the lines of their last flights, enters the islands in the books and dissolves
/// them.
template <class Space, class Real, bool periodic, class LandType>
struct CommitIslands {
  Window<Space, Real, periodic> w;
  LandType land;
  Outside outside;
  double gravity;
  Scales scales;

  KOKKOS_INLINE_FUNCTION void operator()(int number, Happened& happened) const
  {
    int const i = w.slot(number);
    if (w.number(i) != number) // it has been evolved again, with another number, or is none by now
      return;
    auto const& own = w.member(number);
    if (own.pass > 0) {
      auto const line = own.flight.line();
      w.discs.set_position(i, line.position);
      w.discs.set_velocity(i, line.velocity);
    }
    if (w.islands.island(number) == number)
      enter(w.islands.tallies(number), happened.books);
    w.dissolve(i);
    settle(land, i, outside, gravity, scales, happened.books);
  }

 private:
  KOKKOS_INLINE_FUNCTION void enter(IslandEvents const& tally, Books& books) const
  {
    books.lost_pairs.add(tally.lost_pairs, scales.energy);
    books.virial.add(tally.virial, scales.virial);
    books.collisions += tally.collisions;
    if (tally.wall_hits == 0)
      return;
    books.lost_walls.add(tally.lost_walls, scales.energy);
    books.wall_hits += tally.wall_hits;
  }
};

/// Dissolves all islands, and leaves no trace of them, a block of discs at a time.
template <class Space, class Real, bool periodic>
struct DissolveIslands {
  Window<Space, Real, periodic> w;

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    w.m.dismiss_block(b, [&](int i) { w.dissolve(i); });
  }
};

} // namespace ricochet
