// A whole picture of a moment: discs, walls, time, legend, scale.
#pragma once

#include "pictures/disc_painter.hpp"
#include "pictures/look.hpp"
#include "pictures/picture.hpp"

#include <vector>

namespace ricochet::driver {

class FramePainter {
 public:
  FramePainter(Stage const& stage, Look const& look);

  Layout const& layout() const { return layout_; }

  /// The picture stays until the next one is painted.
  Picture const& paint(double time, std::vector<DiscState> const& discs);

 private:
  void draw_walls();
  void draw_time(double time);
  void draw_colours();
  void draw_scale();

  Stage stage_;
  Look look_;
  Layout layout_;
  DiscPainter discs_;
  Picture picture_;
};

} // namespace ricochet::driver
