// Initial states for the tests. Everything is made with + - * / from counter-based random numbers,
// so a scene has the same bits on every machine.
#pragma once

#include "ricochet/model.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace ricochet::test {

/// A model, a step and an initial state.
struct Scene {
  Model model;
  double dt = 1.0 / 45;
  std::vector<DiscState> discs;
};

/// How ids are given to positions. Ids are semantics: `sweep` resolves pairs in id order.
enum class Ids { shuffled, row_major, reversed };

/// The model of a test: radius 1, a box of `width` x `height`.
Model make_model(double width, double height, double gravity, Contact contact,
                 Boundary x = Boundary::walls, Boundary y = Boundary::walls);

/// A scene of its parts, with walls all around.
Scene scene_of(double width, double height, double gravity, Contact const& contact,
               std::vector<DiscState> discs, double dt);

/// Discs that engines for separate discs must refuse in a box of 40 x 40: coincident, overlapping,
/// beyond a wall.
std::vector<std::vector<DiscState>> const& inseparate_discs();

/// `count` discs uniformly anywhere in the box, so that they overlap each other and the walls;
/// velocity components uniform in +-`speed`.
std::vector<DiscState> random_discs(Model const& model, std::size_t count, double speed, Ids ids,
                                    std::uint64_t seed);

/// `count` discs on a square lattice that fills the box, without overlap where there is room,
/// ids row by row from below; velocity components uniform in +-`speed`.
std::vector<DiscState> lattice_discs(Model const& model, std::size_t count, double speed,
                                     std::uint64_t seed);

/// `count` discs near the places of a triangular lattice that fills the box, nowhere overlapping,
/// ids in random order; velocity components uniform in +-`speed`. There must be room: packing up to
/// 0.85 or so in a box of many discs.
std::vector<DiscState> separate_discs(Model const& model, std::size_t count, double speed,
                                      std::uint64_t seed);

/// Discs of radius 1/2, so that lengths are in diameters, with temperature 1 and no total momentum.
/// Velocity components are sums of twelve uniform numbers, almost Gaussian. It
/// takes square roots.
Scene thermal_gas(std::size_t count, double packing, double gravity, Contact const& contact,
                  Boundary x, Boundary y);

/// Discs in another order: the k-th of the result is the `order[k]`-th of `discs`.
std::vector<DiscState> reordered(std::vector<DiscState> const& discs,
                                 std::vector<std::size_t> const& order);

/// A random order of 0...count-1.
std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed);

/// Height of a box `aspect` times as wide as high in which `count` discs of radius 1 take the share
/// `packing` of the area, by bisection (no square root).
double height_for(std::size_t count, double packing, double aspect);

char const* name(Ids ids);
char const* name(Boundary boundary);

} // namespace ricochet::test
