// A run that is stopped and goes on is the run that was never stopped.
#include "checkpoint_file.hpp"
#include "jobs.hpp"
#include "trajectory_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <fcntl.h>
#include <filesystem>
#include <sys/stat.h>
#include <unistd.h>

namespace ricochet::test {
namespace {

using driver::TrajectoryReader;
struct Kind {
  std::string engine, precision;
  std::int64_t steps; ///< at first: a signal has a good chance to come before the end
};

std::ostream& operator<<(std::ostream& out, Kind const& kind)
{
  return out << kind.engine << " " << kind.precision;
}

class Resume : public testing::TestWithParam<Kind> {};

// Stopped twice by different requests, on one thread and on two in turn. False if it came to its
// end before that.
bool gives_the_same_result_in_parts(Kind const& kind, std::int64_t steps)
{
  Folder const folder;
  Arguments const scene{write_gas(folder), "--engine", kind.engine,           "--precision",
                        kind.precision,    "--steps",  std::to_string(steps), "-q"};
  Job const whole{folder, "whole", scene}, parts{folder, "parts", scene};
  struct {
    int signal;
    std::string threads;
  } const stops[] = {{SIGUSR1, "2"}, {SIGTERM, "1"}};
  for (auto const& stop : stops) {
    // One that has come farther than the one before listens to signals.
    std::int64_t const before = std::max<std::int64_t>(0, parts.step());
    Process run(parts.resume() + Arguments{"--threads", stop.threads});
    static_cast<void>(eventually(run, [&] { return parts.step() > before; }));
    run.send(stop.signal);
    Outcome const stopped = run.wait();
    if (stopped.code == 0)
      return false;
    EXPECT_EQ(stopped.code, 75) << stopped.err;
    EXPECT_TRUE(contains(stopped.err, "stopped after step")) << stopped.err;
    EXPECT_GT(parts.step(), before);
    EXPECT_LT(parts.step(), steps);
    TrajectoryReader const so_far(parts.trajectory());
    EXPECT_EQ(so_far.frames(), 1 + parts.step() / gas_every);
  }
  for (Arguments const& to_the_end : {whole.run(), parts.resume()}) {
    Outcome const end = ricochet(to_the_end + Arguments{"--threads", "2"});
    EXPECT_EQ(end.code, 0) << end.err;
  }
  expect_equal_results(parts, whole);
  return true;
}

TEST_P(Resume, GivesTheResultOfTheRunThatWasNeverStopped)
{
  // A fast machine, or a busy one, may be through before the signal comes.
  std::int64_t steps = GetParam().steps;
  while (!gives_the_same_result_in_parts(GetParam(), steps) && !HasFailure()) {
    steps *= 4;
    ASSERT_LT(steps, 1000000) << "never stopped";
  }
}

INSTANTIATE_TEST_SUITE_P(
    Engines, Resume,
    testing::Values(Kind{"sweep", "double", 1000}, Kind{"sweep", "single", 1000},
                    Kind{"simultaneous", "double", 600}, Kind{"toi", "double", 1000},
                    Kind{"events", "double", 300}, Kind{"events", "single", 300}),
    [](auto const& kind) { return kind.param.engine + "_" + kind.param.precision; });

Job small_job(Folder const& folder, Arguments const& more = {})
{
  return {folder, "t", Arguments{scene("gas_2000.csv"), scene("gas_2000.config.csv"), "-q"} + more};
}

TEST(Batch, EveryKindOfRequestStopsWithACheckpoint)
{
  struct {
    std::string what;
    ProcessOptions options;
    Arguments arguments;
  } const requests[] = {
      {"end of its time", {{}, -1, ""}, {"--max-walltime", "0:00:01"}},
      {"end of its time", {{"RICOCHET_STOP_AT=1000000000"}, -1, ""}, {}},
      {"STOP", {{}, -1, ""}, {}},
  };
  for (auto const& request : requests) {
    Folder const folder;
    Job const job = small_job(folder, {"--steps", "1000000", "--every", "1000"});
    if (request.what == "STOP")
      folder.write("STOP", "");
    Outcome const outcome = ricochet(job.resume() + request.arguments, request.options);
    EXPECT_EQ(outcome.code, 75) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, request.what)) << outcome.err;
    // However short the time, a job comes farther than the one before.
    std::int64_t const step = job.step();
    EXPECT_GT(step, 0);
    EXPECT_EQ(ricochet(job.resume() + request.arguments, request.options).code, 75);
    EXPECT_GT(job.step(), step);
  }
}

