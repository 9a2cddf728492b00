// The contacts of one step of the engine `toi`: who meets whom, or a wall, and what becomes of it.
//
// Times t count from the start of the step, 0...dt. In the frame that falls with the discs (see
// events_flight.hpp) every free flight is a straight line, p + t w. A contact at time t at the
// place q = p + t w gives a disc the velocity w' and with it another line, written as if it had
// begun with the step:
//   p' = q - t w'.
// So the arrays of positions and velocities hold p and w, whatever happens, and at the end of the
// step all discs fly alike.
//
// Contacts are resolved in rounds. In each round every disc has its next event: the earliest, by
// (time, disc before wall, id of the disc), of its contacts with walls and with all other discs on
// their present lines. Events at walls happen; so do those of two discs that are the next of both.
// The first of all events is always one of them, so rounds go on until none is left or there were
// `most_rounds`; what then overlaps meets when the next step begins.
//
// Only what can have changed is looked at again: each disc has a list of those it meets on present
// lines, complete at all times because whoever changes its line looks for others, enters itself in
// their lists and calls them up for the next round. Lists are in any order; what is taken from them
// is the earliest. A disc is called up by a mark, and those with marks are listed in the order of
// slots, so that threads keep to discs of their own and share no counter.
//
// In the same way the search for those that meet in a step is made for several steps at once:
// candidates are the pairs whose lines, and discs whose line and a wall, come together before the
// discs are sorted again. Each is listed with a time before which it need not be looked at.
#pragma once

#include "ricochet/contacts.hpp"
#include "ricochet/events_flight.hpp"

namespace ricochet {

/// What befell a disc last, in the present step.
template <class Real>
struct Encounter {
  Real since = 0;          ///< when it was; the line of the disc is its path from then on
  int met = partner::none; ///< slot of the disc it met then
  int rests = 0;           ///< 1, -1: it came to rest on the ceiling, on the floor
};

/// The next event of a disc.
template <class Real>
struct NextEvent {
  Real time;
  int with;  ///< see `partner`
  int round; ///< in which it was last determined, also where a new line has made it void since
};

/// What contacts leave to be entered in the books of the run.
struct Happened {
  Books books;
  double speed2 = 0; ///< square of the largest speed that came of a contact

  KOKKOS_INLINE_FUNCTION void merge(Happened const& other)
  {
    books.merge(other.books);
    speed2 = other.speed2 > speed2 ? other.speed2 : speed2;
  }
};

/// The contacts of one disc in a step. What is looked up together is together in memory: it fills a
/// line of the cache.
template <class Real>
struct alignas(64) DiscContacts {
  static constexpr int longest = 6; ///< a disc that meets more has no list; it searches

  Encounter<Real> last;
  NextEvent<Real> next; ///< of those called up in this step
  int partner[longest]; ///< slots of discs that it meets, or met before
  int partners = 0;     ///< how many
  int changed = 0;      ///< latest round in which it got a new line, or 0
};

/// Memory of the contacts of a step, by slot unless it says otherwise. Between steps it is as new,
/// but for the candidates.
template <class Space, class Real>
struct ContactMemory {
  using Ints = Kokkos::View<int*, Space>;
  static constexpr int longest = DiscContacts<Real>::longest;
  static constexpr int block = 16; ///< slots; a gas has fewer contacts in a step than blocks

  Kokkos::View<DiscContacts<Real>*, Space> of_disc;
  Ints called;          ///< latest round it was called up for, or 0
  Ints called_in_block; ///< latest round that any of a block was called up for
  Ints list;            ///< those called up for this round, in order
  /// Candidates, some of them more than once: the slots of two discs, or one and `partner::none`
  /// where it is a wall.
  Kokkos::View<int* [2], Space> candidate;
  /// Of each, a time since discs were sorted that is not later than when they come together on
  /// their present lines. Steps go through all of these, so they are short.
  Kokkos::View<float*, Space> due;

  struct Counts {
    int called = 0; ///< for this round
    int candidates = 0;
    double speed2 = 0; ///< of the last round
  };
  Kokkos::View<Counts, Space> counts;

