// What the program's exit status means, and the exception that carries one.
#pragma once

#include <stdexcept>
#include <string>

namespace ricochet::driver {

/// Exit status of the program; 64 and above follow sysexits(3).
enum class Exit {
  done = 0,           ///< finished
  failed = 1,         ///< the run went wrong, such as a state that is not finite
  differs = 2,        ///< a comparison found more than the tolerance
  usage = 64,         ///< wrong command line
  bad_data = 65,      ///< a scene or a file whose content is wrong
  no_input = 66,      ///< an input file cannot be opened
  internal = 70,      ///< a defect of this program
  cannot_create = 73, ///< an output exists already or cannot be created
  io_error = 74,      ///< reading or writing failed, such as a full disk
  stopped = 75        ///< stopped on request; a checkpoint was written, and the run can go on
};

/// Ends the command with a message for the user.
class Failure : public std::runtime_error {
 public:
  Failure(Exit code, std::string const& message) : std::runtime_error(message), code_(code) {}
  Exit code() const { return code_; }

 private:
  Exit code_;
};

/// Everything that is wrong with the input files, a line each: FILE:LINE:COLUMN: problem.
class BadScene : public Failure {
 public:
  explicit BadScene(std::string const& lines) : Failure(Exit::bad_data, lines) {}
};

} // namespace ricochet::driver
