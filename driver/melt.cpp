#include "melt.hpp"

#include "random.hpp"

#include <fmt/format.h>

namespace ricochet::driver {

bool is_to_be_melted(Settings const& settings, Model const& model)
{
  if (settings.arrangement != Arrangement::random)
    return false;
  double const packing = settings.packing
                             ? *settings.packing
                             : packing_fraction(model, static_cast<std::size_t>(*settings.count));
  return packing > densest_placed;
}

void melt(Scene& scene)
{
  if (!is_to_be_melted(scene.settings, scene.model) || scene.discs.empty())
    return;
  // Elastic discs of thermal speed 1 fly ten diameters: 70 collisions each at packing 0.5, 210 at
  // 0.7, where they diffuse slowest.
  Model model = scene.model;
  model.gravity = 0;
  model.contact = {Law::restitution, 1, 1};
  Method method;
  method.engine = EngineKind::events;
  method.dt = 10 * 2 * model.radius;
  method.placement = scene.method.placement;
  constexpr std::uint64_t of_melting = std::uint64_t{3} << 32; // beside those of generate.cpp
  auto const seed = static_cast<std::uint64_t>(*scene.settings.seed);
  std::vector<DiscState> discs = scene.discs;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    Random random(seed, of_melting + i);
    discs[i].vx = random.normal();
    discs[i].vy = random.normal();
  }
  try {
    auto const engine = make_engine(model, method, discs);
    engine->advance(1);
    engine->states(discs.data());
  } catch (LastingContact const& contact) { // no room to move
    ProblemList problems;
    problems.add(blame(scene.settings, scene.settings.count ? "discs.generate.count"
                                                            : "discs.generate.packing_fraction"),
                 fmt::format("the discs do not melt ({})", contact.what()),
                 "choose arrangement = \"triangular\"");
    problems.throw_if_any();
  }
  for (std::size_t i = 0; i < discs.size(); ++i) {
    scene.discs[i].x = discs[i].x;
    scene.discs[i].y = discs[i].y;
  }
}

} // namespace ricochet::driver
