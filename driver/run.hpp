// ricochet run: from a scene to results.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"

#include <cstdint>

namespace ricochet::driver {

/// Runs the command. Throws Failure.
Exit run(RunOptions const& options);

/// Frames of a run: steps 0, every, 2 every... and the last.
std::int64_t planned_frames(std::int64_t steps, std::int64_t every);

/// Whether a trajectory is compressed that leaves this to the program: only if compression, which
/// costs about as much as ten steps a frame on one core, hides behind the stepping.
bool worth_compressing(std::int64_t discs, std::int64_t frames, std::int64_t every);

} // namespace ricochet::driver
