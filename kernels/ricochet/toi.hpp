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
    ahead_ = 0;
  }
  std::vector<std::string> warnings() const override;
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  /// After so many rounds in a step contacts are left to the next one: discs at rest on each other
  /// would go on for ever.
  static constexpr int most_rounds = 32;
  /// Most steps from one sort to the next.
  static constexpr int longest_ahead = 32;
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
    if (must_sort())
      sort<periodic>();
    find_contacts<periodic>();
    resolve_contacts<periodic>();
    fly();
    --ahead_;
    ++steps_since_sort_;
    books_.count_steps(1);
  }

  template <bool periodic>
  void resolve_contacts()
  {
    ProfilingRegion const region("ricochet::resolve_contacts");
    for (int round = 1; round <= most_rounds; ++round) {
      ListCalled<Space, Real> const list{memory_, round};
      scan("ricochet::list_called", space_, list.count(), list);
      counts_ = value_after(space_, memory_.counts);
      note_speed(std::sqrt(counts_.speed2));
      if (counts_.called == 0)
        return;
      execute_round<periodic>(round, counts_.called);
    }
    note_speed(std::sqrt(value_after(space_, memory_.counts).speed2)); // of the last round
    has_listed_ = false; // discs that must be kept inside the box now leave their lines
  }

  /// Upper bounds of the speeds in this step, and of the paths of discs in the lab.
  void note_speed(double speed) { speed_ = std::max(speed_, speed); }
  double longest_path() const
  {
    return (speed_ + std::fabs(model_.gravity) * dt_ / 2) * dt_ * (1 + 1e-6);
  }

  bool must_sort() const { return ahead_ == 0 || !is_near(travel_ + longest_path()); }

  /// Whether all that overlap, or meet in the next step, are candidates.
  bool knows_candidates() const
  {
    return has_listed_ && !must_sort() && memory_.has_room(counts_.candidates);
  }

  /// Whether discs that meet are in neighbouring cells, if none is farther than `travel` from where
  /// it was sorted.
  bool is_near(double travel) const { return travel < nearness(); }
  double nearness() const
  {
    return (grid_.cells().side() * (1 - 1e-6) - rounding() - 2 * model_.radius) / 2;
  }

  /// Whether discs sorted into neighbouring cells meet through one end of a periodic box at most.
  bool has_one_image() const
  {
    auto const is_wide = [&](Boundary boundary, double length) {
      return boundary == Boundary::walls || length > 4 * grid_.cells().side();
    };
    return is_wide(model_.box.x, model_.box.width) && is_wide(model_.box.y, model_.box.height);
  }

  /// For how many steps those that meet will be there, if no contact makes a disc faster.
  int steps_near() const
  {
    double const gain = std::fabs(model_.gravity) * dt_;
    double travel = 0;
    for (int steps = 0; steps < longest_ahead; ++steps) {
      travel += longest_path() + steps * gain * dt_ * (1 + 1e-6);
      if (!is_near(travel))
        return steps;
    }
    return longest_ahead;
  }

  /// More than rounding can add to a distance from one sort to the next.
  double rounding() const
  {
    return 8 * (2 + longest_ahead) * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
           (std::max(model_.box.width, model_.box.height) + longest_path());
  }

  /// Side of cells [diameters]: the wider they are the longer discs stay near where they were
  /// sorted; but three in a row should hold no more than a search reads at once.
  static double cell_side(Model const& model, int discs)
  {
    constexpr double in_a_cell = 1.9, least = 1.5, most = 4;
    double const area = model.box.width * model.box.height / std::max(discs, 1);
    double const side = std::sqrt(in_a_cell * area) / (2 * model.radius);
    return std::min(std::max(side, least), most);
  }

 public: // nvcc takes device lambdas and launches only from public functions
  template <bool periodic>
  void sort();
  template <bool periodic>
  ToiStep<Space, Real, periodic> this_step() const;
  template <bool periodic>
  void find_contacts();
  template <bool periodic>
  void execute_round(int round, int called);
  template <bool periodic>
  Real closest_candidates() const;
  void fly();
  void enter_happened();

 private:
  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  CellGrid<Space, Real> grid_;
  ContactMemory<Space, Real> memory_;
  RunBooks<Space> books_;
  Inspection<Space, Real> inspection_;
  Kokkos::View<Happened, Space> happened_;             ///< in one kernel
  typename ContactMemory<Space, Real>::Counts counts_; ///< as the host last saw them
  int ahead_ = 0; ///< steps until discs are sorted again, at the latest
  int steps_since_sort_ = 0;
  bool has_listed_ = false; ///< candidates
  double travel_ = 0;       ///< how far a disc can be from where it was sorted
  double speed_ = 0;        ///< of the fastest disc; no less than that
};

