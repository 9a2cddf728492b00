#include "output_lock.hpp"

#include "exit_codes.hpp"
#include "output_file.hpp"
#include "provenance.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace ricochet::driver {

namespace {

// Whether `path` still leads to the open file.
bool leads_to(std::string const& path, int descriptor)
{
  struct stat there {
  }, here{};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(descriptor, &here) == 0 &&
         there.st_dev == here.st_dev && there.st_ino == here.st_ino;
}

std::string content_of(int descriptor)
{
  char text[256];
  ssize_t const size = ::pread(descriptor, text, sizeof text, 0);
  return {text, static_cast<std::size_t>(size > 0 ? size : 0)};
}

} // namespace

OutputLock::OutputLock(std::string const& path) : file_(hidden_beside(path, "lock"))
{
  for (;;) {
    descriptor_ = ::open(file_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0)
      throw Failure(Exit::cannot_create,
                    fmt::format("cannot create '{}': {}", file_, std::strerror(errno)));
    int const refused = ::flock(descriptor_, LOCK_EX | LOCK_NB) == 0 ? 0 : errno;
    if (refused == EWOULDBLOCK) {
      std::string const owner = content_of(descriptor_);
      ::close(descriptor_);
      throw Failure(Exit::cannot_create,
                    fmt::format("cannot create '{}': another run is at work on it{}", path,
                                owner.empty() ? "" : " (" + owner + ")"));
    }
    if (refused != 0 || leads_to(file_, descriptor_))
      break;
    ::close(descriptor_); // of a run that ended just now, and took the file away
  }
  std::string const owner = fmt::format("process {} on {}", ::getpid(), host_name());
  // Only the message of another run would lack it.
  if (::ftruncate(descriptor_, 0) == 0 && ::write(descriptor_, owner.data(), owner.size()) < 0)
    errno = 0;
}

OutputLock::~OutputLock()
{
  if (descriptor_ < 0)
    return;
  ::unlink(file_.c_str());
  ::close(descriptor_);
}

OutputLock::OutputLock(OutputLock&& other) noexcept
  : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1))
{
}

} // namespace ricochet::driver
