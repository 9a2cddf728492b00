// One run at a time for an output.
#pragma once

#include <string>

namespace ricochet::driver {

/// Keeps other runs from the output at `path` while it lives. File systems without locks are
/// believed to have no other run.
class OutputLock {
 public:
  /// Throws Failure(Exit::cannot_create) if another run has it.
  explicit OutputLock(std::string const& path);
  ~OutputLock();
  OutputLock(OutputLock&& other) noexcept;
  OutputLock& operator=(OutputLock&&) = delete;

 private:
  std::string file_; ///< that is locked, beside the output
  int descriptor_ = -1;
};

} // namespace ricochet::driver
