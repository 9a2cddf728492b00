// ricochet validate: all that is wrong with a scene, and what to expect of it.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"

namespace ricochet::driver {

/// Runs the command. Throws Failure with the problems of the scene.
Exit validate(ValidateOptions const& options);

} // namespace ricochet::driver
