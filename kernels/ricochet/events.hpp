// Exact hard-disc dynamics: every collision at its time, in order, in parallel.
//
// A step is divided into intervals, in which lists of neighbours are valid, and these into windows,
// in which discs that meet are evolved as islands. kernels/README.md says why this is exact.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/events_islands.hpp"
#include "ricochet/inspection.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ricochet {

/// Engine `events`. A step is only the distance of frames: within it time is continuous.
///
/// The state after a step is a function of the state before it. What the past has taught the engine
/// (how long a window should be) changes the cost, and not a bit.
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
      visit("window", window_);
      visit("largest_island", largest_island_);
    };
  }

  void step()
  {
    ProfilingRegion const region("ricochet::step");
    remaining_ = dt_;
    while (remaining_ > 0)
      remaining_ -= is_periodic(model_.box) ? interval<true>() : interval<false>();
    books_.count_steps(1);
  }

  /// Advances all discs until a disc leaves what the lists of neighbours cover, or to the end of
  /// the step. Returns the time that has passed.
  template <bool periodic>
  double interval()
  {
    auto window = take_off<periodic>();
    Real const planned = window.arena.end;
    Real now = 0;
    while (now < window.arena.end) {
      advance_window(window, now);
      now = window.end;
    }
    land(window);
    bool const to_the_end = window.end == planned && planned == static_cast<Real>(remaining_);
    return to_the_end ? remaining_ : static_cast<double>(window.end);
  }

  /// Advances the discs that have events from `now` to the end of a window, which is found here.
  template <bool periodic>
  void advance_window(Window<Space, Real, periodic>& window, Real now)
  {
    ProfilingRegion const region("ricochet::window");
    window.end = now + static_cast<Real>(std::max(window_, shortest_window_));
    do {
      window.end = std::min(window.end, window.arena.end);
      form_islands(window);
      if (reach_fixpoint(window, now)) {
        commit(window);
        choose_next_window(static_cast<double>(window.end - now));
        return;
      }
    } while (window.end > now);
  }

  /// Evolves all islands, and again those that meet others, until none do. Returns false if the
  /// window has to be tried again; it has another end then.
  template <bool periodic>
  bool reach_fixpoint(Window<Space, Real, periodic>& window, Real now)
  {
    for (int pass = 1;; ++pass) {
      auto const outcome = evolve_islands(window, pass);
      if (outcome.leaves < window.end)
        return give_up(window, leave(window, now, outcome.leaves));
      if (outcome.stuck.first != Stuck<Real>::nowhere || outcome.too_large > 0)
        return give_up(window, shorter(window.end, now, outcome));
      verify_islands(window, pass);
      if (counts_.log > static_cast<int>(memory_.log.extent(0)))
        return give_up_for_a_longer_log(window);
      if (counts_.joints == 0)
        return true;
      form_grown_islands(window);
    }
  }

  /// The end of a window in which a disc seems to leave its neighbourhood at `time`. It is true,
  /// and the end of the interval, if it happens now: all that can prevent it has been before.
  template <bool periodic>
  Real leave(Window<Space, Real, periodic>& window, Real now, Real time)
  {
    if (time <= now)
      window.arena.end = now;
    return std::max(time, now);
  }

  /// The end of a window that is shorter because of an island that was too much for this one.
  ///
  /// This is where an island with lasting contact comes to, and where a solver for it belongs. An
  /// island has that when it needs more than its budget of events however short the window is.
  Real shorter(Real end, Real now, Outcome<Real> const& outcome)
  {
    // Twice, for the difference of two times is rounded.
    bool const shortest = static_cast<double>(end - now) <= 2 * shortest_window_;
    if (outcome.stuck.first != Stuck<Real>::nowhere && shortest)
      throw LastingContact(description(outcome.stuck));
    if (shortest)
      largest_island_ = std::numeric_limits<int>::max();
    window_ = std::max(shortest_window_, static_cast<double>(end - now) / 8);
    return shortest ? end : now + static_cast<Real>(window_);
  }

  std::string description(Stuck<Real> const& stuck) const;

  /// Aims at a number of events that keeps islands small: about 0.1 collisions a disc.
  void choose_next_window(double length)
  {
    Books const happened = value_after(space_, part_);
    auto const events = static_cast<double>(happened.collisions + happened.wall_hits);
    double const aim = std::max(events_per_disc * discs_.count(), 8.0);
    double const factor = events > 0 ? aim / events : 2;
    // A window that was cut short by the interval says nothing about a much longer one.
    window_ = std::clamp(length * factor, window_ / 2, window_ * 1.5);
    largest_island_ = large_island;
    ++windows_;
  }

  static constexpr double events_per_disc = 0.05; ///< in a window
  static constexpr int large_island = 256;        ///< evolving one is quadratic in its size

 public: // nvcc takes device lambdas and launches only from public functions
  template <bool periodic>
  Arena<Real, periodic> arena(double speed) const;
  template <bool periodic>
  Window<Space, Real, periodic> take_off();
  template <bool periodic>
  void land(Window<Space, Real, periodic> const& window);
  template <bool periodic>
  void form_islands(Window<Space, Real, periodic> const& window);
  template <bool periodic>
  Outcome<Real> evolve_islands(Window<Space, Real, periodic> const& window, int pass);
  template <bool periodic>
  void verify_islands(Window<Space, Real, periodic> const& window, int pass);
  template <bool periodic>
  void form_grown_islands(Window<Space, Real, periodic> const& window);
  template <bool periodic>
  void commit(Window<Space, Real, periodic> const& window);
  template <bool periodic>
  void dissolve_islands(Window<Space, Real, periodic> const& window);

 private:
  template <bool periodic>
  bool give_up(Window<Space, Real, periodic>& window, Real new_end)
  {
    dissolve_islands(window);
    window.end = new_end;
    return false;
  }

  template <bool periodic>
  bool give_up_for_a_longer_log(Window<Space, Real, periodic>& window)
  {
    using Log = decltype(memory_.log);
    window.m.log = memory_.log = Log(); // gives the old memory back first
    window.m.log = memory_.log = Log("ricochet::past_flights", counts_.log + counts_.log / 2);
    return give_up(window, window.end);
  }

  typename WindowMemory<Space, Real>::Counts read_counts()
  {
    return value_after(space_, memory_.counts);
  }

  static double best_skin(Model const& model, int discs);

  /// A model whose grid has cells as wide as neighbours are looked for.
  static Model model_of_grid(Model model, double skin)
  {
    model.radius += skin / 2;
    return model;
  }

  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_; ///< as the present interval began
  double skin_;              ///< how far beyond contact neighbours are looked for
  CellGrid<Space, Real> grid_;
  NeighbourLists<Space> lists_;
  WindowMemory<Space, Real> memory_;
  typename WindowMemory<Space, Real>::Counts counts_;
  RunBooks<Space> books_;
  BooksView<Space> part_; ///< of one kernel
  // Results of kernels. Allocated once: the host's default backend, not this engine's, would fill
  // new ones.
  Inspection<Space, Real> inspection_;
  Kokkos::View<Outcome<Real>, Space> outcome_;
  std::int64_t windows_ = 0;
  double remaining_ = 0;       ///< of the present step
  double window_ = 0;          ///< length that the next window should have
  double shortest_window_ = 0; ///< below it, many events mean lasting contact
  int largest_island_ = large_island;
};

