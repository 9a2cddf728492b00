// Initial states for measurements: the same numbers on every machine.
#pragma once

#include <ricochet/engine.hpp>
#include <ricochet/model.hpp>

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

namespace ricochet::perf {

/// Counter-based random number in [0, 1): draw `counter` of stream `seed` (SplitMix64).
inline double uniform(std::uint64_t seed, std::uint64_t counter)
{
  std::uint64_t word = seed * 0xd1342543de82ef95u + (counter + 1) * 0x9e3779b97f4a7c15u;
  word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9u;
  word = (word ^ (word >> 27)) * 0x94d049bb133111ebu;
  return static_cast<double>((word ^ (word >> 31)) >> 11) * 0x1p-53;
}

/// A scene and its initial state.
struct Gas {
  Model model;
  std::vector<DiscState> discs;
  double thermal_speed = 0; ///< rms of one velocity component
};

/// `count` discs of radius 3 at packing fraction `packing` (up to 0.7) in a square box, on a square
/// lattice, with ids in random order and random velocities of zero mean.
inline Gas gas(int count, double packing, Contact const& contact, double gravity)
{
  constexpr double pi = 3.14159265358979323846, speed = 100;
  Gas result;
  result.model.contact = contact;
  result.model.gravity = gravity;
  double const r = result.model.radius;
  double const side = std::sqrt(count * pi * r * r / packing);
  result.model.box.width = result.model.box.height = side;

  auto const columns = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(count))));
  double const spacing = side / columns;
  auto const component = [&](int i, int k) {
    // The sum of three uniform numbers of variance 1/12 is near enough to a Gaussian.
    double sum = -1.5;
    for (int j = 0; j < 3; ++j)
      sum += uniform(1, 6 * static_cast<std::uint64_t>(i) + static_cast<std::uint64_t>(3 * k + j));
    return 2 * speed * sum;
  };
  for (int i = 0; i < count; ++i) {
    int const column = i % columns, row = i / columns;
    result.discs.push_back({(column + 0.5) * spacing - side / 2, (row + 0.5) * spacing - side / 2,
                            component(i, 0), component(i, 1)});
  }
  for (int i = count - 1; i > 0; --i) {
    auto const k = static_cast<int>(uniform(2, static_cast<std::uint64_t>(i)) * (i + 1));
    std::swap(result.discs[static_cast<std::size_t>(i)], result.discs[static_cast<std::size_t>(k)]);
  }
  result.thermal_speed = speed;
  return result;
}

/// The same of elastic discs without gravity in a periodic box.
inline Gas elastic_gas(int count, double packing)
{
  Gas result = gas(count, packing, Contact{Law::swap_scale, 1, 1}, 0);
  result.model.box.x = result.model.box.y = Boundary::periodic;
  return result;
}

/// Collisions of a disc per time in a gas.
inline double collision_rate(Gas const& gas)
{
  return ricochet::collision_rate(gas.model, gas.discs.size(),
                                  gas.thermal_speed * gas.thermal_speed);
}

/// A gas between walls whose lattice some collisions of each disc have melted, once for all
/// callers; then it has the contact rule and the gravity asked for.
inline Gas melted_gas(int count, double packing, Contact const& contact, double gravity)
{
  static std::map<std::pair<int, double>, Gas> gases;
  auto const [place, is_new] = gases.try_emplace({count, packing});
  Gas& melted = place->second;
  if (is_new) {
    melted = gas(count, packing, Contact{Law::swap_scale, 1, 1}, 0);
    constexpr double collisions = 5;
    Method method;
    method.engine = EngineKind::events; // no other leaves discs that no engine finds to overlap
    method.dt = collisions / collision_rate(melted);
    auto const simulation = make_engine(melted.model, method, melted.discs);
    simulation->advance(1);
    simulation->states(melted.discs.data());
  }
  Gas result = melted;
  result.model.contact = contact;
  result.model.gravity = gravity;
  return result;
}

} // namespace ricochet::perf
