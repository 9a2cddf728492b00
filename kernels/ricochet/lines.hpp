// Discs on lines: who meets whom, or a wall, in a stretch of time. `toi` and `events` are made of
// it.
//
// Both engines advance all discs together, `toi` by its step and `events` by windows of its own
// choice. Times t count from the start of such a stretch, 0...end. In the frame that falls with the
// discs (see free_paths.hpp) every free flight is a straight line, p + t w. A contact at time t at
// the place q = p + t w gives a disc the velocity w' and with it another line, written as if it had
// begun with the stretch:
//   p' = q - t w'.
//
// The search for those that meet is made for several stretches at once: candidates are the pairs
// whose lines, and discs whose line and a wall, come together before the discs are sorted again.
// Each is listed with a time before which it need not be looked at. Whoever gets another line lists
// the candidates it has then. line_search.hpp plans this.
#pragma once

#include "ricochet/call_ups.hpp"
#include "ricochet/contacts.hpp"
#include "ricochet/free_paths.hpp"

#include <limits>
#include <type_traits>

namespace ricochet {

/// The line of a disc, in the falling frame.
template <class Real>
struct Line {
  Vec2<Real> position; ///< at the start of the stretch of time
  Vec2<Real> velocity;

  KOKKOS_INLINE_FUNCTION Vec2<Real> at(Real time) const { return position + time * velocity; }
  KOKKOS_INLINE_FUNCTION Motion<Real> motion(Real time) const { return {at(time), velocity}; }
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

/// Candidates, and the discs that are called up because something happens to them. Between
/// stretches of time nobody is called up.
template <class Space>
struct LineMemory : CallUps<Space> {
  /// Candidates, some of them more than once: the slots of two discs, or one and `partner::none`
  /// where it is a wall.
  Kokkos::View<int* [2], Space> candidate;
  /// Of each, a time since discs were sorted that is not later than when they come together on
  /// their present lines. All stretches go through all of these, so they are short.
  Kokkos::View<float*, Space> due;

  struct Counts {
    int called = 0; ///< for this round
    int candidates = 0;
    double speed2 = 0; ///< square of the largest speed that came of a contact in this stretch
  };
  Kokkos::View<Counts, Space> counts;

  /// For n discs, of whose lists as many as `listed` are kept at a time.
  LineMemory(int n, int listed)
    : CallUps<Space>(n, listed),
      candidate(uninitialised<decltype(candidate)>("ricochet::candidates", 3 * n)),
      due(uninitialised<decltype(due)>("ricochet::candidate_due", 3 * n)),
      counts("ricochet::line_counts")
  {
  }

  bool has_room(int candidates) const
  {
    return candidates <= static_cast<int>(candidate.extent(0));
  }
};

/// Candidates that one work item has found, which takes places in the list for several at once.
template <class Space, class Real>
class CandidateBatch {
 public:
  explicit KOKKOS_INLINE_FUNCTION CandidateBatch(LineMemory<Space> const& m) : m_(m) {}

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

  LineMemory<Space> const& m_;
  Entry entry_[capacity];
  int size_ = 0;
};

/// All discs in one stretch of time, and what is known of it.
template <class Space, class Real, bool periodic>
struct Lines {
  LineMemory<Space> m;
  Discs<Space, Real> discs; ///< the lines
  Neighbours<Space, Real, periodic> neighbours;
  typename CellGrid<Space, Real>::Ints cell; ///< by slot, where it was sorted
  Arena<Real, periodic> arena;               ///< its end is that of the stretch
  Real diameter;
  Real safe_distance2; ///< square of a diameter and of what rounding may add to a distance, or more
  Real rounding;       ///< more than it may add to a distance
  Real apart2;         ///< square of a distance from which on two discs do not meet in the stretch
  bool any_image;      ///< whether discs may meet in more than their nearest images
  bool is_near;        ///< whether discs that meet in it were sorted into neighbouring cells
  Real until;          ///< time for which candidates are listed, or the end of the stretch
  Real now;            ///< when the stretch begins, counted from when discs were sorted
  double travel;       ///< farthest that any disc is, up to then, from where it was sorted
  double speed;        ///< of the fastest disc, also after a contact

  KOKKOS_INLINE_FUNCTION bool lists_candidates() const { return until > arena.end; }

  KOKKOS_INLINE_FUNCTION Line<Real> line(int i) const
  {
    return {discs.position(i), discs.velocity(i)};
  }

