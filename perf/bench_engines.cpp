// Throughput of whole steps, beside a check that they were right: the energy ledger must close, and
// elastic discs keep their energy.

#include "scenes.hpp"
#include "support/event_reference.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>
#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <utility>

namespace {

using namespace ricochet;

/// A melted gas with gravity and dissipation, at q = thermal speed x dt / diameter when it begins.
/// It cools and falls, so every batch begins where the first did; a batch is the time in which a
/// disc at the thermal speed flies its diameter.
/// Arguments: discs, packing fraction in percent, placement.
void steps(benchmark::State& state, EngineKind engine, Precision precision, double q = 0.1,
           Execution execution = Execution::automatic)
{
  Contact contact;
  contact.restitution = 0.93;
  contact.friction = 0.98;
  auto const scene = perf::melted_gas(static_cast<int>(state.range(0)),
                                      static_cast<double>(state.range(1)) / 100, contact, 9.81);
  Method method;
  method.engine = engine;
  method.precision = precision;
  method.dt = q * 2 * scene.model.radius / scene.thermal_speed;
  method.placement = static_cast<Placement>(state.range(2));
  method.execution = execution;
  auto const simulation = make_engine(scene.model, method, scene.discs);
  auto const start = simulation->checkpoint();

  std::int64_t const batch = std::lround(1 / q);
  for ([[maybe_unused]] auto _ : state) {
    state.PauseTiming();
    simulation->restore(start);
    state.ResumeTiming();
    simulation->advance(batch);
    Kokkos::fence();
  }

  auto const after = simulation->report();
  double const tolerance = precision == Precision::double_ ? 1e-12 : 1e-4;
  if (!(std::fabs(after.energy.residual()) <= tolerance * after.energy.initial())) {
    state.SkipWithError("the energy ledger does not close");
    return;
  }
  double const disc_steps = static_cast<double>(after.steps * after.discs);
  state.SetLabel(simulation->backend() + " x" + std::to_string(simulation->threads()));
  state.counters["disc_steps"] =
      benchmark::Counter(disc_steps, benchmark::Counter::kIsIterationInvariantRate);
  state.counters["collisions_per_disc_step"] = static_cast<double>(after.collisions) / disc_steps;
}

void sizes(benchmark::internal::Benchmark* benchmark)
{
  benchmark->ArgNames({"discs", "packing_percent", "placement"})->UseRealTime();
  for (auto const placement : {Placement::serial, Placement::parallel}) {
    for (int const packing : {5, 20, 50})
      benchmark->Args({100000, packing, static_cast<int>(placement)});
    for (int const count : {2000, 10000, 1000000})
      benchmark->Args({count, 20, static_cast<int>(placement)});
  }
}

constexpr int rounds = 4; ///< of about one collision of each disc

/// An elastic periodic gas, and the time in which each disc collides about once.
struct Fluid {
  perf::Gas gas;
  double round = 0;
};

Method exact(double dt)
{
  Method method;
  method.engine = EngineKind::events;
  method.dt = dt;
  return method;
}

/// The gas of a benchmark, whose lattice 20 collisions of each disc have melted. Made once.
Fluid const& fluid(benchmark::State const& state)
{
  static std::map<std::pair<std::int64_t, std::int64_t>, Fluid> fluids;
  auto const [place, is_new] = fluids.try_emplace({state.range(0), state.range(1)});
  Fluid& fluid = place->second;
  if (is_new) {
    double const packing = static_cast<double>(state.range(1)) / 100;
    fluid.gas = perf::elastic_gas(static_cast<int>(state.range(0)), packing);
    fluid.round = 1 / perf::collision_rate(fluid.gas);
    auto const simulation = make_engine(fluid.gas.model, exact(fluid.round), fluid.gas.discs);
    simulation->advance(20);
    simulation->states(fluid.gas.discs.data());
  }
  return fluid;
}

void set_collisions(benchmark::State& state, std::int64_t collisions)
{
  auto const count = static_cast<double>(collisions);
  state.counters["collisions"] = benchmark::Counter(count, benchmark::Counter::kIsRate);
  state.counters["collisions_per_disc"] = 2 * count / static_cast<double>(state.range(0));
}

/// Arguments: discs, packing fraction in percent, placement.
void collisions(benchmark::State& state)
{
  Fluid const& start = fluid(state);
  Method method = exact(start.round);
  method.placement = static_cast<Placement>(state.range(2));
  auto const simulation = make_engine(start.gas.model, method, start.gas.discs);
  for ([[maybe_unused]] auto _ : state) {
    simulation->advance(1);
    Kokkos::fence();
  }
  auto const report = simulation->report();
  if (!(std::fabs(report.energy.kinetic / report.energy.kinetic_initial - 1) <= 1e-12)) {
    state.SkipWithError("energy is not conserved");
    return;
  }
  state.SetLabel(simulation->backend() + " x" + std::to_string(simulation->threads()));
  set_collisions(state, report.collisions);
}

double kinetic(std::vector<reference::Disc> const& discs)
{
  double sum = 0;
  for (auto const& disc : discs)
    sum += 0.5 * (disc.vx * disc.vx + disc.vy * disc.vy);
  return sum;
}

/// The same gas and time by the serial event-driven program that the tests compare `events` with.
void collisions_of_reference(benchmark::State& state)
{
  Fluid const& start = fluid(state);
  Model const& model = start.gas.model;
  reference::Scene scene{model.box.width, model.box.height, model.radius};
  scene.periodic_x = scene.periodic_y = true;
  std::vector<reference::Disc> discs;
  for (auto const& disc : start.gas.discs)
    discs.push_back({disc.x, disc.y, disc.vx, disc.vy});
  reference::EventDriven simulation(scene, discs);
  int round = 0;
  for ([[maybe_unused]] auto _ : state)
    simulation.advance(++round * start.round);
  if (!(std::fabs(kinetic(simulation.states()) / kinetic(discs) - 1) <= 1e-12)) {
    state.SkipWithError("energy is not conserved");
    return;
  }
  set_collisions(state, simulation.pair_events());
}

void fluids(benchmark::internal::Benchmark* benchmark, std::vector<Placement> const& placements)
{
  benchmark->ArgNames({"discs", "packing_percent", "placement"})->UseRealTime()->Iterations(rounds);
  for (auto const placement : placements) {
    for (int const packing : {5, 20, 50, 70})
      benchmark->Args({100000, packing, static_cast<int>(placement)});
    benchmark->Args({1000000, 50, static_cast<int>(placement)});
  }
}

BENCHMARK(collisions)->Name("collisions/events_double")->Apply([](auto* benchmark) {
  fluids(benchmark, {Placement::serial, Placement::parallel});
});
BENCHMARK(collisions_of_reference)->Name("collisions/reference_double")->Apply([](auto* benchmark) {
  fluids(benchmark, {Placement::serial});
});

BENCHMARK_CAPTURE(steps, sweep_double, EngineKind::sweep, Precision::double_)->Apply(sizes);
BENCHMARK_CAPTURE(steps, sweep_in_order_double, EngineKind::sweep, Precision::double_, 0.1,
                  Execution::in_order)
    ->Apply(sizes);
BENCHMARK_CAPTURE(steps, sweep_single, EngineKind::sweep, Precision::single_)->Apply(sizes);
BENCHMARK_CAPTURE(steps, toi_double, EngineKind::toi, Precision::double_)->Apply(sizes);
BENCHMARK_CAPTURE(steps, toi_double_q_0_02, EngineKind::toi, Precision::double_, 0.02)
    ->Apply(sizes);
BENCHMARK_CAPTURE(steps, toi_single_q_0_02, EngineKind::toi, Precision::single_, 0.02)
    ->Apply(sizes);
BENCHMARK_CAPTURE(steps, simultaneous_double, EngineKind::simultaneous, Precision::double_)
    ->Apply(sizes);

} // namespace

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv))
    return 64;
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
