// CONFIG.csv: the settings of a scene in the original's form, one line of key=value,key=value.
#pragma once

#include "settings.hpp"

#include <string>

namespace ricochet::driver {

/// Reads `text`, which came from `path`; what is wrong goes to `problems`. Walls stand at the
/// integers +-(width div 2) and +-(height div 2), as in the original.
Settings parse_config(std::string const& path, std::string const& text, ProblemList& problems);

/// Reads the file `path`. Throws Failure if it cannot be read.
Settings read_config(std::string const& path, ProblemList& problems);

/// The settings as the text of a CONFIG.csv, as far as the original knows such settings. Those that
/// it cannot have go to `problems`.
std::string as_config(Settings const& settings, ProblemList& problems);

} // namespace ricochet::driver