template <class Space, class Real>
EventDriven<Space, Real>::EventDriven(Model const& model, Method const& method,
                                      std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    law_(contact_law<Real>(model.contact)),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    skin_(best_skin(model, discs_.count())),
    grid_(model_of_grid(model, skin_), discs_.count()),
    lists_(discs_.count()),
    memory_(discs_.count()),
    books_(model, method.dt, initial),
    part_("ricochet::part_of_books"),
    inspection_(model),
    outcome_("ricochet::outcome")
{
  require_no_contraction(space_);
  if (is_periodic(model_.box))
    wrap_all(space_, discs_, Domain<Real, true>(model_.box));
  books_.begin(space_, discs_);
  inspection_.require_separate(space_, grid_, discs_, method);
  window_ = dt_;
}

/// How far beyond contact neighbours are looked for. Farther means longer intervals, but more
/// neighbours. The best, measured at packings from 0.05 to 0.7, follows the radius of a disc's
/// share of the area.
template <class Space, class Real>
double EventDriven<Space, Real>::best_skin(Model const& model, int discs)
{
  constexpr double pi = 3.14159265358979323846;
  double const share = model.box.width * model.box.height / std::max(discs, 1);
  double const diameter = 2 * model.radius;
  double skin = std::max(2 * std::sqrt(share / pi) - 0.6 * diameter, 0.1 * diameter);
  // A disc that leaves a periodic box is brought back by one length, at the end of the interval.
  if (model.box.x == Boundary::periodic)
    skin = std::min(skin, model.box.width / 2);
  if (model.box.y == Boundary::periodic)
    skin = std::min(skin, model.box.height / 2);
  return skin;
}

/// The arena of an interval that begins when no disc is faster than `speed`.
template <class Space, class Real>
template <bool periodic>
Arena<Real, periodic> EventDriven<Space, Real>::arena(double speed) const
{
  auto const& box = model_.box;
  auto const diameter = static_cast<Real>(2 * model_.radius);
  double const allowance = 0.4999 * skin_; // both discs of a pair can take one
  // Discs are not followed farther than four times as long as the fastest could fly.
  double end = remaining_;
  if (speed > 0)
    end = std::min(end, 4 * allowance / speed);
  if (model_.gravity != 0)
    end = std::min(end, std::sqrt(box.height / std::fabs(model_.gravity)));
  auto const limits = centre_limits<Real>(model_);
  auto const images = [&](Boundary boundary, double length) {
    double const farthest = 2 * model_.radius + 2 * skin_;
    return boundary == Boundary::periodic && length < 2 * farthest ? 1 : 0;
  };
  auto const inner = [&](Boundary boundary, double length) {
    if (boundary == Boundary::walls)
      return std::numeric_limits<Real>::infinity();
    double const reach = 1.001 * (2 * model_.radius + skin_);
    return images(boundary, length) > 0 ? Real(0) : static_cast<Real>(length / 2 - reach);
  };
  return {Domain<Real, periodic>(box),
          diameter * diameter,
          static_cast<Real>(model_.gravity),
          limits.x,
          limits.y,
          static_cast<Real>(box.width),
          static_cast<Real>(box.height),
          images(box.x, box.width),
          images(box.y, box.height),
          inner(box.x, box.width),
          inner(box.y, box.height),
          static_cast<Real>(end),
          static_cast<Real>(allowance)};
}

/// Begins an interval: sorts the discs, builds their lists of neighbours and predicts how each
/// flight ends.
template <class Space, class Real>
template <bool periodic>
Window<Space, Real, periodic> EventDriven<Space, Real>::take_off()
{
  ProfilingRegion const region("ricochet::take_off");
  grid_.sort(space_, discs_, Inside::by_id);
  auto const found = inspection_.extremes(space_, discs_);
  double const speed = std::sqrt(found.speed2), diameter = 2 * model_.radius;
  double const unit_speed = std::max(speed, std::sqrt(std::fabs(model_.gravity) * diameter));
  shortest_window_ = unit_speed > 0 ? 1e-6 * diameter / unit_speed : dt_;

  Window<Space, Real, periodic> window{
      memory_,
      lists_,
      discs_,
      Neighbours<Space, Real, periodic>(discs_, grid_.cells(), model_.box),
      static_cast<Real>(diameter + skin_),
      arena<periodic>(speed),
      0};
  // Nor can a window be shorter than the rounding of times allows.
  double const rounding = static_cast<double>(std::numeric_limits<Real>::epsilon());
  shortest_window_ =
      std::max(shortest_window_, 4 * rounding * static_cast<double>(window.arena.end));
  Real closest2 = 0;
  Kokkos::parallel_reduce("ricochet::take_off", Range<Space>(space_, 0, discs_.count()),
                          TakeOff<Space, Real, periodic>{window}, Kokkos::Min<Real>(closest2));
  inspection_.note(found, std::sqrt(closest2));
  return window;
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::land(Window<Space, Real, periodic> const& window)
{
  Kokkos::parallel_for("ricochet::land", Range<Space>(space_, 0, discs_.count()),
                       Land<Space, Real, periodic>{window});
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::form_islands(Window<Space, Real, periodic> const& window)
{
  Kokkos::deep_copy(space_, memory_.counts, typename WindowMemory<Space, Real>::Counts{});
  using Due = ListDue<Space, Real, periodic>;
  Kokkos::parallel_for("ricochet::list_due",
                       Range<Space>(space_, 0, blocks_of(Due::block, discs_.count())), Due{window});
  counts_ = read_counts();
  Kokkos::parallel_for("ricochet::find_meetings", Range<Space>(space_, 0, counts_.members),
                       FindMeetings<Space, Real, periodic>{window});
  counts_ = read_counts();
  Kokkos::parallel_for("ricochet::form_islands", Range<Space>(space_, 0, counts_.members),
                       FormIslands<Space, Real, periodic>{window});
}

template <class Space, class Real>
template <bool periodic>
Outcome<Real> EventDriven<Space, Real>::evolve_islands(Window<Space, Real, periodic> const& window,
                                                       int pass)
{
  WallRule<Real, true> const wall_rule{static_cast<Real>(model_.contact.restitution),
                                       static_cast<Real>(model_.contact.friction)};
  std::visit(
      [&](auto const& law) {
        using ThisLaw = std::decay_t<decltype(law)>;
        Kokkos::parallel_reduce("ricochet::evolve_islands",
                                Range<Space>(space_, 0, counts_.members),
                                EvolveIslands<Space, Real, periodic, ThisLaw>{
                                    window, law, wall_rule, pass, largest_island_},
                                Merge<Outcome<Real>, Space>(outcome_));
      },
      law_);
  return value_after(space_, outcome_);
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::verify_islands(Window<Space, Real, periodic> const& window, int pass)
{
  Kokkos::parallel_for("ricochet::verify_islands", Range<Space>(space_, 0, counts_.members),
                       VerifyIslands<Space, Real, periodic>{window, pass});
  counts_ = read_counts();
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::form_grown_islands(Window<Space, Real, periodic> const& window)
{
  counts_.joints = 0;
  Kokkos::deep_copy(space_, memory_.counts, counts_);
  Range<Space> const members(space_, 0, counts_.members);
  Kokkos::parallel_for("ricochet::mark_grown_islands", members,
                       MarkGrownIslands<Space, Real, periodic>{window});
  Kokkos::parallel_for("ricochet::count_evolved_parts", members,
                       CountEvolvedParts<Space, Real, periodic>{window});
  Kokkos::parallel_for("ricochet::form_grown_islands", members,
                       FormIslands<Space, Real, periodic>{window});
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::commit(Window<Space, Real, periodic> const& window)
{
  Range<Space> const members(space_, 0, counts_.members);
  Kokkos::parallel_for("ricochet::predict_between_islands", members,
                       PredictBetweenIslands<Space, Real, periodic>{window});
  Kokkos::parallel_reduce("ricochet::commit_islands", members,
                          CommitIslands<Space, Real, periodic>{window, books_.scales()},
                          Merge<Books, Space>(part_));
  enter<Space>(space_, books_.view(), part_);
}

template <class Space, class Real>
template <bool periodic>
void EventDriven<Space, Real>::dissolve_islands(Window<Space, Real, periodic> const& window)
{
  counts_ = read_counts();
  Kokkos::parallel_for("ricochet::dissolve_islands", Range<Space>(space_, 0, counts_.members),
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
  inspection_.look(space_, grid_, discs_);
  auto report = books_.report(space_, discs_);
  report.windows = windows_;
  inspection_.enter(report);
  return report;
}

} // namespace ricochet