  explicit ContactMemory(int n)
    : of_disc("ricochet::disc_contacts", n),
      called("ricochet::called_for_round", n),
      called_in_block("ricochet::called_in_block", blocks_of(block, n)),
      list(uninitialised<Ints>("ricochet::called_up", n)),
      candidate(uninitialised<decltype(candidate)>("ricochet::candidates", n)),
      due(uninitialised<decltype(due)>("ricochet::candidate_due", n)),
      counts("ricochet::contact_counts")
  {
  }

  KOKKOS_INLINE_FUNCTION Encounter<Real>& last(int slot) const { return of_disc(slot).last; }
  KOKKOS_INLINE_FUNCTION NextEvent<Real>& next(int slot) const { return of_disc(slot).next; }

  /// Adds a disc to those whose next event is determined in `round`.
  KOKKOS_INLINE_FUNCTION void call_up(int slot, int round) const
  {
    if (exchange<Space>(called(slot), round) != round)
      exchange<Space>(called_in_block(slot / block), round);
  }

  KOKKOS_INLINE_FUNCTION void add_partner(int slot, int other) const
  {
    int const place = fetch_add<Space>(of_disc(slot).partners, 1);
    if (place < longest)
      of_disc(slot).partner[place] = other;
  }

  /// Whether all partners of a disc are in its list.
  KOKKOS_INLINE_FUNCTION bool has_list(int slot) const { return of_disc(slot).partners <= longest; }

  bool has_room(int candidates) const
  {
    return candidates <= static_cast<int>(candidate.extent(0));
  }

  KOKKOS_INLINE_FUNCTION void reset(int slot) const
  {
    last(slot) = Encounter<Real>{};
    of_disc(slot).partners = 0;
    of_disc(slot).changed = 0;
    called(slot) = 0;
  }
};

/// Lists the discs that are called up for a round, a block of slots at a time: the body of a scan.
template <class Space, class Real>
struct ListCalled {
  ContactMemory<Space, Real> m;
  int round;

  int count() const { return static_cast<int>(m.called_in_block.extent(0)); }

  KOKKOS_INLINE_FUNCTION void operator()(int b, int& before, bool final) const
  {
    if (m.called_in_block(b) == round)
      for_each_in_block(b, m.block, static_cast<int>(m.called.extent(0)), [&](int slot) {
        if (m.called(slot) != round)
          return;
        if (final)
          m.list(before) = slot;
        ++before;
      });
    if (final && b + 1 == static_cast<int>(m.called_in_block.extent(0)))
      m.counts().called = before;
  }
};

/// Candidates that one work item has found, which takes places in the list for several at once.
template <class Space, class Real>
class CandidateBatch {
 public:
  explicit KOKKOS_INLINE_FUNCTION CandidateBatch(ContactMemory<Space, Real> const& m) : m_(m) {}

  KOKKOS_INLINE_FUNCTION void add(int slot, int other, Real time)
  {
    if (size_ == capacity)
      flush();
    entry_[size_++] = {slot, other, time};
  }

  /// Lists them, as far as there is room. More are counted than there are if there was not.
  KOKKOS_INLINE_FUNCTION void flush()
  {
    if (size_ == 0)
      return;
    int place = fetch_add<Space>(m_.counts().candidates, size_);
    int const room = static_cast<int>(m_.candidate.extent(0));
    constexpr float rounded_down = 1 - 4 * std::numeric_limits<float>::epsilon();
    for (int k = 0; k < size_ && place < room; ++k, ++place) {
      m_.candidate(place, 0) = entry_[k].slot;
      m_.candidate(place, 1) = entry_[k].other;
      m_.due(place) = static_cast<float>(entry_[k].time) * rounded_down;
    }
    size_ = 0;
  }

 private:
  struct Entry {
    int slot, other;
    Real time;
  };
  static constexpr int capacity = 32;

