// How far a run is: a bar on a terminal, sparse lines in a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace ricochet::driver {

class Progress {
 public:
  enum class Style { none, bar, lines };

  /// A bar if stderr is a terminal that can show one, else lines; nothing if `quiet`.
  static Style style_for(bool quiet);

  /// A run of `discs` discs and `steps` steps begins now, or goes on after the `first` of them.
  Progress(Style style, std::int64_t discs, std::int64_t steps, std::int64_t first);
  ~Progress(); ///< clears the bar

  /// True if it is time for update().
  bool is_due() const;

  /// Shows that `step` steps are done and that the system's energy is `energy`.
  void update(std::int64_t step, double energy);

  /// Removes the bar.
  void clear();

 private:
  using Clock = std::chrono::steady_clock;

  void draw(std::int64_t step, double rate, double left);
  void log(std::int64_t step, double rate, double left, double energy);

  Style style_;
  std::int64_t discs_, steps_, first_;
  Clock::time_point begin_, next_;
  std::int64_t logged_step_;
  bool is_drawn_ = false;
};

/// Seconds as HH:MM:SS.
std::string clock_text(double seconds);

/// The present time in UTC as 2026-01-02T03:04:05Z.
std::string utc_now();

} // namespace ricochet::driver
