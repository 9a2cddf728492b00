// What keys do in a window, and that watching a run does not change it.
#include "pictures/frame_source.hpp"
#include "pictures/viewer.hpp"
#include "process.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace ricochet::driver {
namespace {

using Kind = Input::Kind;

// Does what a list says, one thing whenever it is asked while nothing else is to come, and keeps
// what it is shown.
class ScriptedWindow : public Window {
 public:
  explicit ScriptedWindow(std::vector<Input> script) : script_(std::move(script)) {}

  void show(Picture const& picture) override { shown.push_back(picture.bytes()); }
  std::vector<Input> inputs(double seconds) override
  {
    if (seconds < 60) // the next frame comes before the user does anything
      return {};
    Input const next = at_ < script_.size() ? script_[at_] : Input{Kind::quit};
    ++at_;
    return {next};
  }

  std::vector<std::vector<std::uint8_t>> shown;

 private:
  std::vector<Input> script_;
  std::size_t at_ = 0;
};

// A disc that moves to the right, one length a frame.
class Crossing : public FrameSource {
 public:
  Crossing()
  {
    stage_.box.width = stage_.box.height = 100;
    stage_.radius = 5;
    stage_.discs = 1;
    stage_.has_velocities = true;
    stage_.fast = 2;
    stage_.interval = 1;
  }
  std::int64_t frames() const override { return 21; }
  double time(std::int64_t frame) const override { return static_cast<double>(frame); }
  void read(std::int64_t frame, std::vector<DiscState>& discs) override
  {
    discs = {{static_cast<double>(frame) - 10, 0, 1, 0}};
  }
};

Look small()
{
  Look look;
  look.size = PictureSize{240, 160};
  return look;
}

std::vector<std::uint8_t> picture_of(std::int64_t frame, Look const& look = small())
{
  Crossing source;
  std::vector<DiscState> discs;
  source.read(frame, discs);
  return FramePainter(source.stage(), look).paint(source.time(frame), discs).bytes();
}

// What is shown after the film has run to its end and the user has done `script`.
std::vector<std::uint8_t> after(std::vector<Input> const& script)
{
  Crossing source;
  std::vector<std::int64_t> frames;
  for (std::int64_t frame = 0; frame < source.frames(); ++frame)
    frames.push_back(frame);
  ScriptedWindow window(script);
  play(source, frames, small(), 1e6, window);
  return window.shown.back();
}

TEST(Viewer, PlaysEveryFrameToTheLast)
{
  Crossing source;
  ScriptedWindow window({});
  play(source, {0, 5, 10, 20}, small(), 1e6, window);
  ASSERT_EQ(window.shown.size(), 4U);
  std::size_t at = 0;
  for (std::int64_t const frame : {0, 5, 10, 20})
    EXPECT_EQ(window.shown[at++], picture_of(frame)) << frame;
}

TEST(Viewer, KeysSeekAndStep)
{
  EXPECT_EQ(after({}), picture_of(20));
  EXPECT_EQ(after({{Kind::first}}), picture_of(0));
  EXPECT_EQ(after({{Kind::back}, {Kind::back}}), picture_of(18));
  EXPECT_EQ(after({{Kind::first}, {Kind::back}, {Kind::forward}}), picture_of(1));
  EXPECT_EQ(after({{Kind::first}, {Kind::ahead}}), picture_of(3));
  EXPECT_EQ(after({{Kind::behind}}), picture_of(17));
  EXPECT_EQ(after({{Kind::first}, {Kind::last}}), picture_of(20));
  EXPECT_EQ(after({{Kind::play}}), picture_of(20)); // once more, to the end
}

TEST(Viewer, ColoursChangeInACircle)
{
  Look look = small();
  look.colouring = Colouring::id;
  EXPECT_EQ(after({{Kind::colours}}), picture_of(20, look));
  look.colouring = Colouring::none;
  EXPECT_EQ(after({{Kind::colours}, {Kind::colours}}), picture_of(20, look));
  EXPECT_EQ(after({{Kind::colours}, {Kind::colours}, {Kind::colours}}), picture_of(20));
}

TEST(Viewer, ZoomKeepsThePlaceOfThePointer)
{
  Crossing source;
  View view(source.stage(), small());
  Layout const before = view.layout();
  Input const zoom{Kind::zoom, before.pixel_x(20), before.pixel_y(-10), 2};
  EXPECT_TRUE(view.obey(zoom));
  EXPECT_NEAR(view.layout().scale, 2 * before.scale, 1e-9);
  EXPECT_NEAR(view.layout().pixel_x(20), zoom.x, 1e-9);
  EXPECT_NEAR(view.layout().pixel_y(-10), zoom.y, 1e-9);
  double const x = view.layout().pixel_x(0), y = view.layout().pixel_y(0);
  EXPECT_TRUE(view.obey({Kind::move, 7, -5}));
  EXPECT_NEAR(view.layout().pixel_x(0), x + 7, 1e-9);
  EXPECT_NEAR(view.layout().pixel_y(0), y - 5, 1e-9);
  EXPECT_TRUE(view.obey({Kind::whole}));
  EXPECT_EQ(view.layout().scale, before.scale);
  EXPECT_FALSE(view.obey({Kind::play}));
}

TEST(Viewer, WatchingDoesNotChangeARun)
{
  test::Folder const folder;
  std::vector<std::string> const run{
      "run", test::scene("gas_2000.csv"), "--steps", "20", "-q", "--force", "--final"};
  auto const with = [&](std::string const& file, std::string const& watching) {
    auto arguments = run;
    arguments.push_back(folder / file);
    if (!watching.empty())
      arguments.push_back(watching);
    return test::ricochet(arguments, {{"SDL_VIDEODRIVER=dummy"}, -1, ""});
  };
  ASSERT_EQ(with("a", "").code, 0);
  for (std::string const watching : {"--window", "--animate", "-animate"}) {
    test::Outcome const outcome = with("b", watching);
    if (has_window()) {
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_EQ(test::text_of(folder / "b"), test::text_of(folder / "a")) << watching;
    } else {
      EXPECT_EQ(outcome.code, 1);
      EXPECT_NE(outcome.err.find("libsdl2-dev"), std::string::npos) << outcome.err;
    }
  }
}

} // namespace
} // namespace ricochet::driver