template <class Space, class Real>
TimeOfImpact<Space, Real>::TimeOfImpact(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    law_(contact_law<Real>(model.contact)),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    grid_(model, discs_.count(), cell_side(model, discs_.count())),
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
  require_fine_enough<Real>(model, method, books_.report(space_, discs_).temperature);
}

/// Stores the discs by cell, finds the fastest, and lists the candidates of the steps ahead.
template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::sort()
{
  grid_.sort(space_, discs_);
  speed_ = std::sqrt(inspection_.extremes(space_, discs_).speed2) * (1 + 1e-6);
  travel_ = 0;
  steps_since_sort_ = 0;
  ahead_ = std::max(steps_near(), 1);
  counts_ = {};
  double const latest_due = static_cast<double>(std::numeric_limits<float>::max());
  has_listed_ = ahead_ > 1 && has_one_image() && ahead_ * dt_ < latest_due;
  if (!has_listed_)
    return;
  Kokkos::deep_copy(space_, memory_.counts, counts_);
  using List = ListCandidates<Space, Real, periodic>;
  Kokkos::parallel_for("ricochet::list_candidates",
                       Range<Space>(space_, 0, blocks_of(List::block, discs_.count())),
                       List{this_step<periodic>(), grid_.cell()});
  counts_ = value_after(space_, memory_.counts);
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
  // Where cells are much wider than discs, the discriminant of discs far from each other is less
  // certain than their places.
  double const widest = 1 / std::min(grid_.cells().x.per_length, grid_.cells().y.per_length);
  auto const uncertainty2 = static_cast<Real>(
      64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * widest * widest);
  int const images_x = images(box.x, box.width), images_y = images(box.y, box.height);
  bool const any_image = images_x + images_y > 0;
  double const travel = travel_ + speed * dt_;
  return {memory_,
          discs_,
          Neighbours<Space, Real, periodic>(discs_, grid_.cells(), box),
          {Domain<Real, periodic>(box), size * size, static_cast<Real>(model_.gravity), limits.x,
           limits.y, static_cast<Real>(box.width), static_cast<Real>(box.height), images_x,
           images_y, inner(box.x, box.width), inner(box.y, box.height), static_cast<Real>(dt_),
           Real(0)},
          size,
          safe * safe + uncertainty2,
          static_cast<Real>(rounding()),
          any_image,
          is_near(travel) && !any_image,
          static_cast<Real>(has_listed_ ? ahead_ * dt_ : dt_),
          static_cast<Real>(steps_since_sort_ * dt_),
          has_listed_ ? std::max(nearness(), travel) : travel,
          speed};
}

template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::find_contacts()
{
  ProfilingRegion const region("ricochet::find_contacts");
  has_listed_ = has_listed_ && memory_.has_room(counts_.candidates);
  typename ContactMemory<Space, Real>::Counts counts;
  counts.candidates = counts_.candidates;
  Kokkos::deep_copy(space_, memory_.counts, counts);
  auto const step = this_step<periodic>();
  if (has_listed_) {
    auto const end = static_cast<float>((steps_since_sort_ + 1) * dt_ * (1 + 1e-6));
    using Find = FindAmongCandidates<Space, Real, periodic>;
    Kokkos::parallel_reduce("ricochet::find_among_candidates",
                            Range<Space>(space_, 0, blocks_of(Find::block, counts.candidates)),
                            Find{step, counts.candidates, end}, Merge<Happened, Space>(happened_));
    enter_happened();
    return;
  }
  auto const find = [&](auto walls, auto near) {
    Kokkos::parallel_reduce("ricochet::find_contacts", Range<Space>(space_, 0, discs_.count()),
                            FindContacts<Space, Real, periodic, walls, near>{step, grid_.cell()},
                            Merge<Happened, Space>(happened_));
  };
  bool const near = is_near(travel_ + longest_path()) && !step.any_image;
  bool const walls = model_.box.x == Boundary::walls || model_.box.y == Boundary::walls;
  if constexpr (periodic) {
    if (!walls) {
      near ? find(std::false_type{}, std::true_type{}) : find(std::false_type{}, std::false_type{});
      enter_happened();
      return;
    }
  }
  near ? find(std::true_type{}, std::true_type{}) : find(std::true_type{}, std::false_type{});
  enter_happened();
}

