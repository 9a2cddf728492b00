// Final states as a STATES.csv that reads back to the same bits.
#pragma once

#include "output_file.hpp"

#include "ricochet/model.hpp"

#include <vector>

namespace ricochet::driver {

/// Writes one line x,y,vx,vy a disc, in the shortest decimals that read back as the same numbers.
void write_states(OutputFile& file, std::vector<DiscState> const& discs);

} // namespace ricochet::driver
