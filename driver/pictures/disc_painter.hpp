// Discs to pixels, on the default backend.
#pragma once

#include "pictures/look.hpp"
#include "pictures/picture.hpp"

#include <memory>
#include <vector>

namespace ricochet::driver {

/// Paints the discs of a moment into the plane of a layout.
///
/// Each disc adds, to every pixel that it covers, its coverage and its colour weighted with that. A
/// pixel shows the mean of the colours, as densely as it is covered. So it does not matter in which
/// order discs come, nor how small they are: discs under a pixel become a density. The sums are
/// integers: the picture is the same for any number of threads.
class DiscPainter {
 public:
  DiscPainter(Stage const& stage, Look const& look, Layout const& layout);
  ~DiscPainter();
  DiscPainter(DiscPainter const&) = delete;
  DiscPainter& operator=(DiscPainter const&) = delete;

  /// Replaces the plane's part of `picture`.
  void paint(std::vector<DiscState> const& discs, Picture& picture);

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

/// Background and discs where colour does not tell anything.
Colour background(Style style);
Colour single_colour(Style style);

} // namespace ricochet::driver