  /// When two discs meet that are `d` apart at the time `from`, with relative velocity `w`, if not
  /// clearly after the stretch; `met`: whether they have just met. It is the same in either order.
  /// (No closer limit is set for what is looked for: it would be one for times before they are
  /// rounded, and the first of two that round to the same would depend on the order.)
  KOKKOS_INLINE_FUNCTION Real meeting(Vec2<Real> d, Vec2<Real> w, Real from, bool met) const
  {
    return from + arena.time_to_touch(arena.domain.separation({0, 0}, d), w, met, arena.end - from);
  }

  /// Whether two discs are so far apart as it begins that they cannot meet, whatever befalls them.
  KOKKOS_INLINE_FUNCTION bool is_out_of_reach(int i, int k) const
  {
    auto const d = arena.domain.separation(discs.position(i), discs.position(k));
    return dot(d, d) > apart2 && !any_image;
  }

  /// Whether a disc on a line surely meets no wall between two times.
  KOKKOS_INLINE_FUNCTION bool misses_walls(Line<Real> const& line, Real from, Real to) const
  {
    return !arena.has_walls() ||
           with_closer_walls().misses_walls(arena.in_lab(line.motion(from), from), to - from);
  }

  /// The arena with walls that are closer by what rounding may add to a distance.
  KOKKOS_INLINE_FUNCTION Arena<Real, periodic> with_closer_walls() const
  {
    auto closer = arena;
    closer.wall_x -= rounding;
    closer.wall_y -= rounding;
    return closer;
  }

  /// A time not later than when discs on lines `a` and `b` from `since` on are as close as
  /// safe_distance2; infinite if that is not before `until`.
  ///
  /// What rounding changes in it is less than the time in which discs cover the difference between
  /// the safe distance and a diameter, so it is not later than they touch however their places are
  /// rounded in the stretches until then.
  KOKKOS_INLINE_FUNCTION Real not_before(Line<Real> const& a, Line<Real> const& b, Real since) const
  {
    auto const w = b.velocity - a.velocity;
    auto const d = arena.domain.separation({0, 0}, (b.position - a.position) + since * w);
    if (any_image || dot(d, d) <= safe_distance2)
      return since;
    Real const time = since + time_to_meet(d, w, safe_distance2, until - since);
    return time < until ? time : std::numeric_limits<Real>::infinity();
  }

  /// The same for a line and a wall.
  KOKKOS_INLINE_FUNCTION Real not_before_wall(Line<Real> const& line, Real since) const
  {
    if (misses_walls(line, since, until))
      return std::numeric_limits<Real>::infinity();
    auto closer = with_closer_walls();
    closer.end = until;
    return closer.next_wall(line.motion(since), since).due;
  }

  /// Lists discs i and k, now on lines `a` and `b`, as a candidate if they come together in the
  /// stretches ahead.
  KOKKOS_INLINE_FUNCTION void list_candidate(int i, Line<Real> const& a, int k, Line<Real> const& b,
                                             Real since, CandidateBatch<Space, Real>& batch) const
  {
    Real const time = not_before(a, b, since);
    if (time < until)
      batch.add(i, k, now + time);
  }
  KOKKOS_INLINE_FUNCTION void list_wall(int i, Line<Real> const& line, Real since,
                                        CandidateBatch<Space, Real>& batch) const
  {
    Real const time = not_before_wall(line, since);
    if (time < until)
      batch.add(i, partner::none, now + time);
  }

  /// A test for the discs that may meet, before `to`, one on the line that it has from `since` on.
  template <bool at_start, class Ends>
  KOKKOS_INLINE_FUNCTION MayMeet<Real, Ends, at_start>
  may_meet(Ends const& ends, Line<Real> const& line, Real since, Real to) const
  {
    return {discs.x.data(), discs.y.data(), discs.vx.data(), discs.vy.data(),
            ends,           line.position,  line.velocity,   since,
            safe_distance2, to - since,     any_image};
  }

