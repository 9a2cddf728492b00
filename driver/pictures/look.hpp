// What pictures shall look like, and where in a picture what is seen.
#pragma once

#include "pictures/picture.hpp"

#include "ricochet/model.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// What the colour of a disc tells.
enum class Colouring { speed, id, none };

/// `plain`: discs on white with walls, time, legend and scale. `classic`: as the original's window,
/// red discs on black and nothing else.
enum class Style { plain, classic };

/// A part of the plane.
struct Region {
  double left, bottom, right, top;
};

struct PictureSize {
  int width, height;
};

/// What is to be seen, apart from the discs of a moment.
struct Stage {
  Box box;
  double radius = 0;
  double gravity = 0;
  std::int64_t discs = 0;
  bool has_velocities = false;
  double fast = 0;     ///< about the speed of the fastest discs
  double interval = 0; ///< time from frame to frame
};

/// What the user wants to see of it.
struct Look {
  Style style = Style::plain;
  std::optional<Colouring> colouring; ///< default: speed if it is known
  std::optional<double> top_speed;    ///< at the end of the scale of colours
  std::optional<Region> region;       ///< default: the whole box
  std::optional<PictureSize> size;
};

/// What `look` means for `stage`. Throws Failure(Exit::usage) if it cannot be had.
Colouring colouring(Look const& look, Stage const& stage);
double top_speed(Look const& look, Stage const& stage);
Region region(Look const& look, Stage const& stage);

/// Where things are in a picture.
struct Layout {
  int width = 0, height = 0;
  int unit = 1;                      ///< pixels of a dot of the letters
  Rectangle plane{};                 ///< where discs can be
  double scale = 1;                  ///< pixels per length
  double origin_x = 0, origin_y = 0; ///< pixel of the plane's (0, 0)
  std::optional<Rectangle> legend;   ///< where time, legend and scale are

  double pixel_x(double x) const { return origin_x + x * scale; }
  double pixel_y(double y) const { return origin_y - y * scale; }
};

/// Throws Failure(Exit::usage) if the size leaves no room.
Layout arrange(Look const& look, Stage const& stage);

/// As many decimals of the time as tell frames apart.
int time_decimals(Stage const& stage);

/// viridis, from dark violet to yellow.
std::array<Colour, 256> const& colour_map();

/// The largest of 1, 2 and 5 times a power of ten that is at most `value` > 0.
double round_below(double value);

} // namespace ricochet::driver
