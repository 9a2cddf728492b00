// How a run begins: at its first step, or where a checkpoint of it was made.
#pragma once

#include "checkpoint_file.hpp"
#include "command_line.hpp"

#include <optional>
#include <string>

namespace ricochet::driver {

/// Where the run keeps its checkpoint: the file that is named or, if the options ask for one
/// without naming it, one beside the trajectory; "" if it keeps none. Throws Failure(Exit::usage).
std::string checkpoint_path(RunOptions const& options, Settings const& settings);

/// The checkpoint to go on from; nothing if the run begins at its first step, and may replace what
/// outputs there are. Throws Failure where neither can be: the outputs are those of another run.
std::optional<SavedRun> find_saved(RunOptions const& options, Settings const& settings,
                                   std::string const& identity);

/// Removes the checkpoints of what a run that begins replaces, if it may: nobody goes on from them
/// with its trajectory.
void forget_checkpoint(RunOptions const& options, Settings const& settings);

} // namespace ricochet::driver