TEST(Batch, AnInterruptStopsWithACheckpointToo)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "1000000", "--every", "1000"});
  Process run(job.resume());
  ASSERT_TRUE(eventually(run, [&] { return job.step() > 10; }));
  run.send(SIGINT);
  EXPECT_EQ(run.wait().code, 75);
}

TEST(Batch, WithoutACheckpointASignalEndsARunWithTheTrajectorySoFar)
{
  for (int const signal : {SIGINT, SIGTERM}) {
    Folder const folder;
    Job const job = small_job(folder, {"--steps", "1000000"});
    Process run(job.run());
    ASSERT_TRUE(eventually(run, [&] { return std::filesystem::exists(job.trajectory()); }));
    run.send(signal);
    Outcome const outcome = run.wait();
    EXPECT_EQ(outcome.code, 128 + signal) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "--checkpoint")) << outcome.err;
    EXPECT_GT(TrajectoryReader(job.trajectory()).frames(), 0);
    EXPECT_FALSE(std::filesystem::exists(job.checkpoint()));
  }
}

TEST(Batch, ACheckpointIsMadeWhenAskedFor)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "1000000", "--every", "1000"});
  Process run(job.run() + Arguments{"--resume", "auto"}); // every quarter of an hour
  ASSERT_TRUE(eventually(run, [&] { return job.step() == 0; }));
  for (std::int64_t before = 0, times = 0; times < 2; ++times) {
    run.send(SIGUSR2);
    ASSERT_TRUE(eventually(run, [&] { return job.step() > before; }));
    before = job.step();
  }
}

// Names, times and contents of the files in a folder.
std::vector<std::string> snapshot(Folder const& folder)
{
  std::vector<std::string> all;
  for (std::string const& name : folder.names()) {
    struct stat status {};
    EXPECT_EQ(::stat((folder / name).c_str(), &status), 0);
    all.push_back(name + " " + std::to_string(status.st_mtim.tv_sec) + "." +
                  std::to_string(status.st_mtim.tv_nsec) + " " + std::to_string(status.st_ino) +
                  " " + text_of(folder / name));
  }
  return all;
}

TEST(Batch, AFinishedJobChangesNoFileAndTellsItsResult)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "100", "--every", "10"});
  ASSERT_EQ(ricochet(job.resume()).code, 0);
  auto const before = snapshot(folder);
  ASSERT_EQ(before.size(), 5u) << "trajectory, states, summary, checkpoint, the one before it";
  Outcome const again = ricochet(job.resume());
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.err, "") << "quiet";
  EXPECT_EQ(snapshot(folder), before);

  // Results that are not there are written from what was recorded.
  std::string const states = text_of(job.states()), json = text_of(job.json());
  std::filesystem::remove(job.states());
  std::filesystem::remove(job.json());
  EXPECT_EQ(ricochet(job.resume()).code, 0);
  EXPECT_EQ(text_of(job.states()), states);
  EXPECT_EQ(text_of(job.json()), json);
  Arguments words{"run",
                  scene("gas_2000.csv"),
                  scene("gas_2000.config.csv"),
                  "--steps",
                  "100",
                  "--every",
                  "10",
                  "-o",
                  job.trajectory(),
                  "--resume",
                  "auto",
                  "--json",
                  "-"};
  Outcome const told = ricochet(words);
  EXPECT_EQ(told.out, json);
  EXPECT_TRUE(contains(told.err, "100 steps of sweep")) << told.err;
}

TEST(Batch, OutputsOfAnotherRunAreRefused)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "20"});
  Job const other = small_job(folder, {"--steps", "20", "--dt", "0.01"});
  ASSERT_EQ(ricochet(job.resume()).code, 0);
  auto const before = snapshot(folder);
  Outcome const refused = ricochet(other.resume());
  EXPECT_EQ(refused.code, 73);
  EXPECT_TRUE(contains(refused.err, "dt = 0.01")) << refused.err;
  EXPECT_EQ(snapshot(folder), before);

  // The same without the checkpoint: the trajectory knows what it is of.
  std::filesystem::remove(job.checkpoint());
  std::filesystem::remove(driver::previous_checkpoint(job.checkpoint()));
  Outcome const trajectory = ricochet(other.resume());
  EXPECT_EQ(trajectory.code, 73);
  EXPECT_TRUE(contains(trajectory.err, "dt = 0.01")) << trajectory.err;
  EXPECT_EQ(ricochet(job.resume()).code, 73) << "states and summary may be anyone's";
  std::filesystem::remove(job.states());
  std::filesystem::remove(job.json());
  EXPECT_EQ(ricochet(job.resume()).code, 0) << "its own trajectory is begun anew";
  EXPECT_EQ(ricochet(other.resume() + Arguments{"--force"}).code, 0);
  EXPECT_TRUE(contains(TrajectoryReader(job.trajectory()).text("identity"), "dt = 0.01"));
}

