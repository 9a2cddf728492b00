// A checkpoint file gives back what was written, or says that it cannot.
#include "checkpoint_file.hpp"
#include "hdf5.hpp"
#include "process.hpp"
#include "provenance.hpp"
#include "same_bits.hpp"
#include "stop_request.hpp"

#include "exit_codes.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sys/resource.h>

namespace ricochet::driver {
namespace {

using test::Folder;
using test::text_of;

SavedRun example(std::int64_t step, std::size_t discs)
{
  SavedRun run;
  run.version = version();
  run.identity = "[run]\ndt = 0.5\n";
  run.frames = 7;
  run.wall_seconds = 1.25;
  run.slow_looks = 2;
  run.summary = "done";
  run.summary_json = "{}";
  run.engine.integers = {{"steps", step}, {"low", -1}};
  run.engine.reals = {{"zero", -0.0}, {"window", 1.0 / 3}};
  for (std::size_t i = 0; i < discs; ++i)
    run.engine.discs.push_back({static_cast<double>(i), -0.0, 1.0 / 3, 1e300});
  return run;
}

// Bits, as everything in a checkpoint is written by a machine for itself.
void expect_equal(SavedRun const& a, SavedRun const& b)
{
  EXPECT_EQ(a.version, b.version);
  EXPECT_EQ(a.identity, b.identity);
  EXPECT_EQ(a.frames, b.frames);
  EXPECT_EQ(a.wall_seconds, b.wall_seconds);
  EXPECT_EQ(a.slow_looks, b.slow_looks);
  EXPECT_EQ(a.summary, b.summary);
  EXPECT_EQ(a.summary_json, b.summary_json);
  EXPECT_EQ(a.engine.integers, b.engine.integers);
  EXPECT_EQ(a.engine.reals, b.engine.reals);
  EXPECT_TRUE(test::same_bits(a.engine.reals.at("zero"), b.engine.reals.at("zero")));
  ASSERT_EQ(a.engine.discs.size(), b.engine.discs.size());
  for (std::size_t i = 0; i < a.engine.discs.size(); ++i)
    EXPECT_TRUE(test::same_bits(a.engine.discs[i], b.engine.discs[i])) << i;
}

Exit code_of(std::string const& path)
{
  try {
    read_checkpoint(path);
    return Exit::done;
  } catch (Failure const& failure) {
    return failure.code();
  }
}

TEST(Checkpoints, ReadBackAsTheyWereWritten)
{
  Folder const folder;
  for (std::size_t const discs : {0u, 1u, 1000u}) {
    SavedRun const run = example(3, discs);
    write_checkpoint(folder / "c", run);
    expect_equal(read_checkpoint(folder / "c"), run);
  }
}

TEST(Checkpoints, TheOneBeforeIsKept)
{
  Folder const folder;
  for (std::int64_t step = 1; step <= 3; ++step)
    write_checkpoint(folder / "c", example(step, 10));
  EXPECT_EQ(read_checkpoint(folder / "c").step(), 3);
  EXPECT_EQ(read_checkpoint(previous_checkpoint(folder / "c")).step(), 2);
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"c", "c.prev"})) << "left-overs";
}

// Whatever byte is wrong: what is read is right, or it is refused and the one before it is taken.
TEST(Checkpoints, DamageIsFound)
{
  Folder const folder;
  SavedRun const run = example(2, 20);
  write_checkpoint(folder / "c", example(1, 20));
  write_checkpoint(folder / "c", run);
  std::string const good = text_of(folder / "c");
  std::size_t found = 0;
  for (std::size_t at = 0; at < good.size(); at += 7) {
    std::string bad = good;
    bad[at] = static_cast<char>(~bad[at]);
    folder.write("c", bad);
    if (code_of(folder / "c") == Exit::done)
      expect_equal(read_checkpoint(folder / "c"), run);
    else
      ++found;
  }
  EXPECT_GT(found, 20 * sizeof(DiscState) / 7);
  for (std::size_t size = 0; size < good.size(); size += 97) {
    folder.write("c", good.substr(0, size));
    EXPECT_EQ(code_of(folder / "c"), Exit::io_error) << size;
  }
  EXPECT_EQ(find_checkpoint(folder / "c").value().step(), 1);
  std::filesystem::remove(folder / "c");
  EXPECT_EQ(find_checkpoint(folder / "c").value().step(), 1) << "between the two renames";
  std::filesystem::remove(previous_checkpoint(folder / "c"));
  EXPECT_FALSE(find_checkpoint(folder / "c").has_value());
  EXPECT_EQ(code_of(folder / "c"), Exit::no_input);
}