template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::execute_round(int round, int called)
{
  auto const step = this_step<periodic>();
  WallRule<Real, true> const wall{static_cast<Real>(model_.contact.restitution),
                                  static_cast<Real>(model_.contact.friction)};
  Kokkos::parallel_for("ricochet::choose_next", Range<Space>(space_, 0, called),
                       ChooseNext<Space, Real, periodic>{step, round});
  std::visit(
      [&](auto const& law) {
        Kokkos::parallel_reduce("ricochet::resolve_contacts", Range<Space>(space_, 0, called),
                                ResolveContacts<Space, Real, periodic, std::decay_t<decltype(law)>>{
                                    step, law, wall, books_.scales(), round},
                                Merge<Happened, Space>(happened_));
      },
      law_);
  enter_happened();
  Kokkos::parallel_for("ricochet::find_new_contacts", Range<Space>(space_, 0, called),
                       FindNewContacts<Space, Real, periodic>{step, grid_.cell(), round});
}

/// Enters what one kernel reported in the books of the run.
template <class Space, class Real>
void TimeOfImpact<Space, Real>::enter_happened()
{
  auto const counts = memory_.counts;
  auto const happened = happened_;
  auto const books = books_.view();
  Kokkos::parallel_for(
      "ricochet::enter_in_books", Range<Space>(space_, 0, 1), KOKKOS_LAMBDA(int) {
        books().merge(happened().books);
        counts().speed2 = happened().speed2;
      });
}

template <class Space, class Real>
void TimeOfImpact<Space, Real>::fly()
{
  ProfilingRegion const region("ricochet::fly");
  int const blocks = static_cast<int>(memory_.called_in_block.extent(0));
  with_landing(discs_, model_, dt_, [&](auto const& land) {
    Kokkos::parallel_reduce("ricochet::settle", Range<Space>(space_, 0, blocks),
                            Settle<Space, Real, std::decay_t<decltype(land)>>{
                                memory_, land, Outside(model_), model_.gravity, books_.scales()},
                            Merge<Happened, Space>(happened_));
    Kokkos::parallel_for("ricochet::fly", Range<Space>(space_, 0, discs_.count()), land);
  });
  enter_happened();
  travel_ += longest_path();
  speed_ += std::fabs(model_.gravity) * dt_;
}

/// Distance of the closest candidates.
template <class Space, class Real>
template <bool periodic>
Real TimeOfImpact<Space, Real>::closest_candidates() const
{
  auto const discs = discs_;
  auto const candidate = memory_.candidate;
  Domain<Real, periodic> const domain(model_.box);
  Real closest2 = 0;
  Kokkos::parallel_reduce(
      "ricochet::find_closest_candidates", Range<Space>(space_, 0, counts_.candidates),
      KOKKOS_LAMBDA(int place, Real& least) {
        int const i = candidate(place, 0), k = candidate(place, 1);
        if (k == partner::none)
          return;
        auto const d = domain.separation(discs.position(i), discs.position(k));
        least = dot(d, d) < least ? dot(d, d) : least;
      },
      Kokkos::Min<Real>(closest2));
  return std::sqrt(closest2);
}

template <class Space, class Real>
Report TimeOfImpact<Space, Real>::report()
{
  if (knows_candidates()) {
    inspection_.note(inspection_.extremes(space_, discs_), is_periodic(model_.box)
                                                               ? closest_candidates<true>()
                                                               : closest_candidates<false>());
  } else {
    inspection_.look(space_, grid_, discs_);
    ahead_ = 0; // it has sorted them
  }
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