// The summary of a finished run must not vouch for a trajectory that was begun anew.
TEST(Batch, ACheckpointGoesWithTheTrajectoryThatIsReplaced)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "20"});
  for (int times = 0; times < 2; ++times)
    ASSERT_EQ(ricochet(job.resume() + Arguments{"--force"}).code, 0);
  ASSERT_EQ(folder.names().size(), 5u) << "with the checkpoint and the one before it";
  std::string const other = folder.write("other.chk.h5", "no checkpoint");
  ASSERT_EQ(ricochet(job.run() + Arguments{"--force"}).code, 0);
  EXPECT_EQ(folder.names(), (Arguments{"other.chk.h5", "t.csv", "t.h5md", "t.json"}));
  Job const beside{folder, "other", job.scene};
  ASSERT_EQ(ricochet(beside.run() + Arguments{"--force"}).code, 0);
  EXPECT_EQ(text_of(other), "no checkpoint") << "what is not ours stays";
}

TEST(Batch, ACheckpointThatCountsMoreFramesThanThereAreIsRefused)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "20", "--every", "2"});
  Job const other{folder, "other", job.scene};
  ASSERT_EQ(ricochet(job.resume()).code, 0);
  ProcessOptions late;
  late.environment = {"RICOCHET_STOP_AT=1"};
  ASSERT_EQ(ricochet(other.resume(), late).code, 75);
  std::filesystem::rename(other.trajectory(), job.trajectory());
  Outcome const refused = ricochet(job.resume());
  EXPECT_EQ(refused.code, 73) << refused.err;
  EXPECT_TRUE(contains(refused.err, "of the 11 frames that it counts")) << refused.err;
}

TEST(Batch, InfoTellsWhatACheckpointIsOf)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "20", "--every", "2"});
  ProcessOptions late;
  late.environment = {"RICOCHET_STOP_AT=1"};
  ASSERT_EQ(ricochet(job.resume(), late).code, 75);
  std::string const step = std::to_string(job.step());
  Outcome const unfinished = ricochet({"info", job.checkpoint()});
  EXPECT_EQ(unfinished.code, 0) << unfinished.err;
  EXPECT_TRUE(contains(unfinished.out, "\nstep        " + step + "\n")) << unfinished.out;
  EXPECT_TRUE(contains(unfinished.out, "\nunfinished")) << unfinished.out;
  EXPECT_TRUE(contains(ricochet({"info", job.checkpoint(), "--json", "-"}).out,
                       "\"step\": " + step + ",\n"));
  ASSERT_EQ(ricochet(job.resume()).code, 0);
  Outcome const finished = ricochet({"info", job.checkpoint()});
  EXPECT_TRUE(contains(finished.out, "\nfinished\n")) << finished.out;
  EXPECT_TRUE(contains(finished.out, "state hash")) << finished.out;
  std::filesystem::resize_file(job.checkpoint(), 100);
  EXPECT_EQ(ricochet({"info", job.checkpoint()}).code, 65);
}

TEST(Batch, OtherDiscsAreAnotherRun)
{
  Folder const folder;
  auto const states = folder.write("s.csv", "0,0,1,1\n50,0,-1,0\n");
  Job const job{folder, "t", {states, "--steps", "20", "-q"}};
  ASSERT_EQ(ricochet(job.resume()).code, 0);
  folder.write("s.csv", "0,0,1,1\n50,0,-1,1\n");
  Outcome const refused = ricochet(job.resume());
  EXPECT_EQ(refused.code, 73);
  EXPECT_TRUE(contains(refused.err, "state_hash")) << refused.err;
}

