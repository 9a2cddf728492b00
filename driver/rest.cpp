#include "rest.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

RestWatch::RestWatch(Scene const& scene)
{
  double const g = std::fabs(scene.model.gravity), r = scene.model.radius;
  double const steps = std::ceil(std::sqrt(r / g) / 2 / scene.method.dt);
  every_ = static_cast<std::int64_t>(std::min(steps, static_cast<double>(most_steps)));
  slow2_ = 2 * g * r / 100;
}

void RestWatch::look(std::vector<DiscState> const& states)
{
  bool const all_slow = std::all_of(states.begin(), states.end(), [&](DiscState const& disc) {
    return disc.vx * disc.vx + disc.vy * disc.vy <= slow2_;
  });
  slow_looks_ = all_slow ? slow_looks_ + 1 : 0;
}

} // namespace ricochet::driver
