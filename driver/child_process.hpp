// Another program that this one starts and feeds, such as ffmpeg.
#pragma once

#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <sys/types.h>
#include <vector>

namespace ricochet::driver {

/// True if a program of this name is on PATH.
bool is_installed(std::string const& program);

class ChildProcess {
 public:
  /// Starts `words[0]`. What it says on its outputs is kept for finish(). Throws
  /// Failure(Exit::failed) if it cannot be started.
  explicit ChildProcess(std::vector<std::string> words);
  ~ChildProcess(); ///< without finish(): ends it
  ChildProcess(ChildProcess const&) = delete;
  ChildProcess& operator=(ChildProcess const&) = delete;

  /// Writes to its standard input. Throws Failure(Exit::io_error), with what it said.
  void write(void const* data, std::size_t bytes);

  /// Closes its standard input and waits for its end. Throws Failure(Exit::io_error), with what it
  /// said, unless it ended well.
  void finish();

 private:
  int wait();
  [[noreturn]] void fail();

  std::string name_;
  int input_ = -1;
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> said_; ///< a file without a name
  pid_t id_ = -1;
};

} // namespace ricochet::driver
