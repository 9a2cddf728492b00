#include "frame_writer.hpp"

#include "kokkos_startup.hpp"

#include <algorithm>

namespace ricochet::driver {

namespace {

constexpr std::size_t queue_bytes = 64 << 20;
constexpr std::chrono::seconds longest_wait{1};
constexpr std::chrono::milliseconds flush_interval{100}; // a flush takes a fair part of a write

// How many frames fit in the memory of the queue, beside those of the block being collected.
std::size_t queue_length(std::size_t discs)
{
  std::size_t const fitting = queue_bytes / (sizeof(DiscState) * std::max<std::size_t>(1, discs));
  return std::clamp<std::size_t>(fitting, 1, 4096);
}

} // namespace

double frames_memory(TrajectoryHeader const& header, bool queue_is_full)
{
  auto const discs = static_cast<std::size_t>(header.discs);
  auto const block = static_cast<double>(chunk_sizes(header).frames);
  double const frames = block + (queue_is_full ? static_cast<double>(queue_length(discs)) : block);
  return std::min(static_cast<double>(header.frames), frames) * static_cast<double>(discs) *
         sizeof(DiscState);
}

FrameWriter::FrameWriter(TrajectoryFile& file, std::int64_t discs)
  : file_(file),
    discs_(static_cast<std::size_t>(discs)),
    most_frames_(static_cast<std::size_t>(file.frames_per_block()) + queue_length(discs_)),
    thread_([this] { work(); })
{
}

FrameWriter::~FrameWriter()
{
  stop();
}

void FrameWriter::stop()
{
  {
    std::lock_guard const lock(mutex_);
    closed_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable())
    thread_.join();
}

std::unique_ptr<Frame> FrameWriter::borrow()
{
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return error_ || !free_.empty() || frames_ < most_frames_; });
  if (error_)
    std::rethrow_exception(error_);
  if (free_.empty()) {
    ++frames_;
    lock.unlock();
    auto frame = std::make_unique<Frame>();
    frame->states.resize(discs_);
    return frame;
  }
  auto frame = std::move(free_.back());
  free_.pop_back();
  return frame;
}

void FrameWriter::submit(std::unique_ptr<Frame> frame)
{
  bool block_is_full = false;
  {
    std::lock_guard const lock(mutex_);
    queue_.push_back(std::move(frame));
    block_is_full = queue_.size() >= static_cast<std::size_t>(file_.frames_per_block());
  }
  if (block_is_full)
    changed_.notify_all();
}

void FrameWriter::flush()
{
  std::unique_lock lock(mutex_);
  in_haste_ = true;
  changed_.notify_all();
  changed_.wait(lock, [&] { return error_ || (queue_.empty() && is_flushed_); });
  in_haste_ = false;
  if (error_)
    std::rethrow_exception(error_);
}

void FrameWriter::finish()
{
  stop();
  if (error_)
    std::rethrow_exception(error_);
}

void FrameWriter::work()
{
  share_processors();
  std::unique_lock lock(mutex_);
  try {
    while (!closed_ || !queue_.empty()) {
      std::size_t const room = room_in_block();
      changed_.wait_for(lock, longest_wait, [&] {
        return closed_ || queue_.size() >= room || (in_haste_ && !(queue_.empty() && is_flushed_));
      });
      write(std::min(room, queue_.size()), lock);
      bool const is_awaited = in_haste_ && queue_.empty();
      if (is_awaited || Clock::now() - last_flush_ >= flush_interval)
        flush_file(lock);
    }
    flush_file(lock);
  } catch (...) {
    if (!lock.owns_lock())
      lock.lock();
    error_ = std::current_exception();
    changed_.notify_all();
  }
}

std::size_t FrameWriter::room_in_block() const
{
  return static_cast<std::size_t>(file_.frames_per_block() -
                                  file_.frames() % file_.frames_per_block());
}

// Writes `count` frames of the queue without holding up the simulation, then frees them.
void FrameWriter::write(std::size_t count, std::unique_lock<std::mutex>& lock)
{
  if (count == 0)
    return;
  Frames block;
  for (; block.size() < count; queue_.pop_front())
    block.push_back(std::move(queue_.front()));
  is_flushed_ = false;
  lock.unlock();
  file_.append(block);
  lock.lock();
  for (auto& frame : block)
    free_.push_back(std::move(frame));
  changed_.notify_all();
}

// Flushes what was written, without holding up the simulation either.
void FrameWriter::flush_file(std::unique_lock<std::mutex>& lock)
{
  if (is_flushed_)
    return;
  lock.unlock();
  file_.flush();
  lock.lock();
  is_flushed_ = true;
  last_flush_ = Clock::now();
  changed_.notify_all();
}

} // namespace ricochet::driver