  ContactMemory<Space, Real> const& m_;
  Entry entry_[capacity];
  int size_ = 0;
};

/// What all kernels of a step work on.
template <class Space, class Real, bool periodic>
struct ToiStep {
  ContactMemory<Space, Real> m;
  Discs<Space, Real> discs; ///< the lines
  Neighbours<Space, Real, periodic> neighbours;
  Arena<Real, periodic> arena;
  Real diameter;
  Real safe_distance2; ///< square of a diameter and of what rounding may add to a distance, or more
  Real rounding;       ///< more than it may add to a distance
  bool any_image;      ///< whether discs may meet in more than their nearest images
  bool is_near;        ///< whether discs that meet in it were sorted into neighbouring cells
  Real until;          ///< time for which candidates are listed, or the end of the step
  Real now;            ///< when the step begins, counted from when discs were sorted
  double travel;       ///< farthest that any disc is, up to then, from where it was sorted
  double speed;        ///< of the fastest disc, also after a contact

  KOKKOS_INLINE_FUNCTION bool lists_candidates() const { return until > arena.end; }

  /// Place of a disc at `time`.
  KOKKOS_INLINE_FUNCTION Vec2<Real> at(int i, Real time) const
  {
    return discs.position(i) + time * discs.velocity(i);
  }

  /// When two discs meet on their present lines, if not clearly after the step. It is the same in
  /// either order. (No closer limit is set for what is looked for: it would be one for times before
  /// they are rounded, and the first of two that round to the same would depend on the order.)
  KOKKOS_INLINE_FUNCTION Real meeting(int i, int j) const
  {
    auto const &a = m.last(i), &b = m.last(j);
    Real const from = a.since > b.since ? a.since : b.since;
    auto const w = discs.velocity(j) - discs.velocity(i);
    auto const d = (discs.position(j) - discs.position(i)) + from * w;
    bool const met = a.met == j && b.met == i;
    return from + arena.time_to_touch(arena.domain.separation({0, 0}, d), w, met, arena.end - from);
  }

  /// Whether disc i surely meets no wall on its line between two times.
  KOKKOS_INLINE_FUNCTION bool misses_walls(int i, Real from, Real to) const
  {
    return with_closer_walls().misses_walls(arena.lab_position(at(i, from), from),
                                            arena.lab_velocity(discs.velocity(i), from), to - from);
  }

  /// The arena with walls that are closer by what rounding may add to a distance.
  KOKKOS_INLINE_FUNCTION Arena<Real, periodic> with_closer_walls() const
  {
    auto closer = arena;
    closer.wall_x -= rounding;
    closer.wall_y -= rounding;
    return closer;
  }

  /// A time not later than when discs i and k, on their lines from `since` on, are as close as
  /// safe_distance2; infinite if that is not before `until`.
  ///
  /// What rounding changes in it is less than the time in which discs cover the difference between
  /// the safe distance and a diameter, so it is not later than they touch however their places are
  /// rounded in the steps until then.
  KOKKOS_INLINE_FUNCTION Real not_before(int i, int k, Real since) const
  {
    auto const w = discs.velocity(k) - discs.velocity(i);
    auto const d =
        arena.domain.separation({0, 0}, (discs.position(k) - discs.position(i)) + since * w);
    if (any_image || dot(d, d) <= safe_distance2)
      return since;
    Real const time = since + time_to_meet(d, w, safe_distance2, until - since);
    return time < until ? time : std::numeric_limits<Real>::infinity();
  }

  /// The same for disc i and a wall.
  KOKKOS_INLINE_FUNCTION Real not_before_wall(int i, Real since) const
  {
    if (misses_walls(i, since, until))
      return std::numeric_limits<Real>::infinity();
    if (m.last(i).rests != 0) // on a line that is not its path; see ResolveContacts
      return since;
    auto closer = with_closer_walls();
    closer.end = until;
    return closer.next_wall({at(i, since), discs.velocity(i), since, 0, 0, 0}).due;
  }

  /// Lists two discs, or one and a wall, as a candidate if they come together in the steps ahead.
  KOKKOS_INLINE_FUNCTION void list_candidate(int i, int k, Real since,
                                             CandidateBatch<Space, Real>& batch) const
  {
    Real const time = not_before(i, k, since);
    if (time < until)
      batch.add(i, k, now + time);
  }
  KOKKOS_INLINE_FUNCTION void list_wall(int i, Real since, CandidateBatch<Space, Real>& batch) const
  {
    Real const time = not_before_wall(i, since);
    if (time < until)
      batch.add(i, partner::none, now + time);
  }

