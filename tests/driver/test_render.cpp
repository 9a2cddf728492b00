// ricochet render as a process: what it writes, and what it says when it cannot.
#include "exit_codes.hpp"
#include "jobs.hpp"
#include "pictures/frame_source.hpp"
#include "pictures/render.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <algorithm>
#include <sys/stat.h>

namespace ricochet::test {
namespace {

using driver::RenderOptions;

// Eleven frames, at times 0, 0.5 ... 5.
std::string trajectory(Folder const& folder, std::vector<std::string> const& more = {})
{
  auto const states = folder.write("s.csv", "-40,0,60,0\n40,0,-60,0\n0,200,0,30\n");
  std::vector<std::string> arguments{states, "--dt", "0.5", "--steps",
                                     "10",   "-q",   "-o",  folder / "t.h5md"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  EXPECT_EQ(ricochet(arguments).code, 0);
  return folder / "t.h5md";
}

std::pair<int, int> size_of(std::string const& path)
{
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  EXPECT_TRUE(png_image_begin_read_from_file(&image, path.c_str())) << path;
  std::pair<int, int> const size(image.width, image.height);
  png_image_free(&image);
  return size;
}

TEST(Render, AStillAndASeries)
{
  Folder const folder;
  auto const t = trajectory(folder);
  Outcome const still =
      ricochet({"render", t, "-o", folder / "a.png", "--frame", "-1", "--size", "320x200"});
  EXPECT_EQ(still.code, 0) << still.err;
  EXPECT_EQ(still.out, "");
  EXPECT_TRUE(contains(still.err, "1 frame of 320x200"));
  EXPECT_EQ(size_of(folder / "a.png"), std::pair(320, 200));

  Outcome const series = ricochet(
      {"render", t, "-o", folder / "b.png", "--every", "5", "--size", "320x200", "--quiet"});
  EXPECT_EQ(series.code, 0);
  EXPECT_EQ(series.err, "");
  for (char const* name : {"b_000000.png", "b_000001.png", "b_000002.png"})
    EXPECT_EQ(size_of(folder / name), std::pair(320, 200));
  EXPECT_EQ(folder.names().size(), 6U);
  EXPECT_EQ(text_of(folder / "b_000002.png"), text_of(folder / "a.png"));
}

TEST(Render, TheClassicStyleIsAPixelALength)
{
  Folder const folder;
  EXPECT_EQ(ricochet({"render", trajectory(folder), "-o", folder / "a.png", "--frame", "0",
                      "--style", "classic"})
                .code,
            0);
  EXPECT_EQ(size_of(folder / "a.png"), std::pair(740, 740));
}

TEST(Render, ThePictureIsTheSameForAnyNumberOfThreads)
{
  Folder const folder;
  std::string one;
  for (char const* threads : {"1", "2", "3"}) {
    ASSERT_EQ(ricochet({"render", scene("gas_2000.csv"), "-o", folder / "a.png", "--frame", "0",
                        "--force", "--threads", threads})
                  .code,
              0);
    one = one.empty() ? text_of(folder / "a.png") : one;
    EXPECT_EQ(text_of(folder / "a.png"), one) << threads;
  }
}

TEST(Render, ASceneIsSimulatedOnTheWay)
{
  Folder const folder;
  auto const t = trajectory(folder);
  std::vector<std::string> const size{"--frame", "7", "--size", "300x200", "--top-speed", "60"};
  std::vector<std::string> from_file{"render", t, "-o", folder / "a.png"};
  std::vector<std::string> from_scene{"render", folder / "s.csv", "--set", "run.dt=0.5",
                                      "--set",  "run.steps=10",   "-o",    folder / "b.png"};
  for (auto* const arguments : {&from_file, &from_scene}) {
    arguments->insert(arguments->end(), size.begin(), size.end());
    Outcome const outcome = ricochet(*arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
  }
  EXPECT_EQ(text_of(folder / "a.png"), text_of(folder / "b.png"));
}

TEST(Render, ADenseSceneIsMeltedAsForARun)
{
  Folder const folder;
  auto const dense = folder.write("s.toml", "[box]\nwidth = 90\nheight = 90\n[discs]\nradius = 3\n"
                                            "[discs.generate]\npacking_fraction = 0.6\n"
                                            "[run]\nengine = \"events\"\ndt = 0.1\nsteps = 2\n");
  ASSERT_EQ(ricochet({"run", dense, "-o", folder / "t.h5md", "-q"}).code, 0);
  for (char const* frame : {"0", "2"}) {
    for (auto const& [input, output] :
         {std::pair(folder / "t.h5md", folder / "a.png"), std::pair(dense, folder / "b.png")}) {
      Outcome const outcome = ricochet({"render", input, "-o", output, "--frame", frame, "--size",
                                        "300x200", "--top-speed", "3", "--force"});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
    }
    EXPECT_EQ(text_of(folder / "a.png"), text_of(folder / "b.png")) << "frame " << frame;
  }
}

TEST(Render, WithoutVelocitiesThereIsOneColour)
{
  Folder const folder;
  auto const t = trajectory(folder, {"--fields", "position"});
  EXPECT_EQ(ricochet({"render", t, "-o", folder / "a.png", "--frame", "0"}).code, 0);
  Outcome const outcome =
      ricochet({"render", t, "-o", folder / "b.png", "--frame", "0", "--colour", "speed"});
  EXPECT_EQ(outcome.code, 64);
  EXPECT_TRUE(contains(outcome.err, "no velocities")) << outcome.err;
}

TEST(Render, WrongOptionsAreRefused)
{
  Folder const folder;
  auto const t = trajectory(folder);
  std::vector<std::vector<std::string>> const wrong{
      {},
      {"-o", folder / "a.jpg"},
      {"-o", folder / "a.mp4", "--frame", "1"},
      {"-o", folder / "a.png", "--frame", "11"},
      {"-o", folder / "a.png", "--frame", "-12"},
      {"-o", folder / "a.png", "--frame", "1", "--rate", "1"},
      {"-o", folder / "a.png", "--size", "320"},
      {"-o", folder / "a.png", "--size", "0x9"},
      {"-o", folder / "a.png", "--size", "64x64"},
      {"-o", folder / "a.png", "--region", "1,2,1,3"},
      {"-o", folder / "a.png", "--region", "1,2,3"},
      {"-o", folder / "a.png", "--colour", "mass"},
      {"-o", folder / "a.png", "--rate", "1e-9"},
      {"-o", folder / "a.png", "--set", "run.dt=1"},
  };
  for (auto const& options : wrong) {
    std::vector<std::string> arguments{"render", t};
    arguments.insert(arguments.end(), options.begin(), options.end());
    Outcome const outcome = ricochet(arguments);
    EXPECT_EQ(outcome.code, 64) << outcome.err;
    EXPECT_FALSE(outcome.err.empty());
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"s.csv", "t.h5md"}));
  EXPECT_EQ(ricochet({"render", folder / "none.h5md", "-o", folder / "a.png"}).code, 66);
}

TEST(Render, NothingIsReplacedUnasked)
{
  Folder const folder;
  auto const t = trajectory(folder);
  auto const old = folder.write("a_000003.png", "old");
  EXPECT_EQ(ricochet({"render", t, "-o", folder / "a.png"}).code, 73);
  EXPECT_EQ(text_of(old), "old");
  EXPECT_EQ(folder.names().size(), 3U);
  EXPECT_EQ(ricochet({"render", t, "-o", folder / "a.png", "--force", "--size", "320x200"}).code,
            0);
  EXPECT_EQ(size_of(old), std::pair(320, 200));
}

TEST(Render, WithoutFfmpegThePicturesOfAMovieAreWritten)
{
  Folder const folder;
  auto const t = trajectory(folder);
  Outcome const outcome =
      ricochet({"render", t, "-o", folder / "m.mp4", "--size", "320x200", "--fps", "12"},
               {{"PATH=" + folder.path()}, -1, ""});
  EXPECT_EQ(outcome.code, 1);
  EXPECT_TRUE(contains(outcome.err, "install the package ffmpeg")) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "ffmpeg -r 12 -i " + folder.path() + "/m_%06d.png"))
      << outcome.err;
  EXPECT_EQ(folder.names().size(), 2U + 11U);
}

