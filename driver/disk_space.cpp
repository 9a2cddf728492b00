#include "disk_space.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace ricochet::driver {

namespace {

constexpr std::uint64_t ahead = 4 << 20; // to reserve seldom; file systems in memory fill it

// 0, or why there is no room from `start` to `end`.
int allocate(int file, std::uint64_t start, std::uint64_t end)
{
#ifdef __linux__
  int status = 0;
  do
    status = ::fallocate(file, FALLOC_FL_KEEP_SIZE, static_cast<off_t>(start),
                         static_cast<off_t>(end - start));
  while (status != 0 && errno == EINTR);
  bool const is_full =
      status != 0 && (errno == ENOSPC || errno == EDQUOT || errno == EFBIG || errno == EIO);
  return is_full ? errno : 0;
#else
  (void)file, (void)start, (void)end;
  return 0;
#endif
}

} // namespace

DiskSpace::DiskSpace(std::string const& path) : file_(::open(path.c_str(), O_WRONLY | O_CLOEXEC))
{
  if (file_ < 0)
    throw std::system_error(errno, std::generic_category());
}

DiskSpace::~DiskSpace()
{
  if (file_ >= 0)
    ::close(file_);
}

DiskSpace::DiskSpace(DiskSpace&& other) noexcept
  : file_(std::exchange(other.file_, -1)), reserved_(other.reserved_)
{
}

DiskSpace& DiskSpace::operator=(DiskSpace&& other) noexcept
{
  std::swap(file_, other.file_);
  std::swap(reserved_, other.reserved_);
  return *this;
}

void DiskSpace::reserve(std::uint64_t size)
{
  rlimit limit{}; // which reserving does not look at
  if (::getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      size > limit.rlim_cur)
    throw std::system_error(EFBIG, std::generic_category());
  if (size <= reserved_)
    return;
  if (allocate(file_, reserved_, size + ahead) == 0)
    reserved_ = size + ahead;
  else if (int const reason = allocate(file_, reserved_, size))
    throw std::system_error(reason, std::generic_category());
  else
    reserved_ = size;
}

void DiskSpace::release(std::uint64_t least)
{
  struct stat status {};
  if (file_ >= 0 && ::fstat(file_, &status) == 0) {
    auto const length = std::max(static_cast<std::uint64_t>(status.st_size), least);
    // Failure leaves the file as it is, which is all that can be done.
    if (::ftruncate(file_, static_cast<off_t>(length)) == 0)
      reserved_ = 0;
  }
}

} // namespace ricochet::driver
