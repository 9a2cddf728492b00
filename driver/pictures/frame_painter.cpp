#include "pictures/frame_painter.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

constexpr Colour black{32, 32, 32}, grey{200, 200, 200};

} // namespace

FramePainter::FramePainter(Stage const& stage, Look const& look)
  : stage_(stage),
    look_(look),
    layout_(arrange(look, stage)),
    discs_(stage, look, layout_),
    picture_(layout_.width, layout_.height, background(look.style))
{
  if (!layout_.legend)
    return;
  if (colouring(look_, stage_) != Colouring::none)
    draw_colours();
  draw_scale();
}

Picture const& FramePainter::paint(double time, std::vector<DiscState> const& discs)
{
  discs_.paint(discs, picture_);
  if (layout_.legend) {
    draw_walls();
    draw_time(time);
  }
  return picture_;
}

// Walls are lines just outside of the box; the ends of a periodic axis are grey.
void FramePainter::draw_walls()
{
  Box const& box = stage_.box;
  int const thick = std::max(1, layout_.unit * 2 / 3);
  auto const pixel = [](double place) {
    return static_cast<int>(std::lround(std::clamp(place, -1e6, 1e6)));
  };
  int const left = pixel(layout_.pixel_x(-box.width / 2));
  int const right = pixel(layout_.pixel_x(box.width / 2));
  int const top = pixel(layout_.pixel_y(box.height / 2));
  int const bottom = pixel(layout_.pixel_y(-box.height / 2));
  Colour const at_x = box.x == Boundary::walls ? black : grey;
  Colour const at_y = box.y == Boundary::walls ? black : grey;
  Rectangle const seen{layout_.plane.left - thick, layout_.plane.top - thick,
                       layout_.plane.right + thick, layout_.plane.bottom + thick};
  auto const line = [&](Rectangle where, Colour colour) {
    picture_.fill(common(where, seen), colour);
  };
  line({left - thick, top, left, bottom}, at_x);
  line({right, top, right + thick, bottom}, at_x);
  line({left - thick, top - thick, right + thick, top}, at_y);
  line({left - thick, bottom, right + thick, bottom + thick}, at_y);
}

void FramePainter::draw_time(double time)
{
  Rectangle const legend = *layout_.legend;
  int const unit = layout_.unit;
  picture_.fill({legend.left, legend.top, legend.right, legend.top + letter_height * unit},
                background(look_.style));
  picture_.write(legend.left, legend.top, fmt::format("t = {:.{}f}", time, time_decimals(stage_)),
                 unit, black);
}

// A bar with all colours and what they stand for.
void FramePainter::draw_colours()
{
  Rectangle const legend = *layout_.legend;
  int const unit = layout_.unit;
  bool const of_speed = colouring(look_, stage_) == Colouring::speed;
  double const most = of_speed ? top_speed(look_, stage_)
                               : static_cast<double>(std::max<std::int64_t>(stage_.discs - 1, 0));
  int const title = legend.top + 20 * unit;
  picture_.write(legend.left, title, of_speed ? "speed" : "id", unit, black);
  Rectangle const bar{legend.left, title + 16 * unit, legend.left + 10 * unit,
                      std::min(title + 136 * unit, legend.bottom - 40 * unit)};
  int const height = bar.height();
  if (height < 24 * unit)
    return;
  for (int y = 0; y < height; ++y)
    picture_.fill({bar.left, bar.bottom - 1 - y, bar.right, bar.bottom - y},
                  colour_map()[static_cast<std::size_t>(y * 256 / height)]);
  constexpr int ticks = 4;
  for (int tick = 0; tick <= ticks; ++tick) {
    int const y = bar.bottom - tick * height / ticks;
    picture_.fill({bar.right, y - unit / 2, bar.right + 3 * unit, y - unit / 2 + unit}, black);
    double const value = most * tick / ticks;
    picture_.write(bar.right + 6 * unit, y - letter_height * unit / 2,
                   of_speed ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value), unit,
                   black);
  }
}

// A bar of a round length.
void FramePainter::draw_scale()
{
  Rectangle const legend = *layout_.legend;
  int const unit = layout_.unit;
  double const length = round_below(60 * unit / layout_.scale);
  int const pixels = static_cast<int>(std::lround(length * layout_.scale));
  int const y = legend.bottom - unit;
  picture_.fill({legend.left, y - unit, legend.left + pixels, y + unit}, black);
  for (int const end : {legend.left, legend.left + pixels - unit})
    picture_.fill({end, y - 3 * unit, end + unit, y + unit}, black);
  picture_.write(legend.left, y - 13 * unit, fmt::format("{:g}", length), unit, black);
}

} // namespace ricochet::driver
