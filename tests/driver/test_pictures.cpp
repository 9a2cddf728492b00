// Pictures: a disc has its area, place and colour, whatever its size and the order of the discs.
#include "exit_codes.hpp"
#include "pictures/disc_painter.hpp"
#include "pictures/frame_painter.hpp"
#include "pictures/look.hpp"
#include "pictures/picture.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

namespace ricochet::driver {
namespace {

constexpr double pi = 3.14159265358979323846;

Stage stage_of(double width, double height, double radius, std::int64_t discs)
{
  Stage stage;
  stage.box.width = width;
  stage.box.height = height;
  stage.radius = radius;
  stage.discs = discs;
  stage.has_velocities = true;
  stage.fast = 10;
  return stage;
}

Look classic()
{
  Look look;
  look.style = Style::classic;
  return look;
}

Picture painted(Stage const& stage, Look const& look, std::vector<DiscState> const& discs)
{
  return FramePainter(stage, look).paint(0, discs);
}

// What there is of red on black, in pixels, and its centre.
struct Red {
  double area = 0, x = 0, y = 0;
};

Red red_of(Picture const& picture)
{
  Red red;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      double const share = picture.at(x, y).red / 255.0;
      red.area += share;
      red.x += share * (x + 0.5);
      red.y += share * (y + 0.5);
    }
  red.x /= red.area;
  red.y /= red.area;
  return red;
}

// Places that are in no simple relation to pixels.
std::vector<DiscState> scattered(int count, double width, double height)
{
  std::vector<DiscState> discs;
  for (int i = 0; i < count; ++i)
    discs.push_back({(std::fmod(i * 0.754877666, 1) - 0.5) * width,
                     (std::fmod(i * 0.569840296, 1) - 0.5) * height, i % 11 * 1.0, 0});
  return discs;
}

// The same by another way: a pixel is covered as far as 16 x 16 points in it are.
Picture sampled(Stage const& stage, std::vector<DiscState> const& discs)
{
  auto const width = static_cast<int>(stage.box.width), height = static_cast<int>(stage.box.height);
  Picture picture(width, height, {0, 0, 0});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      int inside = 0;
      for (int point = 0; point < 256; ++point) {
        double const px = x + (point % 16 + 0.5) / 16 - stage.box.width / 2;
        int const line = point / 16;
        double const py = stage.box.height / 2 - y - (line + 0.5) / 16;
        inside += std::any_of(discs.begin(), discs.end(), [&](DiscState const& d) {
          return std::hypot(px - d.x, py - d.y) < stage.radius;
        });
      }
      picture.fill({x, y, x + 1, y + 1}, {static_cast<std::uint8_t>(inside * 255 / 256), 0, 0});
    }
  return picture;
}

// The classic style has a pixel a length here. Coverage is rounded to 1/4096 and 1/255: with the
// about 4 + 7 r pixels at the edge of a disc, each off by 1/255 at most, that bounds the sum. The
// exact area of a disc in a pixel differs from what is painted by place; 16 places average that
// out.
TEST(Pictures, ADiscCoversItsAreaWhateverItsSize)
{
  for (double const radius : {0.1, 0.3, 0.49, 0.51, 0.8, 1.3, 4.0, 13.0}) {
    SCOPED_TRACE(radius);
    double area = 0;
    for (DiscState const& disc : scattered(16, 8, 8))
      area += red_of(painted(stage_of(64, 64, radius, 1), classic(), {disc})).area / 16;
    EXPECT_NEAR(area, pi * radius * radius, (4 + 7 * radius) / 255 / 2 + 0.004 * radius);
  }
}

// Coverage that falls linearly at the edge moves the centre by a few hundredths of a pixel.
TEST(Pictures, ADiscIsWhereItIs)
{
  for (double const radius : {0.45, 2.2, 9.0})
    for (DiscState const& disc : scattered(7, 40, 30)) {
      Red const red = red_of(painted(stage_of(64, 48, radius, 1), classic(), {disc}));
      EXPECT_NEAR(red.x, disc.x + 32, 0.04) << radius;
      EXPECT_NEAR(red.y, 24 - disc.y, 0.04) << radius;
    }
}

