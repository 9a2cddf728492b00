// The engine `toi`: fixed step, contacts at their time of impact inside it.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/inspection.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"
#include "ricochet/toi_contacts.hpp"
#include "ricochet/toi_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>

namespace ricochet {

/// Engine `toi`. The state after a step is a function of the state before it: how often discs are
/// sorted, and how far is searched, changes the cost and not a bit.
template <class Space, class Real>
class TimeOfImpact : public Engine {
  static_assert(Kokkos::SpaceAccessibility<Space, typename Space::memory_space>::accessible,
                "the kernels must be able to access the discs they are given");

 public:
  TimeOfImpact(Model const& model, Method const& method, std::vector<DiscState> const& initial);

  void advance(std::int64_t steps) override
  {
    for (std::int64_t k = 0; k < steps; ++k)
      if (is_periodic(model_.box))
        step<true>();
      else
        step<false>();
  }

  Report report() override;
  void start_measuring() override { books_.start_measuring(space_); }

  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  Checkpoint checkpoint() override { return save(space_, discs_, numbers()); }
  void restore(Checkpoint const& checkpoint) override
  {
    ricochet::restore(space_, discs_, numbers(), checkpoint);
    is_sorted_ = false;
  }
  std::vector<std::string> warnings() const override;
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  using Range = Kokkos::RangePolicy<Space>;

  /// After so many rounds in a step contacts are left to the next one: discs at rest on each other
  /// would go on for ever.
  static constexpr int most_rounds = 32;
  /// Of cells [diameters]: few more discs are in reach than in smaller ones, and a disc may move
  /// 0.37 diameters before all have to be sorted again.
  static constexpr double cell_side = 1.75;
  /// On a periodic axis, images of a disc on either side that others are compared with.
  static constexpr int most_images = 8;

  auto numbers()
  {
    return [this](auto const& visit) {
      books_.visit_numbers(space_, visit);
      inspection_.visit_numbers(visit);
    };
  }

  template <bool periodic>
  void step()
  {
    ProfilingRegion const region("ricochet::step");
    if (!is_sorted_ || !is_near(travel_ + longest_path()))
      sort();
    find_contacts<periodic>();
    resolve_contacts<periodic>();
    fly();
    books_.count_step();
  }

  template <bool periodic>
  void resolve_contacts()
  {
    ProfilingRegion const region("ricochet::resolve_contacts");
    for (int round = 1; round <= most_rounds; ++round) {
      auto const counts = value_after(space_, memory_.counts);
      note_speed(std::sqrt(counts.speed2));
      int const called = counts.list[round % 2];
      if (called == 0)
        break;
      execute_round<periodic>(round, called);
    }
  }

  /// Upper bounds of the speeds in this step, and of the paths of discs in the lab.
  void note_speed(double speed) { speed_ = std::max(speed_, speed); }
  double longest_path() const
  {
    return (speed_ + std::fabs(model_.gravity) * dt_ / 2) * dt_ * (1 + 1e-6);
  }

  /// Whether discs that meet are in neighbouring cells, if none is farther than `travel` from where
  /// it was sorted.
  bool is_near(double travel) const
  {
    double const diameter = 2 * model_.radius;
    return diameter + 2 * travel < grid_.cells().side() * (1 - 1e-6) - rounding();
  }

  /// What rounding can add to a distance.
  double rounding() const
  {
    return 16 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
           (std::max(model_.box.width, model_.box.height) + longest_path());
  }

 public: // nvcc takes device lambdas and launches only from public functions
  void sort();
  template <bool periodic>
  ToiStep<Space, Real, periodic> this_step() const;
  template <bool periodic>
  void find_contacts();
  template <bool periodic>
  void execute_round(int round, int called);
  void fly();
  void enter_happened(int next_round);

