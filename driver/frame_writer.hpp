// A thread that writes frames while the simulation goes on.
#pragma once

#include "trajectory_file.hpp"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

namespace ricochet::driver {

/// Bytes of the frames on their way to the file: of those of a queue that is full, or of as many as
/// wait until they fill a chunk.
double frames_memory(TrajectoryHeader const& header, bool queue_is_full);

/// Takes frames, in order, into a queue of bounded memory and appends them to a file. Frames are
/// flushed within about a second; if they are not compressed, ten times a second at most.
class FrameWriter {
 public:
  explicit FrameWriter(TrajectoryFile& file, std::int64_t discs);
  ~FrameWriter(); ///< writes what is queued, if writing works
  FrameWriter(FrameWriter const&) = delete;
  FrameWriter& operator=(FrameWriter const&) = delete;

  /// An empty frame to fill. Waits for one while the queue is full. Throws what writing threw.
  std::unique_ptr<Frame> borrow();

  /// Hands a filled frame over.
  void submit(std::unique_ptr<Frame> frame);

  /// Waits until everything is in the file. Throws what writing threw.
  void flush();

  /// The same, and ends the thread.
  void finish();

 private:
  using Frames = std::vector<std::unique_ptr<Frame>>;
  using Clock = std::chrono::steady_clock;

  void work();
  std::size_t room_in_block() const;
  void write(std::size_t count, std::unique_lock<std::mutex>& lock);
  void flush_file(std::unique_lock<std::mutex>& lock);
  void stop();

  TrajectoryFile& file_;
  std::size_t discs_;
  std::size_t most_frames_; ///< that may exist at a time
  std::size_t frames_ = 0;  ///< that exist
  std::mutex mutex_;
  std::condition_variable changed_;
  Frames free_;
  std::deque<std::unique_ptr<Frame>> queue_;
  bool in_haste_ = false;  ///< someone waits for the queue to be empty
  bool is_flushed_ = true; ///< whatever was taken from the queue
  Clock::time_point last_flush_ = Clock::now();
  bool closed_ = false;
  std::exception_ptr error_;
  std::thread thread_; ///< last, so that all else is there when it starts
};

} // namespace ricochet::driver