// A program in its stead that says why it fails.
TEST(Render, AnFfmpegThatFailsLeavesNoMovie)
{
  Folder const folder;
  auto const t = trajectory(folder);
  auto const ffmpeg = folder.write("ffmpeg", "#!/bin/sh\necho no such codec >&2\nexit 3\n");
  ::chmod(ffmpeg.c_str(), 0700);
  Outcome const outcome =
      ricochet({"render", t, "-o", folder / "m.mp4"}, {{"PATH=" + folder.path()}, -1, ""});
  EXPECT_EQ(outcome.code, 74);
  EXPECT_TRUE(contains(outcome.err, "ffmpeg failed: no such codec")) << outcome.err;
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"ffmpeg", "s.csv", "t.h5md"}));
}

// A program in its stead that keeps what it is given: every frame arrives whole.
TEST(Render, FfmpegIsGivenEveryFrame)
{
  Folder const folder;
  auto const t = trajectory(folder);
  auto const ffmpeg =
      folder.write("ffmpeg", "#!/bin/sh\nfor last; do :; done\ncat > \"${last#file:}\"\n");
  ::chmod(ffmpeg.c_str(), 0700);
  Outcome const outcome = ricochet({"render", t, "-o", folder / "m.mp4", "--size", "320x200"},
                                   {{"PATH=" + folder.path() + ":/bin:/usr/bin"}, -1, ""});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(text_of(folder / "m.mp4").size(), 320U * 200 * 3 * 11);
}

