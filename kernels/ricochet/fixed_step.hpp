// The time step of the original model, shared by the engines that follow it.
#pragma once

#include "ricochet/contacts.hpp"
#include "ricochet/diagnostics.hpp"
#include "ricochet/engine.hpp"
#include "ricochet/flight.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/walls.hpp"

#include <cmath>
#include <optional>
#include <stdexcept>
#include <variant>

namespace ricochet {

/// An engine that advances all discs by the same fixed step: contacts, then motion, then walls.
///
/// `PairStep` resolves the contacts of a state whose overlaps were found. All work is queued on one
/// execution space instance; only report(), states() and state_hash() wait for it.
template <class Space, class Real, class PairStep>
class FixedStep : public Engine {
  static_assert(Kokkos::SpaceAccessibility<Space, typename Space::memory_space>::accessible,
                "the kernels must be able to access the discs they are given");

 public:
  FixedStep(Model const& model, Method const& method, std::vector<DiscState> const& initial)
    : model_(model),
      dt_(method.dt),
      diameter_(static_cast<Real>(2) * static_cast<Real>(model.radius)),
      law_(contact_law<Real>(model.contact)),
      discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
      grid_(model, discs_.count()),
      pairs_(grid_, method.execution, discs_.count()),
      books_("ricochet::books"),
      part_("ricochet::part_of_books"),
      scales_(scales_for(model, initial))
  {
    if (contracts<double>(space_) || contracts<float>(space_))
      throw std::runtime_error(
          "this build fuses multiplications and additions (floating-point contraction), so its "
          "results would differ from other machines': build with -ffp-contract=off, or "
          "--fmad=false");
    with_boundaries(
        [&](auto periodic) { wrap_all(space_, discs_, Domain<Real, periodic>(model_.box)); });
    auto const start = totals(space_, discs_, model_, scales_);
    kinetic_initial_ = start.kinetic.value(scales_.energy);
    potential_initial_ = start.potential.value(scales_.energy);
    note_warnings(method.engine);
  }

  void advance(std::int64_t steps) override
  {
    for (std::int64_t k = 0; k < steps; ++k)
      step();
  }

  void start_measuring() override;
  Report report() override;

  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  std::vector<std::string> warnings() const override { return warnings_; }
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  void step()
  {
    ProfilingRegion const region("ricochet::step");
    grid_.sort(space_, discs_);
    resolve_contacts();
    fly(space_, discs_, model_.gravity, dt_);
    bounce_off_walls(space_, discs_, model_, scales_, part_);
    enter<Space>(space_, books_, part_);
    ++steps_;
  }

 public: // nvcc takes device lambdas and launches only from public functions
  void resolve_contacts();
  void look_at_start();

 private:
  /// Calls use(periodic) with a compile-time answer to whether any axis of the box is periodic.
  template <class Use>
  void with_boundaries(Use const& use) const
  {
    if (is_periodic(model_.box))
      use(std::true_type{});
    else
      use(std::false_type{});
  }

  template <bool periodic>
  PairState<Space, Real, periodic> pair_state() const
  {
    auto spare = grid_.spare();
    spare.id = discs_.id;
    return {discs_,         spare,
            grid_.cell(),   grid_.slot_of_id(),
            grid_.cells(),  Domain<Real, periodic>(model_.box),
            model_.box,     diameter_,
            model_.gravity, scales_,
            books_};
  }

  void note_warnings(EngineKind engine);

  static Scales scales_for(Model const& model, std::vector<DiscState> const& initial)
  {
    double kinetic = 0;
    for (auto const& disc : initial)
      kinetic += 0.5 * (disc.vx * disc.vx + disc.vy * disc.vy);
    auto const count = static_cast<double>(initial.size());
    double const energy = kinetic + count * std::fabs(model.gravity) * model.box.height;
    double const momentum = std::sqrt(2 * energy * count);
    return {power_scale(energy), power_scale(momentum), power_scale(momentum * 2 * model.radius)};
  }

