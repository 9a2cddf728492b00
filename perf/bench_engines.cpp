// Throughput of whole steps, beside a check that they were right: the energy ledger must close.

#include "scenes.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>
#include <benchmark/benchmark.h>

#include <cmath>

namespace {

using namespace ricochet;

/// A gas at q = thermal speed x dt / diameter = 0.1 with gravity and dissipation.
/// Arguments: discs, packing fraction in percent, placement.
void steps(benchmark::State& state, EngineKind engine, Precision precision,
           Execution execution = Execution::automatic)
{
  Contact contact;
  contact.restitution = 0.93;
  contact.friction = 0.98;
  auto const scene = perf::gas(static_cast<int>(state.range(0)),
                               static_cast<double>(state.range(1)) / 100, contact, 9.81);
  Method method;
  method.engine = engine;
  method.precision = precision;
  method.dt = 0.1 * 2 * scene.model.radius / scene.thermal_speed;
  method.placement = static_cast<Placement>(state.range(2));
  method.execution = execution;
  auto const simulation = make_engine(scene.model, method, scene.discs);
  simulation->advance(50); // the lattice melts, and caches warm up
  auto const before = simulation->report();

  std::int64_t const batch = 10;
  for ([[maybe_unused]] auto _ : state) {
    simulation->advance(batch);
    Kokkos::fence();
  }

  auto const after = simulation->report();
  double const tolerance = precision == Precision::double_ ? 1e-12 : 1e-4;
  if (!(std::fabs(after.energy.residual()) <= tolerance * after.energy.initial())) {
    state.SkipWithError("the energy ledger does not close");
    return;
  }
  double const disc_steps = static_cast<double>((after.steps - before.steps) * after.discs);
  state.SetLabel(simulation->backend() + " x" + std::to_string(simulation->threads()));
  state.counters["disc_steps"] = benchmark::Counter(disc_steps, benchmark::Counter::kIsRate);
  state.counters["collisions_per_disc_step"] =
      static_cast<double>(after.collisions - before.collisions) / disc_steps;
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

BENCHMARK_CAPTURE(steps, sweep_double, EngineKind::sweep, Precision::double_)->Apply(sizes);
BENCHMARK_CAPTURE(steps, sweep_in_order_double, EngineKind::sweep, Precision::double_,
                  Execution::in_order)
    ->Apply(sizes);
BENCHMARK_CAPTURE(steps, sweep_single, EngineKind::sweep, Precision::single_)->Apply(sizes);
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
