// The program as a process: run it, see what it says, kill it.
#pragma once

#include <cstdint>
#include <string>
#include <sys/types.h>
#include <vector>

namespace ricochet::test {

/// A new folder that is gone after the test.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(Folder const&) = delete;
  Folder& operator=(Folder const&) = delete;

  /// Path of a file in the folder.
  std::string operator/(std::string const& name) const { return path_ + "/" + name; }
  std::string const& path() const { return path_; }

  /// Writes a file and returns its path.
  std::string write(std::string const& name, std::string const& text) const;

  /// Names of the files in it, sorted.
  std::vector<std::string> names() const;

 private:
  std::string path_;
};

/// The whole text of a file; fails the test if there is none.
std::string text_of(std::string const& path);

/// Path of a ready-made scene's file.
std::string scene(std::string const& name);

/// Path of a template for Slurm.
std::string slurm(std::string const& name);

/// Path of the program.
std::string program();

/// How a program ended and what it said.
struct Outcome {
  int code = -1; ///< exit code, or 128 + signal
  std::string out, err;
};

struct ProcessOptions {
  std::vector<std::string> environment; ///< NAME=VALUE, beside and instead of the present one
  std::int64_t file_size_limit = -1;    ///< bytes; -1: none
  std::string standard_output;          ///< a file to open instead of reading along
  std::string other_program = {};       ///< to run instead of ricochet
};

/// Runs `ricochet` with these arguments to its end.
Outcome ricochet(std::vector<std::string> const& arguments, ProcessOptions const& options = {});

/// A running program.
class Process {
 public:
  explicit Process(std::vector<std::string> const& arguments, ProcessOptions const& options = {});
  ~Process(); ///< kills it
  Process(Process const&) = delete;
  Process& operator=(Process const&) = delete;

  bool is_running();
  void kill();
  void send(int signal);
  Outcome wait();

 private:
  void note(int status);

  Folder folder_; ///< for what it says
  std::string out_;
  pid_t id_ = -1;
  bool ended_ = false;
  int code_ = -1;
};

} // namespace ricochet::test