  /// Enters two discs in each other's lists, and calls them up.
  KOKKOS_INLINE_FUNCTION void enter_partners(int i, int j, int round) const
  {
    m.add_partner(i, j);
    m.add_partner(j, i);
    m.call_up(i, round);
    m.call_up(j, round);
  }

  /// A test for the discs that may meet disc i on the line that it has from `since` on.
  template <bool at_start, class Ends>
  KOKKOS_INLINE_FUNCTION MayMeet<Real, Ends, at_start> may_meet(Ends const& ends, int i,
                                                                Real since) const
  {
    return {discs.x.data(), discs.y.data(),    discs.vx.data(),   discs.vy.data(),
            ends,           discs.position(i), discs.velocity(i), since,
            safe_distance2, until - since,     any_image};
  }

  /// Distance within which all were sorted that a disc can meet in `time`.
  KOKKOS_INLINE_FUNCTION double reach(Vec2<Real> velocity, Real time) const
  {
    auto const v = as<double>(velocity);
    return static_cast<double>(diameter) + sqrt(dot(v, v)) * static_cast<double>(time) + travel;
  }
};

/// Enters two discs in each other's lists, at the start of the step, if they meet in it, and says
/// whether they do. Their overlap is entered in the books.
template <class Space, class Real, bool periodic>
KOKKOS_FUNCTION bool begin_with(ToiStep<Space, Real, periodic> const& step, int i, int k,
                                Books& books)
{
  auto const& arena = step.arena;
  auto const d = arena.domain.separation(step.discs.position(i), step.discs.position(k));
  auto const w = step.discs.velocity(k) - step.discs.velocity(i);
  Real const distance2 = dot(d, d);
  if (distance2 < arena.diameter2) {
    double const depth = overlap(static_cast<Real>(sqrt(distance2)), step.diameter);
    books.max_overlap = depth > books.max_overlap ? depth : books.max_overlap;
  }
  bool const meet = arena.time_to_touch(d, w, false, arena.end) < arena.end; // as in meeting()
  if (meet)
    step.enter_partners(i, k, 1);
  return meet;
}

/// Calls visit(k) for discs k that may meet disc i up to ToiStep::until, or overlap it, so that
/// each pair is visited once. `near`: whether those that meet were sorted into neighbouring cells.
template <bool near, class Space, class Real, bool periodic, class Visit>
KOKKOS_INLINE_FUNCTION void for_each_that_may_meet(ToiStep<Space, Real, periodic> const& step,
                                                   int cell, int i, Visit const& visit)
{
  auto const p = step.discs.position(i);
  step.arena.with_ends(p, [&](auto const& ends) {
    constexpr bool across_ends = std::decay_t<decltype(ends)>::wraps;
    auto const may_meet = step.template may_meet<true>(ends, i, 0);
    if constexpr (near)
      step.neighbours.template for_each_ahead_that<across_ends>(cell, i, may_meet, visit);
    else
      step.neighbours.template for_each_near_that<across_ends>(
          p, step.reach(step.discs.velocity(i), step.until), i + 1, may_meet, visit);
  });
}

/// Lists the candidates of the time up to ToiStep::until, among discs that were just sorted, a
/// block of discs at a time.
template <class Space, class Real, bool periodic>
struct ListCandidates {
  static constexpr int block = block_on_host<Space, 32>;

  ToiStep<Space, Real, periodic> step;
  typename CellGrid<Space, Real>::Ints cell;

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    CandidateBatch<Space, Real> batch(step.m);
    for_each_in_block(b, block, step.discs.count(), [&](int i) {
      for_each_that_may_meet<true>(step, cell(i), i,
                                   [&](int k) { step.list_candidate(i, k, 0, batch); });
      step.list_wall(i, 0, batch);
    });
    batch.flush();
  }
};

/// Finds who of the candidates meets in the step, a block of them at a time. Those that will not
/// meet any more on their lines, or meet now, are not looked at again: new lines, new candidates.
template <class Space, class Real, bool periodic>
struct FindAmongCandidates {
  static constexpr int block = block_on_host<Space, 64>;

