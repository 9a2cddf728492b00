// What accuracy costs: processor time and error of the pressure of elastic hard discs, for the
// engines, number formats and steps between which a user chooses.
//
//   study_front [DATA [EFFORT]]     DATA: a file that front.gp draws; EFFORT: 1, multiplies times

#include "pressure.hpp"
#include "scenes.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using namespace ricochet;

constexpr int discs = 16384; // as many as the reference has: what a finite box changes cancels
constexpr int blocks = 16;   // of the measured time
constexpr double packings[] = {0.2, 0.5};
constexpr double steps_q[] = {0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005};

/// A fluid in equilibrium, and its units.
struct Fluid {
  perf::Gas gas;
  perf::Pressure reference;
  double time = 0;      ///< in which a thermal disc crosses its diameter
  double collision = 0; ///< mean time between two collisions of a disc
};

/// What a run costs, and how wrong it is.
struct Point {
  double cost = 0;           ///< ns of processor time per disc and Fluid::time; the best block
  double error = 0;          ///< of Z [%]
  double standard_error = 0; ///< of the error, with that of the reference [%]
  double energy_drift = 0;   ///< share by which the energy changed

  /// Nothing but a bound of the error was found.
  bool is_bound() const { return std::fabs(error) < standard_error; }
};

/// Processor time of all threads [ns].
double processor_time()
{
  return 1e9 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Fluid melted(double packing)
{
  Fluid fluid{perf::elastic_gas(discs, packing), perf::pressure_at(packing)};
  auto& gas = fluid.gas;
  Method method;
  method.engine = EngineKind::events;
  method.placement = Placement::serial;
  double const speed = gas.thermal_speed;
  method.dt = 50 / perf::enskog_rate(gas.model, fluid.reference.z, speed * speed);
  auto const simulation = make_engine(gas.model, method, gas.discs);
  simulation->advance(1);
  simulation->states(gas.discs.data());

  double const temperature = simulation->report().temperature;
  gas.thermal_speed = std::sqrt(temperature);
  fluid.time = 2 * gas.model.radius / gas.thermal_speed;
  fluid.collision = 1 / perf::enskog_rate(gas.model, fluid.reference.z, temperature);
  return fluid;
}

/// By what share the energy of elastic discs without gravity changed, which every engine measured
/// here keeps. Throws if it was more than rounding explains or the ledger does not close.
double energy_drift(Report const& report, Precision precision)
{
  double const tolerance = precision == Precision::double_ ? 1e-12 : 1e-4;
  auto const& energy = report.energy;
  double const drift = std::fabs(energy.kinetic / energy.kinetic_initial - 1);
  if (!(std::fabs(energy.residual()) <= tolerance * energy.initial()) || !(drift <= tolerance))
    throw std::runtime_error("energy is not conserved: it changed by a share of " +
                             std::to_string(drift));
  return drift;
}

/// One engine, in one number format, in steps of one length, at work on one fluid.
class Run {
 public:
  /// Steps of `q` (v_th dt / sigma), or the time of a block as the step for `events`.
  Run(Fluid const& fluid, EngineKind engine, Precision precision, double q, double effort)
    : reference_(fluid.reference), precision_(precision)
  {
    // Equal times would spend nearly all on the smallest steps, so these get less, and larger
    // errors.
    double const most_steps = 12500 * effort;
    double const time = (reference_.packing < 0.35 ? 125 : 62.5) * effort;
    if (engine == EngineKind::events)
      q = time / blocks;
    else
      steps_ = std::lround(std::max(1.0, std::min(time / q, most_steps) / blocks));
    disc_time_ = discs * static_cast<double>(steps_) * q;

    Method method;
    method.engine = engine;
    method.precision = precision;
    method.dt = q * fluid.time;
    method.placement = Placement::serial;
    try {
      simulation_ = make_engine(fluid.gas.model, method, fluid.gas.discs);
    } catch (std::invalid_argument const& refusal) {
      std::fprintf(stderr, "study_front: %s\n", refusal.what());
      return;
    }
    // The exact state becomes the engine's own within some collisions.
    simulation_->advance(static_cast<std::int64_t>(std::ceil(10 * fluid.collision / method.dt)));
  }

  void measure_block()
  {
    if (!simulation_)
      return;
    simulation_->start_measuring();
    double const start = processor_time();
    simulation_->advance(steps_);
    Kokkos::fence();
    cost_ = std::min(cost_, (processor_time() - start) / disc_time_);
    z_.enter(*simulation_->report().pressure_z);
  }

  /// Empty if the engine refused the scene.
  std::optional<Point> result() const
  {
    if (!simulation_)
      return {};
    double const ratio = z_.value() / reference_.z;
    double const error = std::hypot(z_.error() / z_.value(), reference_.error / reference_.z);
    return Point{cost_, 100 * (ratio - 1), 100 * ratio * error,
                 energy_drift(simulation_->report(), precision_)};
  }

 private:
  perf::Pressure reference_;
  Precision precision_;
  std::unique_ptr<Engine> simulation_; ///< none if the engine refused the scene
  std::int64_t steps_ = 1;             ///< of a block
  double disc_time_ = 0;               ///< discs times a block's time [Fluid::time]
  double cost_ = std::numeric_limits<double>::infinity();
  perf::Mean z_;
};

/// A row of the table: the runs at all packings.
struct Row {
  EngineKind engine;
  Precision precision;
  double q; ///< 0 for `events`
  std::vector<Run> runs;
};

std::vector<Row> all_rows(double effort)
{
  std::vector<Fluid> fluids;
  for (double const packing : packings)
    fluids.push_back(melted(packing));
  std::vector<Row> rows;
  auto const add = [&](EngineKind engine, Precision precision, double q) {
    rows.push_back({engine, precision, q, {}});
    for (auto const& fluid : fluids)
      rows.back().runs.emplace_back(fluid, engine, precision, q, effort);
  };
  for (auto const engine : {EngineKind::sweep, EngineKind::toi})
    for (auto const precision : {Precision::double_, Precision::single_})
      for (double const q : steps_q)
        add(engine, precision, q);
  for (auto const precision : {Precision::double_, Precision::single_})
    add(EngineKind::events, precision, 0);
  return rows;
}

/// The cells of the table for one packing.
void print(std::optional<Point> const& point)
{
  if (!point) {
    std::printf(" refused | |");
    return;
  }
  std::printf(" %.0f | %+.3f ± %.3f", point->cost, point->error, point->standard_error);
  if (point->is_bound())
    std::printf(" (below %.2f)", std::fabs(point->error) + point->standard_error);
  std::printf(" |");
}

void print(std::vector<Row> const& rows)
{
  std::printf("%d discs; cost in ns of one core per disc and sigma/v_th, the best of %d blocks; "
              "errors of Z in %%\n\n| engine | precision | q |",
              discs, blocks);
  for (double const packing : packings)
    std::printf(" cost, packing %g | error |", packing);
  std::printf("\n|---|---|---|---|---|---|---|\n");
  double drift_double = 0, drift_single = 0;
  for (auto const& row : rows) {
    std::printf("| `%s` | %s |", name(row.engine), name(row.precision));
    if (row.q > 0)
      std::printf(" %g |", row.q);
    else
      std::printf(" exact |");
    double& drift = row.precision == Precision::double_ ? drift_double : drift_single;
    for (auto const& run : row.runs) {
      auto const point = run.result();
      print(point);
      drift = std::max(drift, point ? point->energy_drift : 0);
    }
    std::printf("\n");
  }
  std::printf("\nEnergy changed by a share of at most %.1g in double and %.1g in single.\n",
              drift_double, drift_single);
}

/// A curve for each engine and number format, with two empty lines between them.
void write(std::vector<Row> const& rows, std::FILE* data)
{
  std::fprintf(data,
               "# engine precision q, and for packing 0.2 and 0.5: cost [ns], error of Z [%%], "
               "standard error [%%]");
  Row const* last = nullptr;
  for (auto const& row : rows) {
    if (last && (row.engine != last->engine || row.precision != last->precision))
      std::fprintf(data, "\n\n");
    std::fprintf(data, "\n%s %s %g", name(row.engine), name(row.precision), row.q);
    for (auto const& run : row.runs)
      if (auto const point = run.result())
        std::fprintf(data, " %.6g %.6g %.6g", point->cost, point->error, point->standard_error);
      else
        std::fprintf(data, " ? ? ?");
    last = &row;
  }
  std::fprintf(data, "\n");
}

void study(std::FILE* data, double effort)
{
  auto rows = all_rows(effort);
  // In turns, so that a machine that is slow for a while is so for all of them.
  for (int block = 0; block < blocks; ++block) {
    for (auto& row : rows)
      for (auto& run : row.runs)
        run.measure_block();
    std::fprintf(stderr, "%d of %d blocks\n", block + 1, blocks);
  }
  print(rows);
  if (data)
    write(rows, data);
}

} // namespace

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  double const effort = argc > 2 ? std::atof(argv[2]) : 1;
  if (argc > 3 || !(effort > 0)) {
    std::fprintf(stderr, "usage: study_front [DATA [EFFORT]]\n");
    return 64;
  }
  std::FILE* const data = argc > 1 ? std::fopen(argv[1], "w") : nullptr;
  if (argc > 1 && !data) {
    std::perror(argv[1]);
    return 1;
  }
  try {
    study(data, effort);
  } catch (std::runtime_error const& problem) {
    std::fprintf(stderr, "\nstudy_front: %s\n", problem.what());
    return 1;
  }
  if (data && std::fclose(data) != 0) {
    std::perror(argv[1]);
    return 1;
  }
  return 0;
}
