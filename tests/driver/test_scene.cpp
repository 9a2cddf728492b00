// A scene as a whole: files, options, steps and frames.
#include "scene.hpp"

#include "exit_codes.hpp"
#include "process.hpp"
#include "run.hpp"

#include <gtest/gtest.h>

namespace ricochet::driver {
namespace {

using test::Folder;

SceneOptions options_for(std::string const& states, std::string const& config = "")
{
  return {states, config, {}};
}

TEST(Scene, StepsAreDurationTimesFpsExactly)
{
  Folder const folder;
  auto options =
      options_for(folder.write("s.csv", "0,0,1,1"), folder.write("c.csv", "fps=45,totTime=60"));
  EXPECT_EQ(read_scene(options).steps, 2700);
  EXPECT_EQ(read_scene(options).method.dt, 1.0 / 45);
}

TEST(Scene, AWholeNumberOfStepsSurvivesRounding)
{
  EXPECT_EQ(whole_steps(60, 1.0 / 45), 2700);
  EXPECT_EQ(whole_steps(0.3, 0.1), 3); // 0.3 / 0.1 is 2.9999999999999996
  EXPECT_EQ(whole_steps(0, 0.1), 0);
  for (std::int64_t n = 1; n < 3000; ++n)
    for (double const dt : {1.0 / 45, 1.0 / 60, 0.01, 1e-3, 0.7}) {
      EXPECT_EQ(whole_steps(static_cast<double>(n) * dt, dt), n);
      EXPECT_EQ(whole_steps(static_cast<double>(n) / 45, 1.0 / 45), n);
    }
}

TEST(Scene, AFractionOfAStepIsRefused)
{
  EXPECT_EQ(whole_steps(1, 0.3), std::nullopt);
  EXPECT_EQ(whole_steps(0.001, 1), std::nullopt);
  EXPECT_EQ(whole_steps(1e6 + 1e-6, 1), std::nullopt);
  EXPECT_EQ(whole_steps(1e300, 1e-300), std::nullopt);

  Folder const folder;
  auto options = options_for(folder.write("s.csv", ""));
  options.overrides = {{"--dt", "run.dt", "0.007"}};
  try {
    read_scene(options);
    FAIL();
  } catch (Failure const& failure) {
    EXPECT_EQ(failure.code(), Exit::usage);
    EXPECT_STREQ(failure.what(),
                 "--dt: run.duration 60 is not a whole number of steps (dt = 0.007 gives "
                 "8571.428571) dt = 0.007000350017500875 makes it 8571");
  }
}

TEST(Scene, ProblemsOfBothFilesAreToldAtOnce)
{
  Folder const folder;
  std::string const states = folder.write("s.csv", "1,2,3\nx,2,3,4\n");
  std::string const config = folder.write("c.csv", "fps=0,alhpa=1");
  try {
    read_scene(options_for(states, config));
    FAIL();
  } catch (BadScene const& problems) {
    EXPECT_EQ(problems.code(), Exit::bad_data);
    std::string const text = problems.what();
    for (std::string const& start :
         {config + ":1:1: ", config + ":1:7: ", states + ":1:1: ", states + ":2:1: "})
      EXPECT_NE(text.find(start), std::string::npos) << start << "\n" << text;
  }
}

TEST(Scene, FramesAreEveryKthAndTheLast)
{
  EXPECT_EQ(planned_frames(0, 1), 1);
  EXPECT_EQ(planned_frames(10, 1), 11);
  EXPECT_EQ(planned_frames(10, 5), 3);
  EXPECT_EQ(planned_frames(10, 4), 4);
  EXPECT_EQ(planned_frames(3, 100), 2);
}

} // namespace
} // namespace ricochet::driver
