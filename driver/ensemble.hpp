// ricochet ensemble: many runs of one scene that differ in a few settings, in one process.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"

namespace ricochet::driver {

/// Runs the command: every member gives the results of the run of its own with the same settings. A
/// member that fails leaves the others alone. Returns Exit::stopped if a member can go on later,
/// else what the first member that failed would have returned. Throws Failure if nothing was begun.
Exit ensemble(EnsembleOptions const& options);

} // namespace ricochet::driver
