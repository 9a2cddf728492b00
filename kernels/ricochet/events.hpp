// Exact hard-disc dynamics: every collision at its time, in order, in parallel.
//
// A step is divided into windows of time, in which discs that meet are evolved as islands.
// kernels/README.md says why this is exact.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/events_islands.hpp"
#include "ricochet/line_search.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>
#include <type_traits>
#include <variant>
#include <vector>

namespace ricochet {

/// Engine `events`. A step is only the distance of frames: within it time is continuous.
///
/// The state after a step is a function of the state before it: how long its first window is
/// follows from that, and how long the others are from what happened in those before.
template <class Space, class Real>
class EventDriven : public Engine {
 public:
  EventDriven(Model const& model, Method const& method, std::vector<DiscState> const& initial);

  void advance(std::int64_t steps) override
  {
    for (std::int64_t k = 0; k < steps; ++k)
      step();
  }

  Report report() override;
  void start_measuring() override { books_.start_measuring(space_); }

  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  Checkpoint checkpoint() override { return save(space_, discs_, numbers()); }
  void restore(Checkpoint const& checkpoint) override
  {
    ricochet::restore(space_, discs_, numbers(), checkpoint);
    search_.forget();
  }
  std::vector<std::string> warnings() const override { return {}; }
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  auto numbers()
  {
    return [this](auto const& visit) {
      books_.visit_numbers(space_, visit);
      inspection_.visit_numbers(visit);
      visit("windows", windows_);
    };
  }

  void step()
  {
    ProfilingRegion const region("ricochet::step");
    remaining_ = dt_;
    choose_first_window();
    while (remaining_ > 0)
      is_periodic(model_.box) ? window<true>() : window<false>();
    books_.count_steps(1);
  }

  /// Advances all discs by a window.
  template <bool periodic>
  void window()
  {
    ProfilingRegion const region("ricochet::window");
    double const longest = longest_window();
    double left, fastest = 0;
    do {
      double const parts = std::max(1.0, std::ceil(remaining_ / std::min(window_, longest)));
      // remaining_ - left is exact (Sterbenz), so the windows of a step add up to it, as far as
      // their lengths are numbers of the discs' precision.
      left = parts > 1 ? remaining_ - remaining_ / parts : 0;
    } while (!advance<periodic>(remaining_ - left, fastest));
    double const length = remaining_ - left;
    remaining_ = left;
    choose_next_window(length);
  }

  /// Advances all discs by a length of time, if its islands are no more than a window can have, and
  /// make no disc much faster than the fastest at the start, or than `fastest`. Returns false if
  /// not; nothing has happened then, and `window_`, `fastest` or some memory is another.
  template <bool periodic>
  bool advance(double length, double& fastest)
  {
    search_.template prepare<periodic>(space_, discs_, inspection_, length);
    search_.note_speed(fastest);
    search_.template find<periodic>(space_, discs_, books_.view(), length, [&](auto const& lines) {
      return UniteMeeting<Space, Real, periodic>{lines.m, memory_.forest};
    });
    Kokkos::deep_copy(space_, memory_.logged, 0);
    double speed = speed_;
    int begin = 0; // of the members in a pass
    for (int pass = 1;; ++pass) {
      int const end = begin + search_.list_called(space_, pass, begin);
      Window<Space, Real, periodic> const before(lines<periodic>(length, 1.5), memory_);
      if (end == begin) {
        land(before, end);
        search_.end(length, false);
        speed_ = speed + std::fabs(model_.gravity) * length;
        return true;
      }
      if (end > memory_.room() || (can_be_shorter(length) && end > first_room(discs_.count()))) {
        give_up(before);
        make_room(length, end);
        return false;
      }
      auto const outcome = evolve_islands(before, pass, begin, end, largest_island(length));
      speed = std::max(speed, std::sqrt(outcome.speed2));
      search_.note_speed(speed);
      if (speed > before.speed) { // islands of many, and images, were looked for too near
        give_up(before);
        fastest = speed;
        return false;
      }
      if (is_too_much(outcome, speed, length)) {
        give_up(before);
        make_easier(length, outcome);
        return false;
      }
      if (outcome.unlogged > 0) {
        give_up(before);
        auto const entries = memory_.log.extent(0) + 2 * static_cast<std::size_t>(outcome.unlogged);
        memory_.log = decltype(memory_.log)("ricochet::past_flights", entries);
        return false;
      }
      verify_islands(Window<Space, Real, periodic>(lines<periodic>(length, 1), memory_), pass,
                     begin, end);
      begin = end;
    }
  }

