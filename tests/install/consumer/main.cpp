#include <Kokkos_Core.hpp>
#include <cstdio>
#include <ricochet/engine.hpp>

int main(int argc, char* argv[])
{
  Kokkos::ScopeGuard kokkos(argc, argv);
  auto engine = ricochet::make_engine({}, {}, {{-100, 0, 50, 0}, {100, 1, -50, 0}});
  engine->advance(450);
  std::printf("energy after 10 time units: %.6f\n", engine->report().energy.kinetic);
}
