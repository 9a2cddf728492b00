// ricochet run: from a scene to results.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"
#include "frame_writer.hpp"
#include "outlook.hpp"
#include "output_lock.hpp"
#include "pictures/viewer.hpp"
#include "rest.hpp"
#include "resume.hpp"
#include "scene.hpp"
#include "stop_request.hpp"
#include "summary.hpp"
#include "trajectory_file.hpp"

#include "ricochet/engine.hpp"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// Runs the command. Throws Failure.
Exit run(RunOptions const& options);

/// The files that a run writes, as far as it writes them: "" or "-" is none.
std::vector<std::string> outputs_of(RunOptions const& options, Settings const& settings);

/// Throws Failure if the run cannot make its outputs.
void check_run(RunOptions const& options, Settings const& settings);

/// Keeps other runs from these outputs. Throws Failure.
std::vector<OutputLock> lock_outputs(std::vector<std::string> const& outputs);

/// A file in the folder of the checkpoint stops a run.
std::string stop_file(RunOptions const& options, Settings const& settings);

/// The results of a run that is finished, or broken.
struct RunResult {
  std::string json;                 ///< the summary
  std::vector<std::string> outputs; ///< a phrase for every file written
};

/// A run in progress, with its outputs.
class Run {
 public:
  /// `options` must outlive it.
  Run(RunOptions const& options, Scene scene);

  /// What its user should know about the scene.
  std::vector<std::string> const& warnings() const { return warnings_; }

  /// Tells what begins, unless it is to be quiet, and the warnings.
  void introduce() const;

  /// Goes on from a checkpoint, or begins, and runs to the end. Throws Failure; result() may be
  /// there nevertheless.
  void go(StopRequests& stops);

  /// Of go(); the summary is empty if the run did not come to one.
  RunResult const& result() const { return result_; }

  /// Takes steps for about a second and tells what all of them would take.
  Forecast forecast();

 private:
  TrajectoryHeader header();
  bool has_time_to_deflate(TrajectoryHeader const& header);
  std::int64_t end_of_phase(std::int64_t step) const;
  double timed_steps(std::int64_t step, std::int64_t until);
  Report report();
  void go_on_from(SavedRun const& saved);
  void write_recorded(SavedRun const& saved);
  void log_start() const;
  void tell_result(Summary const& result) const;
  void open_trajectory();
  void open_window();
  void watch(std::int64_t step);
  void step_to_the_end(StopRequests& stops);
  void look_for_rest();
  void save(Summary const* result);
  [[noreturn]] void stop(std::string const& why, int signal);
  void write_frame(Report const& report);
  void close_trajectory();
  void check_state(Report const& report);
  void fetch_states();
  void write_results();
  Summary summary();

  RunOptions const& options_;
  Scene scene_;
  std::unique_ptr<Engine> engine_;
  std::int64_t discs_;
  std::uint64_t initial_hash_ = 0;
  std::string identity_;
  std::string checkpoint_; ///< where it is kept; empty: nowhere
  std::vector<std::string> warnings_;
  std::unique_ptr<TrajectoryFile> trajectory_;
  std::unique_ptr<FrameWriter> writer_;
  Stage stage_;                    ///< for the window
  std::unique_ptr<LiveView> live_; ///< if the run is watched
  std::int64_t step_ = 0;          ///< taken so far
  std::optional<RestWatch> rest_;  ///< if that ends the run
  std::int64_t frames_ = 0;        ///< of the trajectory, as of the last checkpoint
  double wall_seconds_ = 0;
  double checkpoint_seconds_ = 0; ///< that the last one took
  std::vector<DiscState> states_; ///< at the end, if anyone asks
  std::string broken_;            ///< why the state is no longer one; empty while it is
  int checkpoints_asked_ = 0;     ///< as of the last one
  RunResult result_;
};

/// Frames of a run: steps 0, every, 2 every... and the last.
std::int64_t planned_frames(std::int64_t steps, std::int64_t every);

} // namespace ricochet::driver
