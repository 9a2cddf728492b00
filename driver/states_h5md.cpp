#include "states_h5md.hpp"

#include "text.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>

#include <cstddef>

namespace ricochet::driver {

namespace {

constexpr char const ending[] = ".h5md";

// Where the name of the file ends.
std::size_t end_of_file_name(std::string const& states)
{
  std::size_t const at = states.rfind(std::string(ending) + "@");
  return at == std::string::npos ? states.size() : at + sizeof ending - 1;
}

} // namespace

std::string file_of_states(std::string const& states)
{
  return states.substr(0, end_of_file_name(states));
}

bool is_trajectory(std::string const& states)
{
  std::string const file = file_of_states(states);
  std::size_t const length = sizeof ending - 1;
  return file.size() > length && file.compare(file.size() - length, length, ending) == 0;
}

std::vector<DiscState> read_frame(std::string const& states, Origin const& origin,
                                  ProblemList& problems)
{
  std::string const path = file_of_states(states);
  TrajectoryReader const file(path);
  std::int64_t frame = file.frames() - 1;
  if (path.size() < states.size()) {
    std::string const word = states.substr(path.size() + 1);
    NumberError const error = parse_integer(word, frame);
    if (error != NumberError::none || frame < 0)
      frame = file.frames();
  }
  if (frame < 0 || frame >= file.frames()) {
    problems.add(origin, fmt::format("'{}' has {} frames (allowed: {}@0 to {}@{}; without @ it is "
                                     "the last)",
                                     path, file.frames(), path, path, file.frames() - 1));
    return {};
  }
  if (!file.has("position") || !file.has("velocity")) {
    problems.add(origin, fmt::format("'{}' has no velocities (a run cannot start without)", path));
    return {};
  }
  std::vector<DiscState> discs;
  file.read_states(frame, discs);
  return discs;
}

} // namespace ricochet::driver
