// Making sure of room on the disk before it is needed.
#pragma once

#include <cstdint>
#include <string>

namespace ricochet::driver {

/// Reserves room for a growing file, so that a full disk is noticed before a write and not amid it.
class DiskSpace {
 public:
  DiskSpace() = default;
  /// The file at `path`, which exists.
  explicit DiskSpace(std::string const& path);
  ~DiskSpace();
  DiskSpace(DiskSpace&& other) noexcept;
  DiskSpace& operator=(DiskSpace&& other) noexcept;

  /// Makes sure that the file can grow to `size` bytes; its length stays. Throws std::system_error
  /// if the disk, a quota or a limit does not allow it. File systems that cannot reserve are
  /// believed to have room.
  void reserve(std::uint64_t size);

  /// Gives back what was reserved and not used; makes the file at least `least` bytes long.
  void release(std::uint64_t least = 0);

 private:
  int file_ = -1;
  std::uint64_t reserved_ = 0;
};

} // namespace ricochet::driver