TEST(Render, APageIsOneFileThatNeedsNoOther)
{
  Folder const folder;
  Outcome const outcome = ricochet({"render", trajectory(folder), "--html", folder / "p.html", "-o",
                                    folder / "a.png", "--frame", "3"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "p.html: 1 frame, 0.0 MB")) << outcome.err;
  std::string const page = text_of(folder / "p.html");
  EXPECT_TRUE(contains(page, "\"discs\":3,"));
  EXPECT_TRUE(contains(page, "</html>"));
  for (char const* elsewhere : {"http", "src=", "href=", "import", "<!--"})
    EXPECT_FALSE(contains(page, elsewhere)) << elsewhere;
  EXPECT_EQ(ricochet({"render", folder / "t.h5md", "--html", folder / "p.html"}).code, 73);
  EXPECT_EQ(text_of(folder / "p.html"), page);
}

TEST(Render, FramesAreChosenByRateOrNumber)
{
  Folder const folder;
  driver::SceneOptions input;
  input.file = trajectory(folder);
  auto const source = driver::open_frames(input, driver::Purpose::run);
  RenderOptions options;
  using Frames = std::vector<std::int64_t>;
  options.every = 4;
  EXPECT_EQ(chosen_frames(options, *source), (Frames{0, 4, 8}));
  options.every = 1;
  options.fps = 2;
  options.rate = 2; // a frame a time unit
  EXPECT_EQ(chosen_frames(options, *source), (Frames{0, 2, 4, 6, 8, 10}));
  options.rate = 0.5; // twice as many as there are
  EXPECT_EQ(chosen_frames(options, *source).size(), 21U);
  EXPECT_EQ(chosen_frames(options, *source)[5], 2);
  options.rate = 100;
  EXPECT_EQ(chosen_frames(options, *source), (Frames{0}));
}

} // namespace
} // namespace ricochet::test
