#include "pictures/look.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

constexpr int margin = 6, legend_width = 74; // units

// The picture's size if none is asked for: 1080 pixels high, at most 1920 wide.
PictureSize usual_size(Region const& region, Style style)
{
  double const width = region.right - region.left, height = region.top - region.bottom;
  if (style == Style::classic) // a pixel a length, as the original's window
    return {static_cast<int>(std::clamp(std::ceil(width), 1.0, 1920.0)),
            static_cast<int>(std::clamp(std::ceil(height), 1.0, 1080.0))};
  constexpr int unit = 3, beside = (legend_width + 2 * margin) * unit, above = 2 * margin * unit;
  double const scale = std::min((1920 - beside) / width, (1080 - above) / height);
  auto const even = [](double pixels) { return static_cast<int>(std::ceil(pixels / 2)) * 2; };
  return {even(std::max(width * scale, 32.0)) + beside,
          even(std::max(height * scale, 360.0 - above)) + above};
}

} // namespace

Colouring colouring(Look const& look, Stage const& stage)
{
  if (look.style == Style::classic)
    return Colouring::none;
  if (look.colouring == Colouring::speed && !stage.has_velocities)
    throw Failure(Exit::usage, "--colour speed: the trajectory has no velocities (allowed: id, "
                               "none)");
  return look.colouring.value_or(stage.has_velocities ? Colouring::speed : Colouring::none);
}

double top_speed(Look const& look, Stage const& stage)
{
  if (look.top_speed)
    return *look.top_speed;
  if (!(stage.fast > 0 && std::isfinite(stage.fast)))
    return 1; // nothing moves
  // Two digits, so that the legend is easy to read.
  double const digit = std::pow(10, std::floor(std::log10(stage.fast)) - 1);
  return std::ceil(stage.fast / digit) * digit;
}

Region region(Look const& look, Stage const& stage)
{
  double const width = stage.box.width / 2, height = stage.box.height / 2;
  return look.region.value_or(Region{-width, -height, width, height});
}

Layout arrange(Look const& look, Stage const& stage)
{
  Box const& box = stage.box;
  Region const region = driver::region(look, stage);
  PictureSize const size = look.size.value_or(usual_size(region, look.style));
  Layout layout;
  layout.width = size.width;
  layout.height = size.height;
  Rectangle room{0, 0, size.width, size.height};
  int edge = 0;
  if (look.style == Style::plain) {
    layout.unit = std::max(1, std::min((size.height + 120) / 360, size.width / 300));
    edge = margin * layout.unit;
    room = {edge, edge, size.width - edge - legend_width * layout.unit, size.height - edge};
    layout.legend = Rectangle{room.right + edge, edge, size.width, size.height - edge};
  }
  if (room.width() < 16 || room.height() < 16)
    throw Failure(Exit::usage, fmt::format("--size {}x{}: leaves no room for the discs (200x100 "
                                           "would)",
                                           size.width, size.height));
  double const width = region.right - region.left, height = region.top - region.bottom;
  layout.scale = std::min(room.width() / width, room.height() / height);
  layout.origin_x = room.left + room.width() / 2.0 - (region.left + width / 2) * layout.scale;
  layout.origin_y = room.top + room.height() / 2.0 + (region.bottom + height / 2) * layout.scale;

  // A disc that pokes through a wall is seen in the margin; on a periodic axis it is seen at the
  // other end.
  int const beyond_x = look.region || box.x == Boundary::periodic ? 0 : edge;
  int const beyond_y = look.region || box.y == Boundary::periodic ? 0 : edge;
  auto const nearest = [](double pixel) { return static_cast<int>(std::lround(pixel)); };
  layout.plane = common({nearest(layout.pixel_x(region.left)) - beyond_x,
                         nearest(layout.pixel_y(region.top)) - beyond_y,
                         nearest(layout.pixel_x(region.right)) + beyond_x,
                         nearest(layout.pixel_y(region.bottom)) + beyond_y},
                        {0, 0, layout.legend ? room.right + edge : size.width, size.height});
  return layout;
}

int time_decimals(Stage const& stage)
{
  if (!(stage.interval > 0))
    return 0;
  return std::clamp(static_cast<int>(std::ceil(-std::log10(stage.interval))), 0, 6);
}

std::array<Colour, 256> const& colour_map()
{
  // Ten colours of matplotlib's viridis (N. Smith, S. van der Walt, E. Firing; CC0), at equal
  // distances; between them the map is straight to within what can be seen.
  constexpr Colour knots[] = {{0x44, 0x01, 0x54}, {0x48, 0x28, 0x78}, {0x3e, 0x4a, 0x89},
                              {0x31, 0x68, 0x8e}, {0x26, 0x82, 0x8e}, {0x1f, 0x9e, 0x89},
                              {0x35, 0xb7, 0x79}, {0x6d, 0xcd, 0x59}, {0xb4, 0xde, 0x2c},
                              {0xfd, 0xe7, 0x25}};
  static auto const map = [&] {
    std::array<Colour, 256> colours{};
    for (int i = 0; i < 256; ++i) {
      int const place = i * 9, left = std::min(place / 255, 8), far = place - left * 255;
      auto const between = [&](int a, int b) {
        return static_cast<std::uint8_t>((a * (255 - far) + b * far + 127) / 255);
      };
      Colour const a = knots[left], b = knots[left + 1];
      colours[static_cast<std::size_t>(i)] = {between(a.red, b.red), between(a.green, b.green),
                                              between(a.blue, b.blue)};
    }
    return colours;
  }();
  return map;
}

double round_below(double value)
{
  double const power = std::pow(10, std::floor(std::log10(value)));
  return power * (value >= 5 * power ? 5 : value >= 2 * power ? 2 : 1);
}

} // namespace ricochet::driver
