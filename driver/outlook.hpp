// What to expect of a scene before it is run: numbers that follow from it, and reasons for doubt.
#pragma once

#include "scene.hpp"

#include <string>
#include <vector>

namespace ricochet::driver {

/// Numbers that follow from a scene, for its initial state.
struct Outlook {
  double packing = 0;     ///< share of the box that discs cover
  double temperature = 0; ///< sum of |v|^2 / 2N
  double momentum_x = 0, momentum_y = 0;
  double fastest =
      0; ///< speed that a disc can have [length/time], after a fall if there is gravity
  double step_in_radii = 0;  ///< way of that disc in a step, in radii
  double step_in_sizes = 0;  ///< q: way of a thermal disc in a step, in diameters
  double collision_rate = 0; ///< of a disc, if the discs are spread evenly; infinite where jammed
  double free_path = 0;      ///< between two of them [length]
  double collisions_a_step = 0; ///< of a disc
};

Outlook outlook(Scene const& scene);

/// What may go wrong though the scene is a valid one: FILE:LINE:COLUMN: warning: problem (why)
/// suggestion, one each.
std::vector<std::string> doubts(Scene const& scene, Outlook const& outlook);

/// What a scene is, and the outlook, in a few lines.
std::string in_words(Scene const& scene, Outlook const& outlook);

/// What a run will take, as measured on this machine.
struct Forecast {
  double memory = 0;       ///< bytes of the host at most
  double file = 0;         ///< bytes of the trajectory; 0 without one
  double seconds = 0;      ///< of stepping, and of handing frames over
  std::int64_t frames = 0; ///< in the trajectory
};

std::string in_words(Forecast const& forecast);

} // namespace ricochet::driver