  ToiStep<Space, Real, periodic> step;
  int candidates;
  float end; ///< of the step, counted from when discs were sorted; not rounded down

  KOKKOS_INLINE_FUNCTION void operator()(int b, Happened& happened) const
  {
    // First who is due, without a branch, so that looking at one of them can begin before the one
    // before is done: it is waiting for memory that takes the time.
    int due[block];
    int size = 0;
    for_each_in_block(b, block, candidates, [&](int place) {
      due[size] = place;
      size += step.m.due(place) <= end ? 1 : 0;
    });
    for (int k = 0; k < size; ++k)
      if (is_done_with(step.m.candidate(due[k], 0), step.m.candidate(due[k], 1), happened))
        step.m.due(due[k]) = std::numeric_limits<float>::infinity();
  }

 private:
  KOKKOS_INLINE_FUNCTION bool is_done_with(int i, int k, Happened& happened) const
  {
    if (k != partner::none)
      return begin_with(step, i, k, happened.books) || !(step.not_before(i, k, 0) < step.until);
    if (!step.misses_walls(i, 0, step.arena.end))
      step.m.call_up(i, 1);
    return step.misses_walls(i, 0, step.until);
  }
};

/// Finds who meets in the step, at walls too, among all.
template <class Space, class Real, bool periodic, bool walls, bool near>
struct FindContacts {
  ToiStep<Space, Real, periodic> step;
  typename CellGrid<Space, Real>::Ints cell;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Happened& happened) const
  {
    for_each_that_may_meet<near>(step, cell(i), i,
                                 [&](int k) { begin_with(step, i, k, happened.books); });
    if constexpr (walls)
      if (!step.misses_walls(i, 0, step.until))
        step.m.call_up(i, 1);
  }
};

/// Determines the next events of the discs that are called up.
template <class Space, class Real, bool periodic>
struct ChooseNext {
  ToiStep<Space, Real, periodic> step;
  int round;

  KOKKOS_INLINE_FUNCTION void operator()(int place) const
  {
    auto const& arena = step.arena;
    int const i = step.m.list(place);
    Real const since = step.m.last(i).since;
    auto const wall = arena.next_wall({step.at(i, since), step.discs.velocity(i), since, 0, 0, 0});
    NextEvent<Real> next{arena.end, partner::none, round};
    if (wall.due < arena.end)
      next = {wall.due, wall.with, round};
    if (step.m.has_list(i))
      for (int k = 0; k < step.m.of_disc(i).partners; ++k)
        consider(i, step.m.of_disc(i).partner[k], next);
    else
      step.neighbours.template for_each_near_that<periodic>(
          step.at(i, since), step.reach(step.discs.velocity(i), arena.end), 0,
          [](int) { return true; }, [&](int k) { consider(i, k, next); });
    step.m.next(i) = next;
  }

 private:
  KOKKOS_INLINE_FUNCTION void consider(int i, int k, NextEvent<Real>& next) const
  {
    if (i == k)
      return;
    Real const time = step.meeting(i, k);
    bool const is_first = time < next.time || (time == next.time && is_before(k, next.with));
    if (is_first && time < step.arena.end)
      next = {time, k, next.round};
  }

  KOKKOS_INLINE_FUNCTION bool is_before(int k, int with) const
  {
    return with < 0 || step.discs.id(k) < step.discs.id(with);
  }
};

/// Executes what is next for all that take part in it.
template <class Space, class Real, bool periodic, class LawType>
struct ResolveContacts {
  ToiStep<Space, Real, periodic> step;
  LawType law;
  WallRule<Real, true> wall;
  Scales scales;
  int round;

  KOKKOS_INLINE_FUNCTION void operator()(int place, Happened& happened) const
  {
    int const i = step.m.list(place);
    NextEvent<Real> const& next = step.m.next(i);
    if (next.with == partner::none)
      return;
    if (next.with < 0) {
      bounce(i, next, happened);
      change(i, happened);
      return;
    }
    int const j = next.with;
    NextEvent<Real> const& of_other = step.m.next(j);
    bool const is_mine = of_other.round < round || step.discs.id(i) < step.discs.id(j);
    if (of_other.with != i || !is_mine)
      return;
    if (step.discs.id(i) < step.discs.id(j))
      collide(i, j, next.time, happened.books);
    else
      collide(j, i, next.time, happened.books);
    change(i, happened);
    change(j, happened);
  }

