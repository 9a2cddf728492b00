// The contacts of one step of the engine `toi`: who meets whom, or a wall, and what becomes of it.
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
// is the earliest.
#pragma once

#include "ricochet/landing.hpp"

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

/// The contacts of one disc in a step. What is looked up together is together in memory: it fills a
/// line of the cache.
template <class Real>
struct alignas(64) DiscContacts {
  static constexpr int longest = 6; ///< a disc that meets more has no list; it searches

  Encounter<Real> last;
  NextEvent<Real> next;      ///< of those called up in this step
  int partner[longest] = {}; ///< slots of discs that it meets, or met before
  int partners = 0;          ///< how many
  int changed = 0;           ///< latest round in which it got a new line, or 0
};

/// How many discs were called up for the rounds 1, 2, ... of a step.
struct CalledInRounds {
  /// After so many rounds contacts are left to the next step: discs at rest on each other would go
  /// on for ever.
  static constexpr int most_rounds = 32;

  int in_round[most_rounds + 1] = {};
};

/// Memory of the contacts of all discs in a step, by slot. Between steps it is as new.
template <class Space, class Real>
struct ContactMemory {
  static constexpr int longest = DiscContacts<Real>::longest;

  Kokkos::View<DiscContacts<Real>*, Space> of_disc;
  Kokkos::View<CalledInRounds, Space> called;

  explicit ContactMemory(int n)
    : of_disc("ricochet::disc_contacts", n), called("ricochet::called_in_rounds")
  {
  }

  /// Place on the device of the number of discs called up for a round.
  int* called_in(int round) const { return called.data()->in_round + round; }

  KOKKOS_INLINE_FUNCTION Encounter<Real>& last(int slot) const { return of_disc(slot).last; }
  KOKKOS_INLINE_FUNCTION NextEvent<Real>& next(int slot) const { return of_disc(slot).next; }

  KOKKOS_INLINE_FUNCTION void add_partner(int slot, int other) const
  {
    int const place = fetch_add<Space>(of_disc(slot).partners, 1);
    if (place < longest)
      of_disc(slot).partner[place] = other;
  }

  /// Whether all partners of a disc are in its list.
  KOKKOS_INLINE_FUNCTION bool has_list(int slot) const { return of_disc(slot).partners <= longest; }

  KOKKOS_INLINE_FUNCTION void reset(int slot) const
  {
    last(slot) = Encounter<Real>{};
    of_disc(slot).partners = 0;
    of_disc(slot).changed = 0;
  }
};

/// What all kernels of a step work on.
template <class Space, class Real, bool periodic>
struct ToiStep : Lines<Space, Real, periodic> {
  ContactMemory<Space, Real> contacts;

  ToiStep(Lines<Space, Real, periodic> const& lines, ContactMemory<Space, Real> const& memory)
    : Lines<Space, Real, periodic>(lines), contacts(memory)
  {
  }

  /// Begins to fetch a disc and its contacts.
  KOKKOS_FORCEINLINE_FUNCTION void fetch_disc_ahead(int i) const
  {
    fetch_ahead(contacts.of_disc(i));
    this->discs.fetch_motion_ahead(i);
  }

  /// Place of a disc at `time`.
  KOKKOS_INLINE_FUNCTION Vec2<Real> at(int i, Real time) const { return this->line(i).at(time); }

  /// When two discs meet on their present lines, if not clearly after the step.
  KOKKOS_INLINE_FUNCTION Real meeting_of(int i, int j) const
  {
    auto const &a = contacts.last(i), &b = contacts.last(j);
    Real const from = a.since > b.since ? a.since : b.since;
    bool const met = a.met == j && b.met == i;
    auto const p = this->line(i), q = this->line(j);
    auto const w = q.velocity - p.velocity;
    return this->meeting((q.position - p.position) + from * w, w, from, met);
  }

  /// Enters two discs in each other's lists, and calls them up.
  KOKKOS_INLINE_FUNCTION void enter_partners(int i, int j, int round) const
  {
    contacts.add_partner(i, j);
    contacts.add_partner(j, i);
    this->m.call_up(i, round);
    this->m.call_up(j, round);
  }
};

/// Counts the discs that are called up for a round as none once one is faster than the host, which
/// has planned the round, knew.
template <class Space>
struct CountCalled {
  LineMemory<Space> m;
  int* called; ///< in this round
  double fastest2;

  KOKKOS_INLINE_FUNCTION void operator()(int number) const
  {
    *called = m.counts().speed2 > fastest2 ? 0 : number;
  }
};