 private:
  void require_fine_enough(Method const& method) const;

  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  CellGrid<Space, Real> grid_;
  ContactMemory<Space, Real> memory_;
  RunBooks<Space> books_;
  Inspection<Space, Real> inspection_;
  Kokkos::View<Happened, Space> happened_; ///< in one kernel
  bool is_sorted_ = false;
  double travel_ = 0; ///< how far a disc can be from where it was sorted
  double speed_ = 0;  ///< of the fastest disc; no less than that
};

template <class Space, class Real>
TimeOfImpact<Space, Real>::TimeOfImpact(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    law_(contact_law<Real>(model.contact)),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    grid_(model, discs_.count(), cell_side),
    memory_(discs_.count()),
    books_(model, method.dt, initial),
    inspection_(model),
    happened_("ricochet::happened")
{
  require_no_contraction(space_);
  if (is_periodic(model_.box))
    wrap_all(space_, discs_, Domain<Real, true>(model_.box));
  books_.begin(space_, discs_);
  inspection_.require_separate(space_, grid_, discs_, method);
  if (method.precision == Precision::single_)
    require_fine_enough(method);
}

/// Throws std::invalid_argument if places are too coarse for the way of a disc in a step. With
/// steps of a third of the spacing of places and less, discs collide too often, and then freeze.
template <class Space, class Real>
void TimeOfImpact<Space, Real>::require_fine_enough(Method const& method) const
{
  auto const far = static_cast<Real>(std::max(model_.box.width, model_.box.height) / 2);
  double const spacing = static_cast<double>(std::nextafter(far, 2 * far) - far);
  auto const report = books_.report(space_, discs_);
  double const way = std::sqrt(report.temperature) * method.dt;
  if (way > 0 && spacing > 0.1 * way)
    throw std::invalid_argument(
        "engine toi cannot simulate this scene:\n  numbers of single precision are " +
        std::to_string(spacing / way) +
        " of a thermal disc's way in a step apart in this box; allowed: up to 0.1 (a longer step, "
        "or double precision)");
}

/// Stores the discs by cell, and finds the fastest.
template <class Space, class Real>
void TimeOfImpact<Space, Real>::sort()
{
  grid_.sort(space_, discs_);
  speed_ = std::sqrt(inspection_.extremes(space_, discs_).speed2) * (1 + 1e-6);
  travel_ = 0;
  is_sorted_ = true;
}

template <class Space, class Real>
template <bool periodic>
ToiStep<Space, Real, periodic> TimeOfImpact<Space, Real>::this_step() const
{
  auto const& box = model_.box;
  double const diameter = 2 * model_.radius;
  // A collision makes no disc faster than the root of the sum of both squares.
  double const speed = 1.5 * speed_ + std::fabs(model_.gravity) * dt_;
  double const apart = 2 * (speed * dt_ + std::fabs(model_.gravity) * dt_ * dt_) + diameter;
  auto const limits = centre_limits<Real>(model_);
  // The image of the other disc that is nearest at some time may be met at another only if the two
  // come that far.
  auto const images = [&](Boundary boundary, double length) {
    if (boundary == Boundary::walls)
      return 0;
    double const far = apart + std::max(length / 2, apart) + rounding();
    return static_cast<int>(std::min(std::floor(far / length), double{most_images}));
  };
  // Whoever is farther than that from the ends of the box has no neighbours across them.
  auto const inner = [&](Boundary boundary, double length) {
    double const cells = 2 / std::min(grid_.cells().x.per_length, grid_.cells().y.per_length);
    double const far = std::max(cells, apart + travel_ + speed * dt_) + rounding();
    return boundary == Boundary::walls ? std::numeric_limits<Real>::infinity()
                                       : static_cast<Real>(length / 2 - far);
  };
  auto const size = static_cast<Real>(diameter);
  auto const safe = static_cast<Real>(diameter + rounding());
  int const images_x = images(box.x, box.width), images_y = images(box.y, box.height);
  return {memory_,
          discs_,
          Neighbours<Space, Real, periodic>(discs_, grid_.cells(), box),
          {Domain<Real, periodic>(box), size * size, static_cast<Real>(model_.gravity), limits.x,
           limits.y, static_cast<Real>(box.width), static_cast<Real>(box.height), images_x,
           images_y, inner(box.x, box.width), inner(box.y, box.height), static_cast<Real>(dt_),
           Real(0)},
          size,
          safe * safe,
          images_x + images_y > 0,
          travel_ + speed * dt_,
          speed};
}

template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::find_contacts()
{
  ProfilingRegion const region("ricochet::find_contacts");
  auto const counts = memory_.counts;
  Kokkos::deep_copy(space_, counts, typename ContactMemory<Space, Real>::Counts{});
  auto const step = this_step<periodic>();
  auto const find = [&](auto walls, auto near) {
    Kokkos::parallel_reduce("ricochet::find_contacts", Range(space_, 0, discs_.count()),
                            FindContacts<Space, Real, periodic, walls, near>{step, grid_.cell()},
                            Merge<Happened, Space>(happened_));
  };
  bool const near = is_near(travel_ + longest_path()) && !step.any_image;
  bool const walls = model_.box.x == Boundary::walls || model_.box.y == Boundary::walls;
  if constexpr (periodic) {
    if (!walls) {
      near ? find(std::false_type{}, std::true_type{}) : find(std::false_type{}, std::false_type{});
      enter_happened(1);
      return;
    }
  }
  near ? find(std::true_type{}, std::true_type{}) : find(std::true_type{}, std::false_type{});
  enter_happened(1);
}

template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::execute_round(int round, int called)
{
  auto const step = this_step<periodic>();
  WallRule<Real, true> const wall{static_cast<Real>(model_.contact.restitution),
                                  static_cast<Real>(model_.contact.friction)};
  Kokkos::parallel_for("ricochet::choose_next", Range(space_, 0, called),
                       ChooseNext<Space, Real, periodic>{step, round});
  std::visit(
      [&](auto const& law) {
        Kokkos::parallel_reduce("ricochet::resolve_contacts", Range(space_, 0, called),
                                ResolveContacts<Space, Real, periodic, std::decay_t<decltype(law)>>{
                                    step, law, wall, books_.scales(), round},
                                Merge<Happened, Space>(happened_));
      },
      law_);
  enter_happened(round + 1);
  Kokkos::parallel_for("ricochet::find_new_contacts",
                       Range(space_, 0, std::min(2 * called, discs_.count())),
                       FindNewContacts<Space, Real, periodic>{step, round});
}

/// Enters what one kernel reported in the books of the run.
template <class Space, class Real>
void TimeOfImpact<Space, Real>::enter_happened(int next_round)
{
  auto const counts = memory_.counts;
  auto const happened = happened_;
  auto const books = books_.view();
  Kokkos::parallel_for(
      "ricochet::enter_in_books", Range(space_, 0, 1), KOKKOS_LAMBDA(int) {
        books().merge(happened().books);
        counts().speed2 = happened().speed2;
        if (next_round > 1)
          counts().list[(next_round + 1) % 2] = 0;
      });
}

template <class Space, class Real>
void TimeOfImpact<Space, Real>::fly()
{
  ProfilingRegion const region("ricochet::fly");
  auto const memory = memory_;
  int const active = value_after(space_, memory_.counts).active;
  with_landing(discs_, model_, dt_, [&](auto const& land) {
    Kokkos::parallel_reduce("ricochet::settle", Range(space_, 0, active),
                            Settle<Space, Real, std::decay_t<decltype(land)>>{
                                memory, land, Outside(model_), model_.gravity, books_.scales()},
                            Merge<Happened, Space>(happened_));
    Kokkos::parallel_for("ricochet::fly", Range(space_, 0, discs_.count()), land);
  });
  enter_happened(1);
  travel_ += longest_path();
  speed_ += std::fabs(model_.gravity) * dt_;
}

template <class Space, class Real>
Report TimeOfImpact<Space, Real>::report()
{
  inspection_.look(space_, grid_, discs_);
  is_sorted_ = false;
  auto report = books_.report(space_, discs_);
  inspection_.enter(report);
  return report;
}

template <class Space, class Real>
std::vector<std::string> TimeOfImpact<Space, Real>::warnings() const
{
  return {};
}

} // namespace ricochet
