// The pressure of elastic hard discs by engine `events`, from dilute to freezing, beside that of
// another program: does the exact engine sample the right states?
//
//   study_z [COLLISIONS [DISCS]]       collisions of each disc, 1000, and 4 and 40 times that near
//                                      freezing; discs, 16384

#include "pressure.hpp"
#include "scenes.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>

namespace {

using namespace ricochet;

/// Prints a line of the table. Returns whether energy was conserved.
bool measure(perf::Pressure const& reference, double collisions, int discs)
{
  constexpr int blocks = 20;
  auto const start = std::chrono::steady_clock::now();
  auto const gas = perf::elastic_gas(discs, reference.packing);
  Method method;
  method.engine = EngineKind::events;
  double const temperature = gas.thermal_speed * gas.thermal_speed;
  // All change takes long near freezing.
  bool const is_near_freezing = reference.packing > 0.67, freezes_almost = reference.packing > 0.69;
  double const measured = (freezes_almost ? 40 : is_near_freezing ? 4 : 1) * collisions;
  method.dt = measured / blocks / perf::enskog_rate(gas.model, reference.z, temperature);
  auto const simulation = make_engine(gas.model, method, gas.discs);

  double const melting = is_near_freezing ? 4000 : 100; // collisions from the lattice to the fluid
  simulation->advance(static_cast<std::int64_t>(std::ceil(melting / measured * blocks)));
  perf::Mean z, ratio;
  auto before = simulation->report();
  auto const first = before.collisions;
  for (int block = 0; block < blocks; ++block) {
    simulation->start_measuring();
    simulation->advance(1);
    auto const after = simulation->report();
    double const rate = 2.0 * static_cast<double>(after.collisions - before.collisions) /
                        (static_cast<double>(after.discs) * method.dt);
    z.enter(*after.pressure_z);
    ratio.enter(rate / perf::enskog_rate(gas.model, *after.pressure_z, after.temperature));
    before = after;
  }
  std::chrono::duration<double> const spent = std::chrono::steady_clock::now() - start;
  std::printf("%7.3f  %9.5f +- %.5f  %9.5f +- %.5f  %+7.3f  %8.5f +- %.5f  %11.4g  %7.1f\n",
              reference.packing, z.value(), z.error(), reference.z, reference.error,
              100 * (z.value() / reference.z - 1), ratio.value(), ratio.error(),
              static_cast<double>(before.collisions - first), spent.count());
  std::fflush(stdout);
  return std::fabs(before.energy.residual()) <= 1e-12 * before.energy.initial() &&
         std::fabs(before.energy.kinetic / before.energy.kinetic_initial - 1) <= 1e-12;
}

} // namespace

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  double const collisions = argc > 1 ? std::atof(argv[1]) : 1000;
  int const discs = argc > 2 ? std::atoi(argv[2]) : 16384;
  if (argc > 3 || !(collisions > 0) || discs < 2) {
    std::fprintf(stderr, "usage: study_z [COLLISIONS [DISCS]]\n");
    return 64;
  }
  std::printf("%d discs in a periodic box, %g collisions of each in 20 blocks, 4 and 40 times "
              "that near freezing\n\n",
              discs, collisions);
  std::printf("%7s  %-20s  %-20s  %7s  %-19s  %11s  %7s\n", "packing", "Z measured", "Z reference",
              "diff %", "rate / Enskog's", "collisions", "seconds");
  for (auto const& reference : perf::pressures)
    if (!measure(reference, collisions, discs)) {
      std::fprintf(stderr, "study_z: energy is not conserved at packing %g\n", reference.packing);
      return 1;
    }
  return 0;
}