TEST(Checkpoints, OfOtherVersionsAreRefused)
{
  Folder const folder;
  SavedRun run = example(2, 2);
  run.version = "0.0.0";
  write_checkpoint(folder / "c", run);
  try {
    find_checkpoint(folder / "c");
    FAIL();
  } catch (Failure const& failure) {
    EXPECT_EQ(failure.code(), Exit::bad_data);
    EXPECT_NE(std::string(failure.what()).find("ricochet 0.0.0 made it"), std::string::npos);
  }
}

TEST(Checkpoints, AFailureToWriteLeavesTheLastOne)
{
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  auto const handler = std::signal(SIGXFSZ, SIG_IGN);
  Folder const folder;
  write_checkpoint(folder / "c", example(1, 10000));
  Exit code = Exit::done;
  for (rlim_t const limit : {rlim_t{0}, rlim_t{1000}, rlim_t{100000}, rlim_t{319000}}) {
    rlimit const small{limit, old.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &small);
    try {
      write_checkpoint(folder / "c", example(2, 10000));
    } catch (Failure const& failure) {
      code = failure.code();
    }
    ::setrlimit(RLIMIT_FSIZE, &old);
    EXPECT_EQ(code, Exit::io_error) << limit;
    EXPECT_EQ(read_checkpoint(folder / "c").step(), 1) << limit;
    EXPECT_EQ(folder.names(), std::vector<std::string>{"c"}) << limit;
  }
  std::signal(SIGXFSZ, handler);
}

TEST(StopRequest, DurationsAreThoseOfAQueue)
{
  EXPECT_EQ(parse_duration("00:00:01"), 1);
  EXPECT_EQ(parse_duration("3:55:00"), 14100);
  EXPECT_EQ(parse_duration("2-00:00:10"), 172810);
  EXPECT_EQ(parse_duration("100:00:00"), 360000);
  for (char const* wrong :
       {"", "1", "1:2", "1:2:3:4", "-1:00:00", "1:-2:3", "a:b:c", "1::3", "1.5:00:00", "+1:0:0"})
    EXPECT_FALSE(parse_duration(wrong).has_value()) << wrong;
}

TEST(StopRequest, TheSameSignalTwiceEndsAtOnceAndAnotherOneDoesNot)
{
  testing::FLAGS_gtest_death_test_style = "threadsafe";
  for (int const signal : {SIGINT, SIGTERM, SIGUSR1}) {
    EXPECT_EXIT(
        {
          StopRequests const stops({}, "");
          std::raise(signal);
          std::raise(signal);
        },
        testing::ExitedWithCode(128 + signal), "");
  }
  StopRequests const stops({}, "");
  EXPECT_EQ(stops.reason(0, false), "");
  std::raise(SIGUSR1);
  std::raise(SIGTERM);
  EXPECT_EQ(stops.signal(), SIGUSR1);
  EXPECT_EQ(stops.reason(0, true), "SIGUSR1");
}

TEST(StopRequest, TheReserveCountsAndTheEarlierLimitHolds)
{
  EXPECT_EQ(StopRequests(1e6, "").reason(0, false), "");
  EXPECT_NE(StopRequests(1e6, "").reason(1e6, false), "");
  EXPECT_EQ(StopRequests(1e6, "").reason(1e6, true), "");
  ::setenv("RICOCHET_STOP_AT", "1000000000", 1); // in 2001
  EXPECT_NE(StopRequests(1e6, "").reason(0, false), "");
  EXPECT_NE(StopRequests({}, "").reason(0, false), "");
  ::setenv("RICOCHET_STOP_AT", "tomorrow", 1);
  EXPECT_THROW(StopRequests({}, ""), Failure);
  ::unsetenv("RICOCHET_STOP_AT");
}

} // namespace
} // namespace ricochet::driver