// Painted coverage is linear in the distance from the edge; the exact one is at most 0.1 away from
// that for radii above 2 (a pixel cut along its diagonal), and 0.01 on the average over a picture.
TEST(Pictures, AgreeWithASampledPicture)
{
  for (double const radius : {2.5, 6.0}) {
    Stage const stage = stage_of(90, 70, radius, 9);
    auto const discs = scattered(9, 90, 70);
    Picture const ours = painted(stage, classic(), discs), theirs = sampled(stage, discs);
    double sum = 0;
    for (int y = 0; y < ours.height(); ++y)
      for (int x = 0; x < ours.width(); ++x) {
        double const difference = std::abs(ours.at(x, y).red - theirs.at(x, y).red) / 255.0;
        EXPECT_LT(difference, 0.12) << x << " " << y;
        sum += difference;
      }
    EXPECT_LT(sum / (90 * 70), 0.01);
  }
}

TEST(Pictures, TheOrderOfDiscsDoesNotShow)
{
  for (double const radius : {0.4, 3.0, 40.0}) {
    auto discs = scattered(3000, 200, 150);
    Look look;
    look.size = PictureSize{400, 300};
    Picture const there = painted(stage_of(200, 150, radius, 3000), look, discs);
    std::reverse(discs.begin(), discs.end());
    EXPECT_EQ(painted(stage_of(200, 150, radius, 3000), look, discs).bytes(), there.bytes());
  }
}

TEST(Pictures, OnAPeriodicAxisADiscIsSeenAtBothEnds)
{
  Stage stage = stage_of(60, 60, 6, 1);
  stage.box.x = stage.box.y = Boundary::periodic;
  double const area = red_of(painted(stage, classic(), {{0, 0, 0, 0}})).area;
  for (DiscState const disc : {DiscState{-30, 4, 0, 0}, {3, 28, 0, 0}, {-29, -29, 0, 0}})
    EXPECT_NEAR(red_of(painted(stage, classic(), {disc})).area, area, 0.2);
  stage.box.x = stage.box.y = Boundary::walls;
  EXPECT_NEAR(red_of(painted(stage, classic(), {{-30, 4, 0, 0}})).area, area / 2, 0.2);
}

TEST(Pictures, ColourTellsSpeedOrId)
{
  Stage const stage = stage_of(100, 100, 10, 3);
  std::vector<DiscState> const discs{{-30, 0, 0, 0}, {0, 0, 3, 4}, {30, 0, 0, -20}};
  auto const middles = [&](Look const& look) {
    FramePainter painter(stage, look);
    Picture const& picture = painter.paint(0, discs);
    std::vector<int> green;
    for (DiscState const& d : discs)
      green.push_back(picture
                          .at(static_cast<int>(painter.layout().pixel_x(d.x)),
                              static_cast<int>(painter.layout().pixel_y(d.y)))
                          .green);
    return green;
  };
  auto const map = [](std::size_t i) { return static_cast<int>(colour_map()[i].green); };
  Look look; // the scale of speeds ends at stage.fast = 10
  EXPECT_EQ(middles(look), (std::vector<int>{map(0), map(128), map(255)}));
  look.top_speed = 5.01;
  EXPECT_EQ(middles(look), (std::vector<int>{map(0), map(255), map(255)}));
  look.colouring = Colouring::id;
  EXPECT_EQ(middles(look), (std::vector<int>{map(0), map(127), map(255)}));
}

TEST(Pictures, TheColourMapIsViridisAndGetsLighter)
{
  auto const& map = colour_map();
  EXPECT_EQ(map[0].blue, 0x54);
  EXPECT_EQ(map[255].red, 0xfd);
  EXPECT_NEAR(map[128].green, 0x90, 1); // 33, 144, 140 in the middle, as published
  auto const lightness = [](Colour c) {
    return 0.2126 * c.red + 0.7152 * c.green + 0.0722 * c.blue;
  };
  for (std::size_t i = 8; i < map.size(); i += 8)
    EXPECT_GT(lightness(map[i]), lightness(map[i - 8])) << i;
}