/// Those who meet when a step begins are partners; see FindAmongCandidates.
template <class Space, class Real, bool periodic>
struct BeginWith {
  ToiStep<Space, Real, periodic> step;

  KOKKOS_INLINE_FUNCTION void pair(int i, int k) const { step.enter_partners(i, k, 1); }
  KOKKOS_INLINE_FUNCTION void wall(int i) const { step.m.call_up(i, 1); }
};

/// Determines the next events of the discs that are called up.
template <class Space, class Real, bool periodic>
struct ChooseNext {
  ToiStep<Space, Real, periodic> step;
  int round;

  KOKKOS_INLINE_FUNCTION void operator()(int place) const
  {
    fetch_for_others(place);
    auto const& arena = step.arena;
    int const i = step.m.list(place);
    Real const since = step.contacts.last(i).since;
    auto const wall = arena.next_wall(step.line(i).motion(since), since);
    NextEvent<Real> next{arena.end, partner::none, round};
    if (wall.due < arena.end)
      next = {wall.due, wall.with, round};
    if (step.contacts.has_list(i))
      for (int k = 0; k < step.contacts.of_disc(i).partners; ++k)
        consider(i, step.contacts.of_disc(i).partner[k], next);
    else
      step.neighbours.template for_each_near_that<periodic>(
          step.at(i, since), step.reach(step.discs.velocity(i), arena.end), 0,
          [](int) { return true; }, [&](int k) { consider(i, k, next); });
    step.contacts.next(i) = next;
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void fetch_for_others(int place) const
  {
    step.fetch_disc_ahead(step.m.list(place + step.m.far_ahead));
    step.fetch_disc_ahead(step.contacts.of_disc(step.m.list(place + step.m.ahead)).partner[0]);
  }

  KOKKOS_INLINE_FUNCTION void consider(int i, int k, NextEvent<Real>& next) const
  {
    if (i == k)
      return;
    Real const time = step.meeting_of(i, k);
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
    fetch_for_others(place);
    int const i = step.m.list(place);
    NextEvent<Real> const& next = step.contacts.next(i);
    if (next.with == partner::none)
      return;
    if (next.with < 0) {
      bounce(i, next, happened);
      change(i, happened);
      return;
    }
    int const j = next.with;
    NextEvent<Real> const& of_other = step.contacts.next(j);
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
  KOKKOS_FORCEINLINE_FUNCTION void fetch_for_others(int place) const
  {
    int const later = step.m.list(place + step.m.far_ahead);
    step.fetch_disc_ahead(later);
    fetch_ahead(step.discs.id(later));
    int const partner = step.contacts.next(step.m.list(place + step.m.ahead)).with;
    if (partner < 0)
      return;
    step.fetch_disc_ahead(partner);
    fetch_ahead(step.discs.id(partner));
  }

  /// Place and velocity of a disc in the lab at the time of a contact.
  KOKKOS_INLINE_FUNCTION Motion<Real> motion(int i, Real t) const
  {
    auto const& arena = step.arena;
    auto now = arena.in_lab(step.line(i).motion(t), t);
    // The line of a disc at rest on a wall is made for the end of the step.
    int const rests = step.contacts.last(i).rests;
    if (rests != 0) {
      now.place.y = static_cast<Real>(rests) * arena.wall_y;
      now.velocity.y = 0;
    }
    return now;
  }

  /// Gives disc i the line that is at `now` at time t.
  KOKKOS_INLINE_FUNCTION void set_line(int i, Motion<Real> const& now, Real t, int met) const
  {
    auto const [q, w] = step.arena.falling(now, t);
    step.discs.set_velocity(i, w);
    step.discs.set_position(i, q - t * w);
    step.contacts.last(i) = {t, met, 0};
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
    books.lost_pairs.add(energy_lost(before, after), scales.energy);
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
      now = wall.off_side(before, arena.wall_x);
    } else {
      bool const below = is_floor(before.place.y, v.y, arena.gravity);
      now = wall.off_level(before, arena.wall_y, below);
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
    step.contacts.last(i).rests = side;
  }

  /// Notes that a disc has a new line, and calls up whom that concerns. The disc itself, and the
  /// one it has met, are only called up if they meet others then.
  KOKKOS_INLINE_FUNCTION void change(int i, Happened& happened) const
  {
    auto const w = as<double>(step.discs.velocity(i));
    happened.speed2 = dot(w, w) > happened.speed2 ? dot(w, w) : happened.speed2;
    auto& own = step.contacts.of_disc(i);
    own.changed = round;
    if (!step.contacts.has_list(i))
      return;
    for (int k = 0; k < own.partners; ++k) {
      int const other = own.partner[k];
      if (step.contacts.next(other).with == i && own.last.met != other)
        step.m.call_up(other, round + 1);
    }
    own.partners = 0;
  }
};

/// Finds whom discs meet, and a wall too, on the lines they have got in this round.
template <class Space, class Real, bool periodic>
struct FindNewContacts {
  ToiStep<Space, Real, periodic> step;
  int round;

  KOKKOS_INLINE_FUNCTION void operator()(int place) const
  {
    fetch_for_others(place);
    int const i = step.m.list(place);
    if (step.contacts.of_disc(i).changed != round)
      return;
    CandidateBatch<Space, Real> batch(step.m);
    search(i, batch);
    int const met = step.contacts.last(i).met;
    bool const is_listed = met >= 0 && step.contacts.next(met).round == round;
    if (met >= 0 && !is_listed) // it was not called up in this round, but it was next for both
      search(met, batch);
    batch.flush();
  }

 private:
  KOKKOS_FORCEINLINE_FUNCTION void fetch_for_others(int place) const
  {
    int const later = step.m.list(place + step.m.far_ahead);
    step.fetch_disc_ahead(later);
    fetch_ahead(step.cell(later));
    step.neighbours.fetch_ahead_around(step.cell(step.m.list(place + step.m.ahead)));
  }

  KOKKOS_INLINE_FUNCTION void search(int i, CandidateBatch<Space, Real>& batch) const
  {
    Real const since = step.contacts.last(i).since;
    auto const line = step.line(i);
    auto const q = line.at(since);
    step.contacts.next(i).time = step.arena.end;
    step.contacts.next(i).with = partner::none;
    auto const note = [&](int k) {
      if (k != i)
        enter(i, k, batch);
    };
    step.arena.with_ends(q, [&](auto const& ends) {
      constexpr bool across_ends = std::decay_t<decltype(ends)>::wraps;
      auto const may_meet = step.template may_meet<false>(ends, line, since, step.until);
      if (step.is_near)
        step.neighbours.template for_each_around_that<across_ends>(step.cell(i), may_meet, note);
      else
        step.neighbours.template for_each_near_that<across_ends>(
            q, step.reach(line.velocity, step.until - since), 0, may_meet, note);
    });
    if (!step.misses_walls(line, since, step.arena.end))
      step.m.call_up(i, round + 1);
    if (step.lists_candidates())
      list_wall(i, line, since, batch);
    if (!step.contacts.has_list(i)) // who was to meet it is not known; it is called up itself, too
      step.neighbours.template for_each_near_that<periodic>(
          q, step.travel + step.reach({static_cast<Real>(step.speed), 0}, step.arena.end), 0,
          [](int) { return true; }, [&](int k) { step.m.call_up(k, round + 1); });
  }

  /// Lists a wall as Lines::list_wall(), and at once for a disc that rests on one: its line is not
  /// its path; see ResolveContacts.
  KOKKOS_INLINE_FUNCTION void list_wall(int i, Line<Real> const& line, Real since,
                                        CandidateBatch<Space, Real>& batch) const
  {
    if (step.contacts.last(i).rests == 0)
      step.list_wall(i, line, since, batch);
    else if (!step.misses_walls(line, since, step.until))
      batch.add(i, partner::none, step.now + since);
  }

  KOKKOS_INLINE_FUNCTION void enter(int i, int k, CandidateBatch<Space, Real>& batch) const
  {
    if (step.meeting_of(i, k) < step.arena.end) {
      step.enter_partners(i, k, round + 1);
      return; // what comes of it is looked at then
    }
    auto const &a = step.contacts.last(i), &b = step.contacts.last(k);
    bool const found_by_both = a.met == k && b.met == i;
    if (step.lists_candidates() && !(found_by_both && i > k))
      step.list_candidate(i, step.line(i), k, step.line(k), a.since, batch);
  }
};

/// Enters in the books what it means that discs with contacts are kept inside, and forgets their
/// contacts, a block of discs at a time.
template <class Space, class Real, class LandType>
struct Settle {
  LineMemory<Space> m;
  ContactMemory<Space, Real> contacts;
  LandType land;
  Outside outside;
  double gravity;
  Scales scales;

  KOKKOS_INLINE_FUNCTION void operator()(int b, Happened& happened) const
  {
    m.dismiss_block(b, [&](int i) {
      contacts.reset(i);
      settle(land, i, outside, gravity, scales, happened.books);
    });
  }
};

} // namespace ricochet
