// What is left when a run is killed or the disk is full.
#include "process.hpp"
#include "trajectory_reader.hpp"

#include "exit_codes.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <thread>

namespace ricochet::test {
namespace {

using driver::TrajectoryReader;

// Every frame must be one step from the one before, for every disc: position and velocity of a disc
// that meets nothing are x' = x + v' dt. Most discs of a dilute gas meet nothing in a step.
void expect_continuity(TrajectoryReader const& file)
{
  double const dt = file.parameter("dt").value();
  std::int64_t const n = file.discs();
  std::vector<DiscState> before, after;
  file.read_states(0, before);
  for (std::int64_t frame = 1; frame < file.frames(); ++frame) {
    ASSERT_EQ(file.steps()[static_cast<std::size_t>(frame)], frame);
    file.read_states(frame, after);
    std::int64_t free = 0;
    for (std::size_t i = 0; i < after.size(); ++i) {
      double const error = std::abs(after[i].x - before[i].x - after[i].vx * dt) +
                           std::abs(after[i].y - before[i].y - after[i].vy * dt);
      free += error < 1e-9;
    }
    ASSERT_GT(free, n * 3 / 4) << "frame " << frame;
    std::swap(before, after);
  }
}

TEST(Crash, AKilledRunLeavesEveryFlushedFrame)
{
  for (std::string const compression : {"none", "deflate"}) {
    Folder const folder;
    Process run({scene("gas_2000.csv"), scene("gas_2000.config.csv"), "--steps", "1000000", "-o",
                 folder / "t.h5md", "--compress", compression, "--quiet"});
    // Frames that a reader saw while the run went on must be there after the kill.
    std::int64_t seen = 0;
    for (int tries = 0; tries < 600 && seen < 60 && run.is_running(); ++tries) {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      try {
        if (std::filesystem::exists(folder / "t.h5md"))
          seen = TrajectoryReader(folder / "t.h5md").frames();
      } catch (driver::Failure const&) {
        // Read amid a flush; only after the kill must the file be whole.
      }
    }
    ASSERT_TRUE(run.is_running()) << run.wait().err;
    ASSERT_GE(seen, 60);
    run.kill();
    EXPECT_EQ(run.wait().code, 128 + 9);

    TrajectoryReader const file(folder / "t.h5md");
    EXPECT_GE(file.frames(), seen);
    EXPECT_EQ(file.observable("kinetic").size(), static_cast<std::size_t>(file.frames()));
    expect_continuity(file);
    Outcome const info = ricochet({"info", folder / "t.h5md"});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_NE(info.out.find("unfinished"), std::string::npos) << info.out;
  }
}

TEST(Crash, AFullDiskEndsWithASentenceAndAReadableFile)
{
  Folder const reference;
  std::vector<std::string> const run{scene("gas_2000.csv"), scene("gas_2000.config.csv"), "--steps",
                                     "60", "--quiet"};
  auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    return more;
  };
  ASSERT_EQ(ricochet(with({"-o", reference / "t.h5md"})).code, 0);
  TrajectoryReader const whole(reference / "t.h5md");
  std::vector<double> expected(2000), found(2000);

  int partly_written = 0;
  for (std::int64_t limit = 50000; limit < 4000000; limit += 390001) {
    Folder const folder;
    ProcessOptions options;
    options.file_size_limit = limit;
    Outcome const outcome =
        ricochet(with({"-o", folder / "t.h5md", "--final", folder / "f.csv"}), options);
    EXPECT_EQ(outcome.code, 74) << limit;
    EXPECT_NE(outcome.err.find("cannot write trajectory"), std::string::npos) << outcome.err;
    EXPECT_NE(outcome.err.find("File too large"), std::string::npos) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "f.csv"));
    if (!std::filesystem::exists(folder / "t.h5md"))
      continue; // not even its head could be written
    TrajectoryReader const file(folder / "t.h5md");
    partly_written += file.frames() > 0;
    for (std::int64_t frame = 0; frame < file.frames(); ++frame) {
      for (int component = 0; component < 2; ++component) {
        file.read("velocity", component, frame, 0, 2000, found.data());
        whole.read("velocity", component, frame, 0, 2000, expected.data());
        ASSERT_EQ(found, expected) << "limit " << limit << " frame " << frame;
      }
    }
  }
  EXPECT_GT(partly_written, 3);
}

TEST(Crash, TextResultsAreWholeOrAbsent)
{
  Folder const folder;
  ProcessOptions options;
  options.file_size_limit = 1000;
  Outcome const outcome =
      ricochet({scene("gas_2000.csv"), "--steps", "1", "--final", folder / "f.csv", "-q"}, options);
  EXPECT_EQ(outcome.code, 74) << outcome.err;
  EXPECT_TRUE(folder.names().empty());
}

TEST(Crash, AStandardOutputThatIsFullIsAnError)
{
  ProcessOptions options;
  options.standard_output = "/dev/full";
  EXPECT_EQ(ricochet({scene("head_on.csv"), scene("head_on.config.csv"), "-q"}, options).code, 74);
  EXPECT_EQ(ricochet({"--help"}, options).code, 74);
}

} // namespace
} // namespace ricochet::test
