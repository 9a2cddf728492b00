// Results as JSON. Numbers that are not finite become null.
#pragma once

#include "info.hpp"
#include "summary.hpp"

#include <string>

namespace ricochet::driver {

std::string as_json(Summary const& summary);
std::string as_json(TrajectoryInfo const& info);
std::string as_json(std::string const& file, SavedRun const& run);

} // namespace ricochet::driver