  bool can_be_shorter(double length) const { return length > shortest_window_; }

  /// Members of an island from which on a window is too long: threads would wait for the one that
  /// evolves it.
  int largest_island(double length) const
  {
    return can_be_shorter(length) ? std::max(256, discs_.count() / 16)
                                  : std::numeric_limits<int>::max();
  }

  /// Whether a window of this length is too long for what happens in it. In a periodic box two
  /// discs must not come farther apart than one and a half lengths of it.
  bool is_too_much(Outcome<Real> const& outcome, double speed, double length) const
  {
    return outcome.stuck.first != Stuck<Real>::nowhere ||
           outcome.largest > largest_island(length) || speed * length > narrowest_period() / 4;
  }

  /// Makes windows shorter.
  ///
  /// This is where an island with lasting contact comes to, and where a solver for it belongs. An
  /// island has that when it needs more than its budget of events however short the window is.
  void make_easier(double length, Outcome<Real> const& outcome)
  {
    if (outcome.stuck.first != Stuck<Real>::nowhere && !can_be_shorter(length))
      throw LastingContact(description(outcome.stuck));
    window_ = std::max(shortest_window_, length / 8);
  }

  /// Makes windows shorter, if they can be, because of too many members; or more room for them.
  void make_room(double length, int members)
  {
    if (can_be_shorter(length)) {
      window_ = std::max(shortest_window_, length / 2);
      return;
    }
    memory_ = {space_, discs_.count(), 2 * members};
    search_.keep_listed(2 * members);
  }

  /// Takes all discs back to the beginning of the window.
  template <bool periodic>
  void give_up(Window<Space, Real, periodic> const& window)
  {
    dissolve(window);
    search_.forget(); // who was found to meet is no candidate any more
  }

  /// Members that there is room for at first. If they are half of all discs, windows are too long.
  static int first_room(int discs) { return discs / 2 + 1024; }

  std::string description(Stuck<Real> const& stuck) const;

  void choose_first_window();

  /// Length of the shorter periodic axis; infinite if none is.
  double narrowest_period() const
  {
    double narrowest = std::numeric_limits<double>::infinity();
    if (model_.box.x == Boundary::periodic)
      narrowest = std::min(narrowest, model_.box.width);
    if (model_.box.y == Boundary::periodic)
      narrowest = std::min(narrowest, model_.box.height);
    return narrowest;
  }

  /// In a window no disc flies farther than some diameters, or the square of a distance would leave
  /// little of that of a diameter; nor, at the speed of the fastest, through more than a sixteenth
  /// of a periodic box, or half the spacing of discs (at packing 0.016 to 0.11 it would then meet
  /// others than those stored near it; below, longer windows gain nothing); nor falls deeper than
  /// the box is high.
  double longest_window() const
  {
    double const diameters = (sizeof(Real) > sizeof(float) ? 64 : 8) * 2 * model_.radius;
    double const spacing =
        std::sqrt(model_.box.width / std::max(discs_.count(), 1) * model_.box.height);
    double const path = std::min({diameters, narrowest_period() / 16, spacing / 2});
    double const g = std::fabs(model_.gravity);
    double const fall = g > 0 ? std::sqrt(model_.box.height / g) : dt_;
    return speed_ > 0 ? std::min(path / speed_, fall) : fall;
  }