TEST(Pictures, DiscsThatAreNowhereAreNotSeen)
{
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(),
                   inf = std::numeric_limits<double>::infinity();
  Stage const stage = stage_of(50, 50, 3, 4);
  Picture const nothing = painted(stage, {}, {});
  EXPECT_EQ(painted(stage, {}, {{nan, 0, 0, 0}, {0, inf, 0, 0}, {1e300, 0, 0, 0}, {0, -1e9, 0, 0}})
                .bytes(),
            nothing.bytes());
  EXPECT_NE(painted(stage, {}, {{0, 0, nan, inf}}).bytes(), nothing.bytes());
}

TEST(Pictures, ARegionIsMagnified)
{
  Look look = classic();
  look.size = PictureSize{80, 80};
  look.region = Region{10, 10, 20, 20}; // 8 pixels a length
  Red const red = red_of(painted(stage_of(100, 100, 2, 1), look, {{13, 16, 0, 0}}));
  EXPECT_NEAR(red.area, pi * 16 * 16, 0.5);
  EXPECT_NEAR(red.x, 24, 0.02);
  EXPECT_NEAR(red.y, 32, 0.02);
}

// The next picture of a painter holds nothing of the one before.
TEST(Pictures, ArePaintedAnew)
{
  Stage const stage = stage_of(80, 60, 5, 1);
  FramePainter painter(stage, {});
  painter.paint(1.5, {{10, 10, 1, 0}});
  Picture const second = painter.paint(0, {{-20, 5, 2, 0}});
  EXPECT_EQ(second.bytes(), painted(stage, {}, {{-20, 5, 2, 0}}).bytes());
}

TEST(Pictures, OfAnySizeThatLeavesRoom)
{
  Stage const stage = stage_of(1000, 10, 1, 1);
  EXPECT_EQ(arrange({}, stage).width, 1920);
  EXPECT_GE(arrange({}, stage).height, 360);
  EXPECT_EQ(arrange({}, stage_of(10, 1000, 1, 1)).height, 1080);
  Look look;
  for (PictureSize const size : {PictureSize{200, 100}, {16384, 17}, {320, 2000}}) {
    look.size = size;
    if (size.height > 28) {
      Picture const picture = painted(stage, look, {{0, 0, 0, 0}});
      EXPECT_EQ(picture.width(), size.width);
      EXPECT_EQ(picture.height(), size.height);
    } else {
      EXPECT_THROW(arrange(look, stage), Failure);
    }
  }
}

TEST(Pictures, APngHoldsEveryPixel)
{
  Picture const picture = painted(stage_of(30, 20, 2, 50), {}, scattered(50, 30, 20));
  std::string const file = as_png(picture);
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  ASSERT_TRUE(png_image_begin_read_from_memory(&image, file.data(), file.size()));
  EXPECT_EQ(static_cast<int>(image.width), picture.width());
  EXPECT_EQ(static_cast<int>(image.height), picture.height());
  image.format = PNG_FORMAT_RGB;
  std::vector<std::uint8_t> bytes(PNG_IMAGE_SIZE(image));
  ASSERT_TRUE(png_image_finish_read(&image, nullptr, bytes.data(), 0, nullptr));
  EXPECT_EQ(bytes, picture.bytes());
}

TEST(Pictures, LettersAreWrittenInFull)
{
  for (char const letter : std::string("0123456789.-+=etspdi")) {
    Picture picture(5, 7, {0, 0, 0});
    picture.write(0, 0, std::string(1, letter), 1, {255, 255, 255});
    int lit = 0;
    for (std::uint8_t const byte : picture.bytes())
      lit += byte / 255;
    EXPECT_GE(lit, 3 * 4) << letter;
  }
}

TEST(Pictures, LengthsOnTheScaleAreRound)
{
  for (auto const& [value, round] :
       {std::pair{1.0, 1.0}, {1.99, 1.0}, {2.0, 2.0}, {73.0, 50.0}, {0.4, 0.2}, {9999.0, 5000.0}})
    EXPECT_DOUBLE_EQ(round_below(value), round);
}

} // namespace
} // namespace ricochet::driver
