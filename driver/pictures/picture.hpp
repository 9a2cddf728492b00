// A picture in memory, and the simplest things that can be drawn on one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ricochet::driver {

struct Colour {
  std::uint8_t red, green, blue;
};

/// Pixels from (left, top) to just before (right, bottom); y counts downwards.
struct Rectangle {
  int left, top, right, bottom;
  int width() const { return right - left; }
  int height() const { return bottom - top; }
};

/// The pixels that both have; empty rectangles have right = left or bottom = top.
Rectangle common(Rectangle a, Rectangle b);

class Picture {
 public:
  Picture(int width, int height, Colour background);

  int width() const { return width_; }
  int height() const { return height_; }
  Colour at(int x, int y) const;

  /// The pixels, three bytes each, row by row from the top.
  std::vector<std::uint8_t> const& bytes() const { return bytes_; }
  /// Where the bytes of row `y` begin at pixel `x`.
  std::uint8_t* row(int x, int y);

  /// What lies outside of the picture is left out.
  void fill(Rectangle area, Colour colour);

  /// Writes `text` with dots of `unit` pixels; (left, top) is where its first letter begins.
  void write(int left, int top, std::string_view text, int unit, Colour colour);

 private:
  int width_, height_;
  std::vector<std::uint8_t> bytes_;
};

/// The size of written text in dots: a letter is 5 wide, 1 apart from the next.
constexpr int letter_advance = 6, letter_height = 7;
int text_width(std::string_view text, int unit);

/// The picture as a file in PNG. Throws Failure.
std::string as_png(Picture const& picture);

} // namespace ricochet::driver
