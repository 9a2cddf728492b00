// ricochet render: pictures of a trajectory or a scene.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"

#include <cstdint>
#include <vector>

namespace ricochet::driver {

class FrameSource;

/// The frames that are shown, in order: all, or what the options ask for. Throws
/// Failure(Exit::usage).
std::vector<std::int64_t> chosen_frames(RenderOptions const& options, FrameSource const& source);

/// Name of picture `number` of a series: OUT_000007.png for OUT.png.
std::string series_name(std::string const& path, std::int64_t number);

/// Runs the command. Throws Failure.
Exit render(RenderOptions const& options);

} // namespace ricochet::driver