 private:
  /// Place and velocity of a disc in the lab at the time of a contact.
  KOKKOS_INLINE_FUNCTION Motion<Real> motion(int i, Real t) const
  {
    auto const& arena = step.arena;
    Motion<Real> now{arena.lab_position(step.at(i, t), t),
                     arena.lab_velocity(step.discs.velocity(i), t)};
    // The line of a disc at rest on a wall is made for the end of the step.
    int const rests = step.m.last(i).rests;
    if (rests != 0) {
      now.place.y = static_cast<Real>(rests) * arena.wall_y;
      now.velocity.y = 0;
    }
    return now;
  }

  /// Gives disc i the line that is at `now` at time t.
  KOKKOS_INLINE_FUNCTION void set_line(int i, Motion<Real> const& now, Real t, int met) const
  {
    Real const g = step.arena.gravity;
    Vec2<Real> const w{now.velocity.x, now.velocity.y + g * t};
    Vec2<Real> const q{now.place.x, now.place.y + g * t * t / 2};
    step.discs.set_velocity(i, w);
    step.discs.set_position(i, q - t * w);
    step.m.last(i) = {t, met, 0};
  }

  KOKKOS_INLINE_FUNCTION void collide(int i, int j, Real t, Books& books) const
  {
    auto a = motion(i, t), b = motion(j, t);
    auto const separation = step.arena.domain.separation(a.place, b.place);
    Real const distance = sqrt(dot(separation, separation));
    PairVelocity<Real> const before{a.velocity, b.velocity};
    auto const after = law(contact_normal(separation, distance), before);
    a.velocity = after.first;
    b.velocity = after.second;
    set_line(i, a, t, j);
    set_line(j, b, t, i);

    ++books.collisions;
    double const depth = overlap(distance, step.diameter);
    books.max_overlap = depth > books.max_overlap ? depth : books.max_overlap;
    books.virial.add(virial_of(before, after, separation), scales.virial);
    books.lost_pairs.add((kinetic_energy(before.first) + kinetic_energy(before.second)) -
                             (kinetic_energy(after.first) + kinetic_energy(after.second)),
                         scales.energy);
  }

  /// A disc that returns to the wall n times in the remaining time of the step does so with alpha^n
  /// of its speed u, each time after 2 alpha^n u/g; together they take 2 alpha u/(g (1 - alpha)).
  /// If that is no more than what remains, it comes to rest there: normal velocity 0, and beta^n =
  /// 0 of the tangential, or all of it if beta = 1.
  KOKKOS_INLINE_FUNCTION void bounce(int i, NextEvent<Real> const& next, Happened& happened) const
  {
    auto const& arena = step.arena;
    Real const t = next.time;
    auto const before = motion(i, t);
    auto const v = before.velocity;
    auto now = before;
    int rests = 0;
    if (next.with == partner::wall_x) {
      now.place.x = v.x < 0 ? -arena.wall_x : arena.wall_x;
      now.velocity = {wall.normal(v.x), wall.tangential(v.y)};
    } else {
      bool const below = v.y < 0 || (v.y == 0 && arena.gravity > 0);
      now.place.y = below ? -arena.wall_y : arena.wall_y;
      now.velocity = {wall.tangential(v.x), wall.normal(v.y)};
      Real const pull = below ? arena.gravity : -arena.gravity;
      Real const u = below ? -v.y : v.y;
      if (pull > 0 && 2 * wall.alpha * u <= pull * (1 - wall.alpha) * (arena.end - t)) {
        now.velocity = {wall.beta < 1 ? Real(0) : v.x, 0};
        rests = below ? -1 : 1;
      }
    }
    set_line(i, now, t, partner::none);
    if (rests != 0)
      rest(i, now, t, rests);

    auto& books = happened.books;
    ++books.wall_hits;
    books.lost_walls.add(kinetic_energy(v) - kinetic_energy(now.velocity), scales.energy);
    books.numerical.add(static_cast<double>(arena.gravity) * (static_cast<double>(now.place.y) -
                                                              static_cast<double>(before.place.y)),
                        scales.energy);
  }