  Space space_;
  Model model_;
  double dt_;
  Real diameter_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  CellGrid<Space, Real> grid_;
  PairStep pairs_;
  BooksView<Space> books_, part_;
  Scales scales_;
  double kinetic_initial_ = 0, potential_initial_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t measured_from_ = 0; ///< step at which the measurement of pressure began
  double virial_before_ = 0;       ///< that step's virial
  std::vector<std::string> warnings_;
};

template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::resolve_contacts()
{
  ProfilingRegion const region("ricochet::resolve_contacts");
  with_boundaries([&](auto periodic) {
    std::visit([&](auto const& law) { pairs_.resolve(space_, pair_state<periodic>(), law); }, law_);
  });
}

/// Enters the extremes of the initial state in the books.
template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::look_at_start()
{
  grid_.sort(space_, discs_);
  with_boundaries([&](auto periodic) {
    auto const state = pair_state<periodic>();
    Kokkos::parallel_reduce(
        "ricochet::look_at_start", Kokkos::RangePolicy<Space>(space_, 0, discs_.count()),
        EnterExtremes<Space, Real, periodic>{state, state.neighbours(), Outside(model_)},
        Merge<Books, Space>(part_));
  });
  enter<Space>(space_, books_, part_);
}

template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::note_warnings(EngineKind engine)
{
  if (engine == EngineKind::simultaneous)
    warnings_.push_back("engine simultaneous gains energy wherever discs stay in contact, at any "
                        "step length; it exists to reproduce the original's parallel variant");
  look_at_start();
  space_.fence();
  Books books;
  Kokkos::deep_copy(books, books_);
  auto const percent = [](double share) { return std::to_string(std::lround(100 * share)) + " %"; };
  if (books.max_overlap > 0)
    warnings_.push_back("discs overlap at the start, by up to " + percent(books.max_overlap) +
                        " of a diameter");
  double const packing = packing_fraction(model_, static_cast<std::size_t>(discs_.count()));
  if (packing > 0.9069)
    warnings_.push_back("the discs cover " + percent(packing) +
                        " of the box; without overlaps at most 90.69 % is possible");
  if (books.max_outside > 0)
    warnings_.push_back("discs reach beyond a wall at the start, by up to " +
                        percent(books.max_outside) + " of a diameter");
}

template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::start_measuring()
{
  Books books;
  Kokkos::deep_copy(books, books_);
  measured_from_ = steps_;
  virial_before_ = books.virial.value(scales_.virial);
}

template <class Space, class Real, class PairStep>
Report FixedStep<Space, Real, PairStep>::report()
{
  auto const now = totals(space_, discs_, model_, scales_);
  Books books;
  Kokkos::deep_copy(books, books_);

  Report report;
  report.discs = discs_.count();
  report.steps = steps_;
  report.time = static_cast<double>(steps_) * dt_;
  report.collisions = books.collisions;
  report.separating_hits = books.separating_hits;
  report.wall_hits = books.wall_hits;
  report.executions = pairs_.executions();
  report.max_overlap = books.max_overlap;
  report.max_outside = books.max_outside;
  report.energy.kinetic_initial = kinetic_initial_;
  report.energy.potential_initial = potential_initial_;
  report.energy.kinetic = now.kinetic.value(scales_.energy);
  report.energy.potential = now.potential.value(scales_.energy);
  report.energy.lost_pairs = books.lost_pairs.value(scales_.energy);
  report.energy.lost_walls = books.lost_walls.value(scales_.energy);
  report.energy.numerical = books.numerical.value(scales_.energy) +
                            static_cast<double>(steps_) * static_cast<double>(report.discs) *
                                flight_error<Real>(model_.gravity, dt_);
  report.momentum_x = now.momentum_x.value(scales_.momentum);
  report.momentum_y = now.momentum_y.value(scales_.momentum);
  if (report.discs > 0)
    report.temperature = report.energy.kinetic / static_cast<double>(report.discs);
  double const virial_unit = 2 * static_cast<double>(report.discs) * report.temperature *
                             (static_cast<double>(steps_ - measured_from_) * dt_);
  if (virial_unit > 0)
    report.pressure_z = 1 + (books.virial.value(scales_.virial) - virial_before_) / virial_unit;
  return report;
}

} // namespace ricochet
