// Checkpoints: files from which a run goes on as if it had never stopped.
#pragma once

#include "ricochet/engine.hpp"

#include <cstdint>
#include <optional>
#include <string>

namespace ricochet::driver {

/// A run as its checkpoint keeps it.
struct SavedRun {
  std::string version;         ///< of the program
  std::string identity;        ///< what is simulated, in words
  std::int64_t frames = 0;     ///< that the trajectory has; 0 if there is none
  double wall_seconds = 0;     ///< of stepping
  std::int64_t slow_looks = 0; ///< of RestWatch
  std::string summary;         ///< of a run that is finished, in words; empty before
  std::string summary_json;    ///< the same for programs
  Checkpoint engine;

  std::int64_t step() const { return engine.integers.at("steps"); }
};

/// Where the checkpoint that `path` replaced is kept.
std::string previous_checkpoint(std::string const& path);

/// Puts a checkpoint at `path`: whole, on the disk, and with the one before it kept, whenever the
/// program or the machine is stopped. Throws Failure(Exit::io_error); then `path` is as it was.
void write_checkpoint(std::string const& path, SavedRun const& run);

/// True if the file at `path` is a checkpoint, perhaps a damaged one.
bool is_checkpoint(std::string const& path);

/// Reads the checkpoint at `path` and verifies its checksum. Throws Failure: Exit::no_input if
/// there is none, Exit::io_error if it is damaged, Exit::bad_data if it is another version's.
SavedRun read_checkpoint(std::string const& path);

/// The checkpoint at `path`, or the one before it where that is missing or damaged, about which
/// stderr is told; nothing if there is neither. Throws Failure if it is another version's.
std::optional<SavedRun> find_checkpoint(std::string const& path);

} // namespace ricochet::driver
