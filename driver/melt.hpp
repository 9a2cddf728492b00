// Random places beyond the packing at which discs can be placed one by one: a lattice that engine
// events has melted.
#pragma once

#include "scene.hpp"

namespace ricochet::driver {

/// Densest packing at which discs are placed one by one, which comes to a stop at 0.547.
constexpr double densest_placed = 0.5;

/// Densest packing of random places: beyond, discs order by themselves.
constexpr double densest_random = 0.7;

/// True if generated discs with these settings begin as a lattice that is still to be melted.
bool is_to_be_melted(Settings const& settings, Model const& model);

/// Melts the lattice of such a scene and leaves any other as it is. Velocities stay. The same on
/// every machine, for the engine uses + - * / and square roots only. Needs Kokkos. Throws Failure.
void melt(Scene& scene);

} // namespace ricochet::driver
