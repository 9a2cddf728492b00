// Initial states made from a few numbers, and ricochet generate, which writes them.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"
#include "settings.hpp"

#include <vector>

namespace ricochet::driver {

/// The discs that discs.generate asks for: the same on every machine. Nothing overlaps. Random
/// places too dense for that are still a lattice, see melt.hpp. What cannot be had goes to
/// `problems`.
std::vector<DiscState> generate_discs(Settings const& settings, Model const& model,
                                      ProblemList& problems);

/// Runs the command. Throws Failure.
Exit generate(GenerateOptions const& options);

} // namespace ricochet::driver
