// Initial states from a frame of a trajectory.
#pragma once

#include "problem_list.hpp"

#include "ricochet/model.hpp"

#include <string>
#include <vector>

namespace ricochet::driver {

/// The file of initial states that FILE.csv, FILE.h5md or FILE.h5md@FRAME names.
std::string file_of_states(std::string const& states);

/// Whether that is a trajectory, by its name.
bool is_trajectory(std::string const& states);

/// Reads the states in a frame, counted from 0, of a trajectory; the last if none is named. What is
/// wrong with them stands at `origin`. Throws Failure if the trajectory cannot be read.
std::vector<DiscState> read_frame(std::string const& states, Origin const& origin,
                                  ProblemList& problems);

} // namespace ricochet::driver