TEST(Batch, TheCheckpointBeforeServesWhereTheLastOneIsDamaged)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "60", "--every", "7"});
  Job const whole{folder, "whole", job.scene};
  ASSERT_EQ(ricochet(whole.run()).code, 0);
  ProcessOptions late;
  late.environment = {"RICOCHET_STOP_AT=1"};
  for (int jobs = 0; jobs < 3; ++jobs)
    ASSERT_EQ(ricochet(job.resume(), late).code, 75);
  std::filesystem::resize_file(job.checkpoint(), 1000);
  Outcome const outcome = ricochet(job.resume());
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "damaged")) << outcome.err;
  expect_equal_results(job, whole);
}

// Wherever the disk is full first: head, frames or checkpoint.
TEST(Batch, AJobGoesOnWhenThereIsRoomAgain)
{
  Folder const reference;
  Arguments const more{"--steps", "60", "--compress", "none"};
  Job const whole = small_job(reference, more);
  ASSERT_EQ(ricochet(whole.run()).code, 0);
  int went_on = 0;
  for (std::int64_t const limit : {3000, 40000, 66000, 400000, 2600000, 3600000}) {
    Folder const folder;
    Job const job = small_job(folder, more);
    ProcessOptions full;
    full.file_size_limit = limit;
    Outcome const outcome = ricochet(job.resume(), full);
    EXPECT_EQ(outcome.code, 74) << limit << ": " << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "File too large")) << outcome.err;
    if (std::filesystem::exists(job.trajectory()))
      went_on += TrajectoryReader(job.trajectory()).frames() > 10;
    EXPECT_EQ(ricochet(job.resume(), full).code, 74) << "still full";
    Outcome const rest = ricochet(job.resume());
    ASSERT_EQ(rest.code, 0) << limit << ": " << rest.err;
    expect_equal_results(job, whole);
  }
  EXPECT_GT(went_on, 1);
}

// Steps are taken to know how long they take; the run must not know of them.
TEST(Compression, ThatIsLeftToTheProgramChangesNothingButTheFile)
{
  Folder const folder;
  for (std::string const engine : {"sweep", "events"}) {
    Arguments const gas{write_gas(folder), "-q", "--engine", engine};
    Job const automatic{folder, "auto_" + engine, gas};
    Job const none{folder, "none_" + engine, gas + Arguments{"--compress", "none"}};
    ASSERT_EQ(ricochet(automatic.run()).code, 0);
    ASSERT_EQ(ricochet(none.run()).code, 0);
    ASSERT_GT(std::filesystem::file_size(none.trajectory()), 16e6) << "or nothing is measured";
    expect_equal_results(automatic, none);
  }
}

TEST(Compression, IsDoneWhereItsTimeIsNothingBesideThatOfTheSteps)
{
  Folder const folder;
  Arguments const gas{scene("gas_2000.csv"), scene("gas_2000.config.csv"), "-q", "--steps",
                      "1000000000"};
  struct {
    std::string every;
    bool compressed;
  } const cases[] = {{"1", false}, {"1000000", true}}; // a frame takes about a hundred steps
  for (auto const& at : cases) {
    Job const job{folder, "t" + at.every, gas + Arguments{"--every", at.every}};
    for (int parts = 0; parts < 2; ++parts) { // a run that goes on keeps the filter of its file
      std::int64_t const before = job.step();
      Process run(job.resume());
      ASSERT_TRUE(eventually(run, [&] { return job.step() > before; }));
      run.send(SIGTERM);
      ASSERT_EQ(run.wait().code, 75);
      TrajectoryReader const file(job.trajectory());
      EXPECT_EQ(file.is_compressed("position"), at.compressed) << at.every;
      EXPECT_EQ(file.is_compressed("velocity"), at.compressed) << at.every;
    }
  }
}

TEST(Batch, TwoJobsOnOneOutputAreRefused)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "1000000", "--every", "1000"});
  Process first(job.resume());
  ASSERT_TRUE(eventually(first, [&] { return job.step() > 0; }));
  for (Arguments const& second :
       {job.resume(), job.run() + Arguments{"--force"},
        Arguments{"run", scene("gas_2000.csv"), "--steps", "1", "--json", job.json()}}) {
    Outcome const refused = ricochet(second);
    EXPECT_EQ(refused.code, 73) << refused.err;
    EXPECT_TRUE(contains(refused.err, "another run is at work")) << refused.err;
  }
  EXPECT_TRUE(first.is_running());
  // Neither a killed run nor a stopped one leaves the output locked.
  first.kill();
  first.wait();
  Process second(job.resume());
  std::int64_t const step = job.step();
  ASSERT_TRUE(eventually(second, [&] { return job.step() > step; }));
  second.send(SIGTERM);
  EXPECT_EQ(second.wait().code, 75);
  for (std::string const& name : folder.names())
    EXPECT_NE(name[0], '.') << name << " is left over";
}