  /// Aims at a number of events that keeps islands small.
  void choose_next_window(double length)
  {
    auto const happened = value_after(space_, search_.happened()).books;
    auto const events = static_cast<double>(happened.collisions + happened.wall_hits);
    double const factor = events > 0 ? events_aimed_at() / events : 2;
    // A window that was cut short by the step says nothing about a much longer one.
    window_ = std::clamp(length * factor, window_ / 2, window_ * 1.5);
    window_ = std::max(window_, shortest_window_);
    ++windows_;
  }

  double events_aimed_at() const { return std::max(events_per_disc * discs_.count(), 8.0); }

  static constexpr double events_per_disc = 0.07; ///< in a window

 public: // nvcc takes device lambdas and launches only from public functions
  template <bool periodic>
  Lines<Space, Real, periodic> lines(double length, double growth) const
  {
    return search_.template lines<periodic>(discs_, length, growth);
  }
  double mean_square_speed() const;
  template <bool periodic>
  Outcome<Real> evolve_islands(Window<Space, Real, periodic> const& window, int pass, int begin,
                               int end, int largest);
  template <bool periodic>
  void verify_islands(Window<Space, Real, periodic> const& window, int pass, int begin, int end);
  template <bool periodic>
  void land(Window<Space, Real, periodic> const& window, int members);
  template <bool periodic>
  void dissolve(Window<Space, Real, periodic> const& window);

