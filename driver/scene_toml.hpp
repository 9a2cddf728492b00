// Scenes in TOML: the settings of a scene, by name, in tables.
#pragma once

#include "settings.hpp"

#include <string>

namespace ricochet::driver {

/// Reads `text`, which came from `path`; what is wrong goes to `problems`. Files that it names are
/// relative to its folder.
Settings parse_scene(std::string const& path, std::string const& text, ProblemList& problems);

/// Reads the file `path`. Throws Failure if it cannot be read.
Settings read_scene_toml(std::string const& path, ProblemList& problems);

} // namespace ricochet::driver
