// A scene as it will be run: the files and the options that override them, checked as a whole.
#pragma once

#include "command_line.hpp"
#include "config.hpp"

#include "ricochet/engine.hpp"

#include <cstdint>
#include <optional>
#include <vector>

namespace ricochet::driver {

struct Scene {
  Config config;
  Model model;
  Method method;
  std::int64_t steps = 0;
  std::int64_t every = 1; ///< steps from frame to frame
  std::vector<DiscState> discs;
};

/// Reads the files that `options` names. Throws Failure with everything that is wrong with them.
Scene read_scene(RunOptions const& options);

/// How many steps of `dt` make up `time`; nothing if that is not a whole number, apart from
/// rounding.
std::optional<std::int64_t> whole_steps(double time, double dt);

} // namespace ricochet::driver
