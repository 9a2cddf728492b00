// ricochet info: what is in a trajectory or a checkpoint.
#pragma once

#include "checkpoint_file.hpp"
#include "command_line.hpp"
#include "exit_codes.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ricochet::driver {

/// What can be told about a trajectory without reading its frames.
struct TrajectoryInfo {
  struct Field {
    std::string name;
    bool single_precision = false;
    bool compressed = false;
  };
  struct Range {
    double first = 0, last = 0;
  };

  std::string file;
  std::uint64_t bytes = 0;
  std::string creator;                ///< name and version
  std::string engine, law, precision; ///< empty where the file does not say
  std::string command_line, provenance;
  std::int64_t frames = 0, discs = 0;
  std::optional<std::int64_t> first_step, last_step; ///< empty without frames
  std::optional<std::int64_t> planned_steps;         ///< of the run
  std::optional<Range> time;
  std::vector<Field> fields;
  std::vector<std::string> boundary;
  std::vector<std::pair<std::string, double>> parameters;
  std::optional<Range> energy; ///< kinetic and potential
  std::vector<std::pair<std::string, Range>> observables;
};

TrajectoryInfo describe(std::string const& path);

/// False if the run that wrote it did not reach its end.
bool is_complete(TrajectoryInfo const& info);

/// The description for people.
std::string in_words(TrajectoryInfo const& info);

/// The same about a checkpoint.
std::string in_words(std::string const& file, SavedRun const& run);

/// Runs the command.
Exit info(InfoOptions const& options);

} // namespace ricochet::driver
