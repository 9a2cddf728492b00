// Reasons to stop a run before its end: signals, the end of the time it was given, a file.
#pragma once

#include <optional>
#include <string>

namespace ricochet::driver {

/// Seconds in [D-]HH:MM:SS; nothing if `text` is not of that form.
std::optional<double> parse_duration(std::string const& text);

/// Watches for requests to stop while it lives, for any number of runs.
///
/// SIGINT, SIGTERM and SIGUSR1 ask for an end in good order; the same signal a second time ends the
/// program at once, with 128 + its number. SIGUSR2 asks for a checkpoint and nothing else.
class StopRequests {
 public:
  /// At most `walltime` seconds may pass from the start of the program, and the time in the
  /// environment variable RICOCHET_STOP_AT (in seconds since 1970) may not be reached. A file
  /// `stop_file` stops the run as well; empty: none. Throws Failure(Exit::usage).
  StopRequests(std::optional<double> walltime, std::string stop_file);
  ~StopRequests();
  StopRequests(StopRequests const&) = delete;
  StopRequests& operator=(StopRequests const&) = delete;

  /// Why the run should stop now, if ending it takes `reserve` seconds; "" while it should not.
  /// `signals_only`: what is for runs that can go on later does not count.
  std::string reason(double reserve, bool signals_only) const;

  /// The signal that asked for the end; 0 if none did.
  int signal() const;

  /// How many times SIGUSR2 came.
  int checkpoints_asked() const;

 private:
  std::optional<double> limit_; ///< seconds since the start of the program
  std::string stop_file_;
};

} // namespace ricochet::driver
