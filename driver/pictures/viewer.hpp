// Frames in a window: played from a source, or live while they are simulated.
#pragma once

#include "pictures/frame_painter.hpp"
#include "pictures/look.hpp"
#include "pictures/window.hpp"

#include <chrono>
#include <cstdint>
#include <memory>
#include <vector>

namespace ricochet::driver {

class FrameSource;

/// The part of the plane and the colours that the user has chosen in a window.
class View {
 public:
  View(Stage const& stage, Look const& look);

  Layout const& layout() const { return painter_->layout(); }
  Picture const& paint(double time, std::vector<DiscState> const& discs)
  {
    return painter_->paint(time, discs);
  }

  /// True if `input` changed what is to be painted.
  bool obey(Input const& input);

 private:
  Stage stage_;
  Look first_, look_;
  std::unique_ptr<FramePainter> painter_;
};

/// Plays `frames` of `source`, `fps` a second, until the user quits.
void play(FrameSource& source, std::vector<std::int64_t> const& frames, Look const& look,
          double fps, Window& window);

/// A simulation that is watched.
class LiveView {
 public:
  /// `pace`: seconds from one picture to the next at least.
  LiveView(std::unique_ptr<Window> window, View view, double pace);

  /// False when the user has closed the window.
  bool is_open() const { return window_ != nullptr; }

  /// True if it is time for a picture and the window is open.
  bool is_due() const;

  /// Shows a picture, as soon as it is time for it; waits while the user pauses.
  void show(double time, std::vector<DiscState> const& discs);

 private:
  using Clock = std::chrono::steady_clock;

  std::unique_ptr<Window> window_; ///< none: the user has closed it
  View view_;
  std::chrono::duration<double> pace_;
  Clock::time_point next_ = Clock::now();
};

} // namespace ricochet::driver
