#include "child_process.hpp"

#include "exit_codes.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <sstream>
#include <sys/wait.h>
#include <unistd.h>

namespace ricochet::driver {

bool is_installed(std::string const& program)
{
  char const* const path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / program).c_str(), X_OK) == 0)
      return true;
  return false;
}

ChildProcess::ChildProcess(std::vector<std::string> words) : name_(words.at(0))
{
  std::signal(SIGPIPE, SIG_IGN); // a program that ends early is an error of write()
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  int ends[2] = {-1, -1};
  said_.reset(std::tmpfile());
  bool const good = said_ && ::pipe2(ends, O_CLOEXEC) == 0 && (id_ = ::fork()) >= 0;
  if (!good)
    throw Failure(Exit::failed, fmt::format("cannot start {}: {}", name_, std::strerror(errno)));
  if (id_ == 0) {
    ::dup2(ends[0], STDIN_FILENO);
    ::dup2(::fileno(said_.get()), STDOUT_FILENO);
    ::dup2(::fileno(said_.get()), STDERR_FILENO);
    ::signal(SIGPIPE, SIG_DFL);
    ::execvp(argv[0], argv.data());
    ::_exit(127);
  }
  ::close(ends[0]);
  input_ = ends[1];
}

ChildProcess::~ChildProcess()
{
  if (id_ > 0) {
    ::kill(id_, SIGKILL);
    wait();
  }
}

void ChildProcess::write(void const* data, std::size_t bytes)
{
  auto const* next = static_cast<char const*>(data);
  while (bytes > 0) {
    ssize_t const written = ::write(input_, next, bytes);
    if (written < 0 && errno == EINTR)
      continue;
    if (written <= 0)
      fail();
    next += written;
    bytes -= static_cast<std::size_t>(written);
  }
}

void ChildProcess::finish()
{
  if (wait() != 0)
    fail();
}

// Returns what waitpid() tells of its end.
int ChildProcess::wait()
{
  if (input_ >= 0)
    ::close(input_);
  input_ = -1;
  int status = 0;
  while (id_ > 0 && ::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
  }
  id_ = -1;
  return status;
}

void ChildProcess::fail()
{
  wait();
  char text[2000];
  ssize_t const length = ::pread(::fileno(said_.get()), text, sizeof text, 0);
  throw Failure(Exit::io_error,
                fmt::format("{} failed: {}", name_,
                            trimmed(std::string_view(
                                text, length > 0 ? static_cast<std::size_t>(length) : 0))));
}

} // namespace ricochet::driver