 private:
  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  LineSearch<Space, Real> search_;
  IslandMemory<Space, Real> memory_;
  RunBooks<Space> books_;
  Inspection<Space, Real> inspection_;
  // Results of kernels. Allocated once: the host's default backend, not this engine's, would fill
  // new ones.
  Kokkos::View<Outcome<Real>, Space> outcome_;
  Kokkos::View<ExactSum, Space> sum_;
  std::int64_t windows_ = 0;
  double remaining_ = 0;       ///< of the present step
  double window_ = 0;          ///< most that the next window should last
  double speed_ = 0;           ///< of the fastest disc in the step so far; no less than that
  double shortest_window_ = 0; ///< in which many events mean lasting contact
};

template <class Space, class Real>
EventDriven<Space, Real>::EventDriven(Model const& model, Method const& method,
                                      std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    law_(contact_law<Real>(model.contact)),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    search_(model, discs_.count(), first_room(discs_.count())),
    memory_(space_, discs_.count(), first_room(discs_.count())),
    books_(model, method.dt, initial),
    inspection_(model),
    outcome_("ricochet::outcome"),
    sum_("ricochet::sum")
{
  require_no_contraction(space_);
  if (is_periodic(model_.box))
    wrap_all(space_, discs_, Domain<Real, true>(model_.box));
  books_.begin(space_, discs_);
  inspection_.require_separate(space_, search_.grid(), discs_, method);
}

/// Sets the length of the first window of a step: what it should be in a gas of this density and
/// temperature T = <v^2>/2. It need not be right, but the same wherever the step begins with this
/// state.
template <class Space, class Real>
void EventDriven<Space, Real>::choose_first_window()
{
  int const n = discs_.count();
  double const diameter = 2 * model_.radius, g = std::fabs(model_.gravity);
  speed_ = std::sqrt(inspection_.extremes(space_, discs_).speed2);
  double const unit_speed = std::max(speed_, std::sqrt(g * diameter));
  shortest_window_ = unit_speed > 0 ? 2e-6 * diameter / unit_speed : dt_;

  double const rate = collision_rate(model_, static_cast<std::size_t>(n), mean_square_speed() / 2);
  window_ = rate > 0 ? 2 * events_aimed_at() / (rate * n) : dt_;
}

template <class Space, class Real>
double EventDriven<Space, Real>::mean_square_speed() const
{
  auto const discs = discs_;
  double const scale = power_scale(speed_ * speed_); // a function of the state, too
  Kokkos::parallel_reduce(
      "ricochet::mean_square_speed", Range<Space>(space_, 0, discs.count()),
      KOKKOS_LAMBDA(int i, ExactSum& sum) {
        auto const v = as<double>(discs.velocity(i));
        sum.add(dot(v, v), scale);
      },
      Merge<ExactSum, Space>(sum_));
  return value_after(space_, sum_).value(scale) / std::max(discs_.count(), 1);
}

template <class Space, class Real>
template <bool periodic>
Outcome<Real> EventDriven<Space, Real>::evolve_islands(Window<Space, Real, periodic> const& window,
                                                       int pass, int begin, int end, int largest)
{
  auto const members = uneven(space_, begin, end);
  WallRule<Real, true> const wall_rule{static_cast<Real>(model_.contact.restitution),
                                       static_cast<Real>(model_.contact.friction)};
  Kokkos::deep_copy(space_, memory_.heaped, 0);
  Kokkos::parallel_for("ricochet::begin_members", members,
                       BeginMembers<Space, Real, periodic>{window});
  Kokkos::parallel_for("ricochet::form_islands", members,
                       FormIslands<Space, Real, periodic>{window});
  std::visit(
      [&](auto const& law) {
        using ThisLaw = std::decay_t<decltype(law)>;
        Kokkos::parallel_reduce(
            "ricochet::evolve_islands", members,
            EvolveIslands<Space, Real, periodic, ThisLaw>{window, law, wall_rule, pass, largest},
            Merge<Outcome<Real>, Space>(outcome_));
      },
      law_);
  return value_after(space_, outcome_);
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::verify_islands(Window<Space, Real, periodic> const& window, int pass,
                                              int begin, int end)
{
  using Verify = VerifyIslands<Space, Real, periodic>;
  int const blocks = blocks_of(Verify::block, end - begin);
  Kokkos::parallel_for("ricochet::verify_islands", uneven(space_, 0, blocks, 8),
                       Verify{window, pass, begin, end});
}

/// Ends a window: makes the members' last flights those of their discs, and takes all discs to its
/// end.
template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::land(Window<Space, Real, periodic> const& window, int members)
{
  with_landing(discs_, model_, static_cast<double>(window.arena.end), [&](auto const& land) {
    using Commit = CommitIslands<Space, Real, periodic, std::decay_t<decltype(land)>>;
    Kokkos::parallel_reduce("ricochet::commit_islands", Range<Space>(space_, 0, members),
                            Commit{window, land, Outside(model_), model_.gravity, books_.scales()},
                            Merge<Happened, Space>(search_.happened()));
    Kokkos::parallel_for("ricochet::fly", Range<Space>(space_, 0, discs_.count()), land);
  });
  search_.enter_happened(space_, books_.view());
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::dissolve(Window<Space, Real, periodic> const& window)
{
  Kokkos::parallel_for("ricochet::dissolve_islands", Range<Space>(space_, 0, window.m.blocks()),
                       DissolveIslands<Space, Real, periodic>{window});
}

template <class Space, class Real>
std::string EventDriven<Space, Real>::description(Stuck<Real> const& stuck) const
{
  auto const number = [](auto value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", static_cast<double>(value));
    return std::string(text);
  };
  double const time = books_.time() + (dt_ - remaining_) + static_cast<double>(stuck.time);
  std::string const with = stuck.second == partner::wall_x ? " and a side wall"
                           : stuck.second == partner::wall_y
                               ? " and the floor or ceiling"
                               : " and disc " + std::to_string(stuck.second);
  return "disc " + std::to_string(stuck.first) + with + ", at (" + number(stuck.x) + ", " +
         number(stuck.y) + "), collide without end at time " + number(time) +
         ": this is lasting contact, which engine events cannot simulate";
}

template <class Space, class Real>
Report EventDriven<Space, Real>::report()
{
  search_.inspect(space_, discs_, inspection_);
  auto report = books_.report(space_, discs_);
  report.windows = windows_;
  inspection_.enter(report);
  return report;
}

} // namespace ricochet
