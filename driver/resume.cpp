#include "resume.hpp"

#include "exit_codes.hpp"
#include "output_file.hpp"
#include "text.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <unistd.h>

namespace ricochet::driver {

namespace {

// The first line in which two texts differ, as a clause.
std::string difference(std::string const& there, std::string const& here)
{
  std::istringstream a(there), b(here);
  std::string line_a, line_b;
  while (line_a == line_b && (a || b)) {
    line_a.clear(), line_b.clear();
    std::getline(a, line_a);
    std::getline(b, line_b);
  }
  return fmt::format("it has {} where this has {}", in_quotes(line_a), in_quotes(line_b));
}

// Whether what stands at the trajectory's path is a trajectory of this run.
void require_own_trajectory(std::string const& path, std::string const& identity)
{
  if (!std::filesystem::exists(path))
    return;
  std::string there;
  try {
    there = TrajectoryReader(path).text("identity");
  } catch (Failure const&) {
    // No trajectory is not ours either.
  }
  if (there != identity)
    throw Failure(Exit::cannot_create,
                  fmt::format("cannot create '{}': it exists already, and is of another run{} "
                              "(--force replaces it)",
                              path, there.empty() ? "" : ": " + difference(there, identity)));
}

// The checkpoint of a trajectory, unless it has a name of its own.
std::string beside(std::string const& trajectory)
{
  return std::filesystem::path(trajectory).replace_extension(".chk.h5").string();
}

// Throws unless the run can go on from `saved`.
void require_own_checkpoint(SavedRun const& saved, std::string const& path,
                            Settings const& settings, std::string const& identity)
{
  if (saved.identity != identity)
    throw Failure(Exit::cannot_create,
                  fmt::format("cannot go on from '{}': it is of another run: {} (--force begins "
                              "anew)",
                              path, difference(saved.identity, identity)));
  if (settings.file && saved.frames == 0)
    throw Failure(Exit::usage,
                  fmt::format("--output: '{}' was made without a trajectory, whose first frames "
                              "would be missing (--force begins anew)",
                              path));
  if (settings.file && std::filesystem::exists(*settings.file))
    if (std::int64_t const frames = TrajectoryReader(*settings.file).frames();
        frames < saved.frames)
      throw Failure(
          Exit::cannot_create,
          fmt::format("cannot go on from '{}': '{}' has {} of the {} frames that it counts "
                      "(--force begins anew)",
                      path, *settings.file, frames, saved.frames));
  if (!settings.file && saved.frames > 0 && saved.summary.empty())
    throw Failure(Exit::usage, fmt::format("'{}' was made with a trajectory of {} frames (add "
                                           "--output to go on with it; --force begins anew)",
                                           path, saved.frames));
}

} // namespace

std::string checkpoint_path(RunOptions const& options, Settings const& settings)
{
  if (settings.checkpoint)
    return *settings.checkpoint;
  bool const names_one = !options.resume.empty() && options.resume != "auto";
  if (names_one)
    return options.resume;
  std::string const asking = !options.resume.empty()  ? "--resume auto"
                             : options.walltime       ? "--max-walltime"
                             : settings.every_seconds ? "checkpoint.every_seconds"
                                                      : "";
  if (asking.empty())
    return "";
  if (!settings.file)
    throw Failure(Exit::usage, fmt::format("{}: needs a checkpoint: add --checkpoint FILE, or "
                                           "--output FILE.h5md, beside which it is kept",
                                           asking));
  return beside(*settings.file);
}

void forget_checkpoint(RunOptions const& options, Settings const& settings)
{
  if (!options.force && options.resume.empty())
    return;
  std::string path = checkpoint_path(options, settings);
  if (path.empty() && settings.file)
    path = beside(*settings.file);
  if (path.empty() || !is_checkpoint(path))
    return;
  for (std::string const& stale : {previous_checkpoint(path), path})
    ::unlink(stale.c_str());
}

std::optional<SavedRun> find_saved(RunOptions const& options, Settings const& settings,
                                   std::string const& identity)
{
  if (options.resume.empty())
    return std::nullopt;
  bool const automatic = options.resume == "auto";
  std::string const path = automatic ? checkpoint_path(options, settings) : options.resume;
  try {
    auto saved = automatic ? find_checkpoint(path) : read_checkpoint(path);
    if (saved) {
      require_own_checkpoint(*saved, path, settings, identity);
      return saved;
    }
    if (settings.file)
      require_own_trajectory(*settings.file, identity);
    for (std::string const& output : {options.final_file, options.json})
      if (!output.empty() && output != "-")
        check_output(output, false);
  } catch (Failure const&) {
    if (!options.force)
      throw;
  }
  return std::nullopt;
}

} // namespace ricochet::driver
