#include "pictures/picture.hpp"

#include "exit_codes.hpp"

#include <png.h>

#include <algorithm>

namespace ricochet::driver {

namespace {

// The letters that pictures need, seven rows of five dots each.
struct Letter {
  char letter;
  char const* dots;
};
constexpr Letter letters[] = {
    {'0', " ### #   ##  ### # ###  ##   # ### "}, {'1', "  #   ##    #    #    #    #   ### "},
    {'2', " ### #   #    #   #   #   #   #####"}, {'3', " ### #   #    #  ##     ##   # ### "},
    {'4', "   #   ##  # # #  # #####   #    # "}, {'5', "######    ####     #    ##   # ### "},
    {'6', "  ##  #   #    #### #   ##   # ### "}, {'7', "#####    #   #   #   #    #    #   "},
    {'8', " ### #   ##   # ### #   ##   # ### "}, {'9', " ### #   ##   # ####    #   #  ##  "},
    {'.', "                          ##   ##  "}, {'-', "               #####               "},
    {'+', "       #    #  #####  #    #       "}, {'=', "          #####     #####          "},
    {'e', "           ### #   #######     ### "}, {'t', " #    #   ###   #    #    #  #  ## "},
    {'s', "           #####     ###     ##### "}, {'p', "          #### #   ##   ##### #    "},
    {'d', "    #    # #####   ##   ##   # ####"}, {'i', "  #        ##    #    #    #   ### "},
};

char const* dots_of(char letter)
{
  for (Letter const& known : letters)
    if (known.letter == letter)
      return known.dots;
  return nullptr; // a blank
}

} // namespace

Rectangle common(Rectangle a, Rectangle b)
{
  Rectangle both{std::max(a.left, b.left), std::max(a.top, b.top), std::min(a.right, b.right),
                 std::min(a.bottom, b.bottom)};
  both.right = std::max(both.left, both.right);
  both.bottom = std::max(both.top, both.bottom);
  return both;
}

Picture::Picture(int width, int height, Colour background)
  : width_(width),
    height_(height),
    bytes_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3)
{
  fill({0, 0, width, height}, background);
}

std::uint8_t* Picture::row(int x, int y)
{
  return bytes_.data() + (static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
                          static_cast<std::size_t>(x)) *
                             3;
}

Colour Picture::at(int x, int y) const
{
  std::uint8_t const* const pixel = const_cast<Picture*>(this)->row(x, y);
  return {pixel[0], pixel[1], pixel[2]};
}

void Picture::fill(Rectangle area, Colour colour)
{
  area = common(area, {0, 0, width_, height_});
  for (int y = area.top; y < area.bottom; ++y) {
    std::uint8_t* pixel = row(area.left, y);
    for (int x = area.left; x < area.right; ++x) {
      *pixel++ = colour.red;
      *pixel++ = colour.green;
      *pixel++ = colour.blue;
    }
  }
}

void Picture::write(int left, int top, std::string_view text, int unit, Colour colour)
{
  for (char const letter : text) {
    if (char const* const dots = dots_of(letter))
      for (int dot = 0; dot < 5 * letter_height; ++dot)
        if (dots[dot] != ' ') {
          int const x = left + dot % 5 * unit, y = top + dot / 5 * unit;
          fill({x, y, x + unit, y + unit}, colour);
        }
    left += letter_advance * unit;
  }
}

int text_width(std::string_view text, int unit)
{
  return text.empty() ? 0 : (static_cast<int>(text.size()) * letter_advance - 1) * unit;
}

std::string as_png(Picture const& picture)
{
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width());
  image.height = static_cast<png_uint_32>(picture.height());
  image.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string file(size, '\0');
  if (!png_image_write_to_memory(&image, file.data(), &size, 0, picture.bytes().data(), 0, nullptr))
    throw Failure(Exit::internal, std::string("libpng cannot make a picture: ") + image.message);
  file.resize(size);
  return file;
}

} // namespace ricochet::driver