  /// Distance within which all were sorted that a disc can meet in `time`.
  KOKKOS_INLINE_FUNCTION double reach(Vec2<Real> velocity, Real time) const
  {
    auto const v = as<double>(velocity);
    return static_cast<double>(diameter) + sqrt(dot(v, v)) * static_cast<double>(time) + travel;
  }
};

/// Whether discs i and k meet in the stretch. Their overlap, at the start, is entered in the books.
template <class Space, class Real, bool periodic>
KOKKOS_FUNCTION bool meet(Lines<Space, Real, periodic> const& lines, int i, int k, Books& books)
{
  auto const& arena = lines.arena;
  auto const d = arena.domain.separation(lines.discs.position(i), lines.discs.position(k));
  auto const w = lines.discs.velocity(k) - lines.discs.velocity(i);
  Real const distance2 = dot(d, d);
  if (distance2 < arena.diameter2) {
    double const depth = overlap(static_cast<Real>(sqrt(distance2)), lines.diameter);
    books.max_overlap = depth > books.max_overlap ? depth : books.max_overlap;
  }
  return arena.time_to_touch(d, w, false, arena.end) < arena.end; // as Lines::meeting()
}

/// Calls visit(k) for discs k that may meet disc i up to Lines::until, or overlap it, so that each
/// pair is visited once. `near`: whether those that meet were sorted into neighbouring cells.
template <bool near, class Space, class Real, bool periodic, class Visit>
KOKKOS_INLINE_FUNCTION void for_each_that_may_meet(Lines<Space, Real, periodic> const& lines, int i,
                                                   Visit const& visit)
{
  auto const line = lines.line(i);
  lines.arena.with_ends(line.position, [&](auto const& ends) {
    constexpr bool across_ends = std::decay_t<decltype(ends)>::wraps;
    auto const may_meet = lines.template may_meet<true>(ends, line, 0, lines.until);
    if constexpr (near)
      lines.neighbours.template for_each_ahead_that<across_ends>(lines.cell(i), i, may_meet, visit);
    else
      lines.neighbours.template for_each_near_that<across_ends>(
          line.position, lines.reach(line.velocity, lines.until), i + 1, may_meet, visit);
  });
}

/// Lists the candidates of the time up to Lines::until, among discs that were just sorted, a block
/// of discs at a time.
template <class Space, class Real, bool periodic>
struct ListCandidates {
  static constexpr int block = block_on_host<Space, 32>;

  Lines<Space, Real, periodic> lines;

  KOKKOS_INLINE_FUNCTION void operator()(int b) const
  {
    CandidateBatch<Space, Real> batch(lines.m);
    for_each_in_block(b, block, lines.discs.count(), [&](int i) {
      auto const line = lines.line(i);
      for_each_that_may_meet<true>(
          lines, i, [&](int k) { lines.list_candidate(i, line, k, lines.line(k), 0, batch); });
      lines.list_wall(i, line, 0, batch);
    });
    batch.flush();
  }
};

/// Finds who of the candidates meets in the stretch, a block of them at a time: calls
/// meetings.pair(i, k) for those, and meetings.wall(i) for discs that may meet a wall. Candidates
/// that will not meet any more on their lines are not looked at again; nor are pairs that meet, for
/// one of them gets another line, and lists the candidates that it has then.
template <class Space, class Real, bool periodic, class Meetings>
struct FindAmongCandidates {
  static constexpr int block = block_on_host<Space, 64>;

  Lines<Space, Real, periodic> lines;
  Meetings meetings;
  int candidates;
  float end; ///< of the stretch, counted from when discs were sorted; not rounded down

  KOKKOS_INLINE_FUNCTION void operator()(int b, Happened& happened) const
  {
    // First who is due, without a branch, so that looking at one of them can begin before the one
    // before is done: it is waiting for memory that takes the time.
    int due[block];
    int size = 0;
    for_each_in_block(b, block, candidates, [&](int place) {
      due[size] = place;
      size += lines.m.due(place) <= end ? 1 : 0;
    });
    for (int k = 0; k < size; ++k)
      if (is_done_with(lines.m.candidate(due[k], 0), lines.m.candidate(due[k], 1), happened))
        lines.m.due(due[k]) = std::numeric_limits<float>::infinity();
  }

 private:
  KOKKOS_INLINE_FUNCTION bool is_done_with(int i, int k, Happened& happened) const
  {
    auto const line = lines.line(i);
    if (k != partner::none) {
      if (!meet(lines, i, k, happened.books))
        return !(lines.not_before(line, lines.line(k), 0) < lines.until);
      meetings.pair(i, k);
      return true;
    }
    if (!lines.misses_walls(line, 0, lines.arena.end))
      meetings.wall(i);
    return lines.misses_walls(line, 0, lines.until);
  }
};

/// Finds the same among all discs.
template <class Space, class Real, bool periodic, class Meetings, bool walls, bool near>
struct FindAmongAll {
  Lines<Space, Real, periodic> lines;
  Meetings meetings;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Happened& happened) const
  {
    for_each_that_may_meet<near>(lines, i, [&](int k) {
      if (meet(lines, i, k, happened.books))
        meetings.pair(i, k);
    });
    if constexpr (walls)
      if (!lines.misses_walls(lines.line(i), 0, lines.arena.end))
        meetings.wall(i);
  }
};

} // namespace ricochet
