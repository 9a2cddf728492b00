// ricochet plot: what happened in a trajectory, as curves.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"
#include "pictures/statistics.hpp"

#include <string>
#include <vector>

namespace ricochet::driver {

/// What gnuplot is told to draw the tables into the file `place`, a PNG or SVG as `name` is called.
std::string gnuplot_script(std::vector<Table> const& tables, std::string const& name,
                           std::string const& place);

/// Runs the command. Throws Failure.
Exit plot(PlotOptions const& options);

} // namespace ricochet::driver