TEST(Batch, AReaderThatGoesAwayIsAnErrorAndNotTheEnd)
{
  Folder const folder;
  std::string const pipe = folder / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  int const reader = ::open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  Job const job = small_job(folder);
  ProcessOptions options;
  options.standard_output = pipe;
  Process run({"run", scene("gas_2000.csv"), scene("gas_2000.config.csv"), "--steps", "300", "-o",
               job.trajectory(), "--final", "-", "-q"},
              options);
  ASSERT_TRUE(eventually(run, [&] { return std::filesystem::exists(job.trajectory()); }));
  ::close(reader);
  Outcome const outcome = run.wait();
  EXPECT_EQ(outcome.code, 74) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "Broken pipe")) << outcome.err;
  EXPECT_EQ(TrajectoryReader(job.trajectory()).frames(), 301);
}

TEST(From, AFrameIsAState)
{
  Folder const folder;
  Arguments const gas = small_job(folder).scene;
  Arguments const thirty{"--steps", "30", "--every", "10"};
  Job const job{folder, "t", gas + thirty};
  ASSERT_EQ(ricochet(job.run()).code, 0);
  auto const from = [&](std::string const& frame, std::string const& steps) {
    return ricochet(Arguments{"run"} + gas +
                    Arguments{"--from", job.trajectory() + frame, "--steps", steps});
  };
  EXPECT_EQ(from("@1", "20").out, text_of(job.states()));
  EXPECT_EQ(from("@0", "30").out, text_of(job.states()));
  EXPECT_EQ(from("", "0").out, text_of(job.states()));
  for (char const* frame : {"@4", "@-1", "@last", "@"}) {
    Outcome const refused = from(frame, "1");
    EXPECT_EQ(refused.code, 64) << frame;
    EXPECT_TRUE(contains(refused.err, "--from: '" + job.trajectory() + "' has 4 frames"))
        << refused.err;
  }
  auto const onto_itself =
      Arguments{"run"} + job.scene +
      Arguments{"--from", job.trajectory() + "@1", "-o", job.trajectory(), "--force"};
  EXPECT_EQ(ricochet(onto_itself).code, 73);
  EXPECT_EQ(TrajectoryReader(job.trajectory()).frames(), 4);
  Job const positions{folder, "p", gas + thirty + Arguments{"--fields", "position"}};
  ASSERT_EQ(ricochet(positions.run()).code, 0);
  EXPECT_TRUE(
      contains(ricochet({"run", scene("gas_2000.csv"), "--from", positions.trajectory()}).err,
               "has no velocities"));
}

TEST(Batch, MistakesAreTold)
{
  Folder const folder;
  Job const job = small_job(folder, {"--steps", "20"});
  struct {
    int code;
    Arguments arguments;
  } const calls[] = {
      {64, {"--max-walltime", "10", "--checkpoint", folder / "c"}},
      {64, {"--resume", "auto"}}, // and nothing that names the checkpoint
      {64, {"--max-walltime", "1:00:00"}},
      {64, {"--checkpoint-every", "10"}},
      {64, {"--checkpoint-every", "0", "--checkpoint", folder / "c"}},
      {66, {"--resume", folder / "none.chk.h5"}},
      {74, {"--resume", folder.write("no.chk.h5", "no checkpoint")}},
  };
  for (auto const& call : calls) {
    Outcome const outcome = ricochet(Arguments{"run"} + job.scene + call.arguments);
    EXPECT_EQ(outcome.code, call.code) << call.arguments.front() << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }
  EXPECT_EQ(folder.names(), std::vector<std::string>{"no.chk.h5"});

  Arguments const checkpoint{"--checkpoint", folder / "t.chk.h5"};
  ASSERT_EQ(ricochet(job.run() + checkpoint).code, 0);
  std::filesystem::remove(job.trajectory());
  std::filesystem::remove(job.states());
  std::filesystem::remove(job.json());
  Outcome const exists = ricochet(job.run() + checkpoint);
  EXPECT_EQ(exists.code, 73) << "without --resume a checkpoint is an output like others";
}

} // namespace
} // namespace ricochet::test
