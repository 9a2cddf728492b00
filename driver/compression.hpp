// Whether to compress a trajectory, where that is left to the program.
#pragma once

#include "trajectory_file.hpp"

#include <vector>

namespace ricochet::driver {

/// True if the file is so large that compressing it is worth any trouble.
bool is_large(TrajectoryHeader const& header);

/// Seconds that compressing a frame takes on one core, as measured with these discs.
double seconds_to_deflate(TrajectoryHeader const& header, std::vector<DiscState> const& discs);

/// True if a writer that needs `deflating` seconds a frame keeps up with frames that are `stepping`
/// seconds apart, and takes no more than a tenth of a core from the steps where none is idle.
bool keeps_up(double deflating, double stepping);

} // namespace ricochet::driver
