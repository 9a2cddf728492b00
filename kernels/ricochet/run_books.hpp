// The books of a run from its start, and the report that is made of them.
#pragma once

#include "ricochet/books.hpp"
#include "ricochet/diagnostics.hpp"
#include "ricochet/engine.hpp"

#include <cmath>

namespace ricochet {

/// What an engine keeps of its run besides the state: how it began, what happened since, and how
/// many steps that was.
template <class Space>
class RunBooks {
 public:
  RunBooks(Model const& model, double dt, std::vector<DiscState> const& initial)
    : model_(model), dt_(dt), scales_(scales_for(model, initial)), books_("ricochet::books")
  {
  }

  /// Notes the energy that the run begins with.
  template <class Real>
  void begin(Space const& space, Discs<Space, Real> const& discs)
  {
    auto const start = totals(space, discs, model_, scales_);
    kinetic_initial_ = start.kinetic.value(scales_.energy);
    potential_initial_ = start.potential.value(scales_.energy);
  }

  Scales const& scales() const { return scales_; }

  /// On the device, for kernels to enter what happens.
  BooksView<Space> const& view() const { return books_; }

  /// What they have entered so far; waits for them.
  Books entries(Space const& space) const { return value_after(space, books_); }

  void count_steps(std::int64_t steps) { steps_ += steps; }
  std::int64_t steps() const { return steps_; }
  double time() const { return static_cast<double>(steps_) * dt_; }

  /// Begins the measurement of pressure anew.
  void start_measuring(Space const& space)
  {
    measured_from_ = steps_;
    virial_before_ = entries(space).virial.value(scales_.virial);
  }

  /// For checkpoints; the rest follows from the scene.
  template <class Visit>
  void visit_numbers(Space const& space, Visit const& visit)
  {
    Books books = entries(space);
    ricochet::visit_numbers(books, visit);
    Kokkos::deep_copy(space, books_, books);
    space.fence();
    visit("steps", steps_);
    visit("measured_from", measured_from_);
    visit("virial_before", virial_before_);
  }

  /// The report of a run that has come to the state `discs`.
  template <class Real>
  Report report(Space const& space, Discs<Space, Real> const& discs) const
  {
    auto const now = totals(space, discs, model_, scales_);
    Books const books = entries(space);

    Report report;
    report.discs = discs.count();
    report.steps = steps_;
    report.time = time();
    report.collisions = books.collisions;
    report.separating_hits = books.separating_hits;
    report.wall_hits = books.wall_hits;
    report.max_overlap = books.max_overlap;
    report.max_outside = books.max_outside;
    report.energy.kinetic_initial = kinetic_initial_;
    report.energy.potential_initial = potential_initial_;
    report.energy.kinetic = now.kinetic.value(scales_.energy);
    report.energy.potential = now.potential.value(scales_.energy);
    report.energy.lost_pairs = books.lost_pairs.value(scales_.energy);
    report.energy.lost_walls = books.lost_walls.value(scales_.energy);
    report.energy.numerical = books.numerical.value(scales_.energy);
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

 private:
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

  Model model_;
  double dt_;
  Scales scales_;
  BooksView<Space> books_;
  double kinetic_initial_ = 0, potential_initial_ = 0;
  std::int64_t steps_ = 0;
  std::int64_t measured_from_ = 0; ///< step at which the measurement of pressure began
  double virial_before_ = 0;       ///< that step's virial
};

} // namespace ricochet