  /// Gives a disc the line that ends the step at rest on the wall. In between it is up to g dt^2/2
  /// beyond it; motion() knows better.
  KOKKOS_INLINE_FUNCTION void rest(int i, Motion<Real> const& now, Real t, int side) const
  {
    Real const g = step.arena.gravity, end = step.arena.end;
    Vec2<Real> const w{now.velocity.x, g * end};
    step.discs.set_velocity(i, w);
    step.discs.set_position(i,
                            {now.place.x - t * w.x, (now.place.y + g * end * end / 2) - end * w.y});
    step.m.last(i).rests = side;
  }

  /// Notes that a disc has a new line, and calls up whom that concerns. The disc itself, and the
  /// one it has met, are only called up if they meet others then.
  KOKKOS_INLINE_FUNCTION void change(int i, Happened& happened) const
  {
    auto const w = as<double>(step.discs.velocity(i));
    happened.speed2 = dot(w, w) > happened.speed2 ? dot(w, w) : happened.speed2;
    auto& own = step.m.of_disc(i);
    own.changed = round;
    if (!step.m.has_list(i))
      return;
    for (int k = 0; k < own.partners; ++k) {
      int const other = own.partner[k];
      if (step.m.next(other).with == i && own.last.met != other)
        step.m.call_up(other, round + 1);
    }
    own.partners = 0;
  }
};

/// Finds whom discs meet, and a wall too, on the lines they have got in this round.
template <class Space, class Real, bool periodic>
struct FindNewContacts {
  ToiStep<Space, Real, periodic> step;
  typename CellGrid<Space, Real>::Ints cell;
  int round;

  KOKKOS_INLINE_FUNCTION void operator()(int place) const
  {
    int const i = step.m.list(place);
    if (step.m.of_disc(i).changed != round)
      return;
    CandidateBatch<Space, Real> batch(step.m);
    search(i, batch);
    int const met = step.m.last(i).met;
    bool const is_listed = met >= 0 && step.m.next(met).round == round;
    if (met >= 0 && !is_listed) // it was not called up in this round, but it was next for both
      search(met, batch);
    batch.flush();
  }

 private:
  KOKKOS_INLINE_FUNCTION void search(int i, CandidateBatch<Space, Real>& batch) const
  {
    Real const since = step.m.last(i).since;
    auto const q = step.at(i, since);
    step.m.next(i).time = step.arena.end;
    step.m.next(i).with = partner::none;
    auto const note = [&](int k) {
      if (k != i)
        enter(i, k, batch);
    };
    step.arena.with_ends(q, [&](auto const& ends) {
      constexpr bool across_ends = std::decay_t<decltype(ends)>::wraps;
      auto const may_meet = step.template may_meet<false>(ends, i, since);
      if (step.is_near)
        step.neighbours.template for_each_around_that<across_ends>(cell(i), may_meet, note);
      else
        step.neighbours.template for_each_near_that<across_ends>(
            q, step.reach(step.discs.velocity(i), step.until - since), 0, may_meet, note);
    });
    if (!step.misses_walls(i, since, step.arena.end))
      step.m.call_up(i, round + 1);
    if (step.lists_candidates())
      step.list_wall(i, since, batch);
    if (!step.m.has_list(i)) // who was to meet it is not known; it is called up itself, too
      step.neighbours.template for_each_near_that<periodic>(
          q, step.travel + step.reach({static_cast<Real>(step.speed), 0}, step.arena.end), 0,
          [](int) { return true; }, [&](int k) { step.m.call_up(k, round + 1); });
  }

  KOKKOS_INLINE_FUNCTION void enter(int i, int k, CandidateBatch<Space, Real>& batch) const
  {
    if (step.meeting(i, k) < step.arena.end) {
      step.enter_partners(i, k, round + 1);
      return; // what comes of it is looked at then
    }
    bool const found_by_both = step.m.last(i).met == k && step.m.last(k).met == i;
    if (step.lists_candidates() && !(found_by_both && i > k))
      step.list_candidate(i, k, step.m.last(i).since, batch);
  }
};

} // namespace ricochet
