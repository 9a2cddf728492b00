// The program as a process: exit codes, what goes where, what is never overwritten.
#include "jobs.hpp"
#include "trajectory_reader.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <sstream>

namespace ricochet::test {
namespace {

using driver::TrajectoryReader;

std::string const two_discs = "-40,0,60,0\n40,0,-60,0\n";

TEST(Program, HelpAndVersionAreAnsweredOnStandardOutput)
{
  // No tool library and no device is looked for: Kokkos would complain about the first.
  ProcessOptions const hostile{{"KOKKOS_TOOLS_LIBS=/nonexistent", "KOKKOS_NUM_THREADS=x"}, -1, ""};
  for (auto const& arguments :
       {std::vector<std::string>{"--help"}, std::vector<std::string>{"run", "--help"},
        std::vector<std::string>{"info", "--help"}, std::vector<std::string>{"compare", "--help"},
        std::vector<std::string>{"--version"}}) {
    Outcome const outcome = ricochet(arguments, hostile);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.err, "");
    EXPECT_FALSE(outcome.out.empty());
  }
  std::string const version = ricochet({"--version"}).out;
  for (char const* what : {"ricochet ", "git ", "Kokkos ", "HDF5 ", "backend "})
    EXPECT_TRUE(contains(version, what)) << version;
}

TEST(Program, WithoutOutputsTheFinalStatesAreStandardOutput)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  auto const c = folder.write("c.csv", "g=0,alpha=1,beta=1,radius=10,totTime=0");
  for (auto const& arguments :
       {std::vector<std::string>{s, c}, std::vector<std::string>{"run", s, c}}) {
    Outcome const outcome = ricochet(arguments);
    EXPECT_EQ(outcome.code, 0);
    EXPECT_EQ(outcome.out, "-40,0,60,0\n40,0,-60,0\n");
    EXPECT_TRUE(contains(outcome.err, "2 discs, 0 steps"));
  }
  EXPECT_EQ(ricochet({s, c, "--quiet"}).err, "");
}

/// They would collide at 0.5; as it is each is 60 farther.
TEST(Program, WithoutPairsDiscsPassThroughEachOther)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  auto const c = folder.write("c.csv", "g=0,radius=10,totTime=1,fps=1");
  for (char const* engine : {"toi", "events"}) {
    Outcome const outcome = ricochet({s, c, "--no-pairs", "--engine", engine});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(outcome.out, "20,0,60,0\n-20,0,-60,0\n");
    EXPECT_TRUE(contains(outcome.err, "(none, double)")) << outcome.err;
  }
  auto const in_one_place = folder.write("o.csv", "0,0,1,0\n0,0,2,0\n");
  EXPECT_TRUE(contains(ricochet({"validate", in_one_place, c}).out, "overlap"));
  EXPECT_FALSE(contains(ricochet({"validate", in_one_place, c, "--no-pairs"}).out, "overlap"));
}

TEST(Program, FinalStatesAreAValidStatesFile)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  ASSERT_EQ(ricochet({s, "--steps", "100", "--final", folder / "f.csv", "-q"}).code, 0);
  Outcome const again = ricochet({folder / "f.csv", "--steps", "0"});
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out, text_of(folder / "f.csv"));
}

TEST(Program, NoDiscsAndOneDiscAreScenes)
{
  Folder const folder;
  for (std::string const text : {"", "0,0,1,1"}) {
    auto const s = folder.write("s.csv", text);
    Outcome const outcome =
        ricochet({s, "--steps", "3", "-o", folder / "t.h5md", "--json", "-", "--force"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(TrajectoryReader(folder / "t.h5md").frames(), 4);
    EXPECT_EQ(TrajectoryReader(folder / "t.h5md").discs(), text.empty() ? 0 : 1);
    EXPECT_EQ(ricochet({"info", folder / "t.h5md"}).code, 0);
    EXPECT_EQ(ricochet({"compare", folder / "t.h5md", folder / "t.h5md"}).code, 0);
  }
}

TEST(Program, TheSummaryHasEveryPromisedKey)
{
  Folder const folder;
  Outcome const outcome =
      ricochet({folder.write("s.csv", two_discs), "--steps", "10", "--json", "-"});
  ASSERT_EQ(outcome.code, 0);
  for (char const* key : {"version",
                          "engine",
                          "law",
                          "precision",
                          "backend",
                          "threads",
                          "discs",
                          "steps",
                          "dt",
                          "simulated_time",
                          "wall_seconds",
                          "disc_steps_per_second",
                          "collisions",
                          "collisions_per_second",
                          "wall_hits",
                          "separating_hits",
                          "windows",
                          "executions",
                          "max_overlap",
                          "max_outside",
                          "energy",
                          "kinetic_initial",
                          "potential_initial",
                          "kinetic",
                          "potential",
                          "lost_pairs",
                          "lost_walls",
                          "numerical",
                          "residual",
                          "momentum",
                          "temperature",
                          "pressure_z",
                          "packing_fraction",
                          "state_hash",
                          "verified",
                          "error_estimate",
                          "warnings"})
    EXPECT_TRUE(contains(outcome.out, "\"" + std::string(key) + "\": ")) << key;
  EXPECT_TRUE(contains(outcome.out, "\"verified\": \"not checked\""));
  EXPECT_TRUE(contains(outcome.out, "\"steps\": 10,"));
}

TEST(Program, NumbersThatAreNotFiniteAreNullInJson)
{
  Folder const folder;
  Outcome const outcome = ricochet({folder.write("s.csv", ""), "--steps", "0", "--json", "-"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_TRUE(contains(outcome.out, "\"disc_steps_per_second\": null")) << outcome.out;
  EXPECT_TRUE(contains(outcome.out, "\"pressure_z\": null"));
}

TEST(Program, EngineWarningsAreToldOnceAndKept)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  Outcome const outcome =
      ricochet({s, "--engine", "simultaneous", "--steps", "1", "--json", "-", "--quiet"});
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(outcome.err.find("warning: "), outcome.err.rfind("warning: "));
  EXPECT_TRUE(contains(outcome.err, "warning: ")) << outcome.err;
  EXPECT_FALSE(contains(outcome.out, "\"warnings\": []")) << outcome.out;
}

TEST(Program, FramesAreEveryKStepsAndTheLast)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  auto const steps_for = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {s, "-o", folder / "t.h5md", "--force", "-q"});
    Outcome const outcome = ricochet(arguments);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    return TrajectoryReader(folder / "t.h5md").steps();
  };
  using Steps = std::vector<std::int64_t>;
  EXPECT_EQ(steps_for({"--steps", "3"}), (Steps{0, 1, 2, 3}));
  EXPECT_EQ(steps_for({"--steps", "10", "--every", "4"}), (Steps{0, 4, 8, 10}));
  EXPECT_EQ(steps_for({"--steps", "8", "--every", "4"}), (Steps{0, 4, 8}));
  EXPECT_EQ(steps_for({"--steps", "3", "--every", "100"}), (Steps{0, 3}));
  EXPECT_EQ(steps_for({"--steps", "0", "--every", "100"}), (Steps{0}));
  EXPECT_EQ(steps_for({"--duration", "1", "--every-time", "0.2"}), (Steps{0, 9, 18, 27, 36, 45}));
}

TEST(Program, TheLastFrameIsTheFinalState)
{
  Folder const folder;
  std::vector<std::string> const run{scene("gas_2000.csv"), scene("gas_2000.config.csv"), "--steps",
                                     "30"};
  auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    return ricochet(more);
  };
  ASSERT_EQ(with({"-o", folder / "a.h5md", "--final", folder / "f.csv"}).code, 0);
  ASSERT_EQ(
      with({"-o", folder / "b.h5md", "--every", "7", "--compress", "deflate", "--threads", "1"})
          .code,
      0);
  EXPECT_EQ(ricochet({"compare", folder / "a.h5md", folder / "f.csv"}).code, 0);
  EXPECT_EQ(ricochet({"compare", folder / "b.h5md", folder / "f.csv"}).code, 0);
  // Neither frames nor compression nor threads change the motion.
  Outcome const common = ricochet({"compare", folder / "a.h5md", folder / "b.h5md"});
  EXPECT_EQ(common.code, 2) << "other frames";
  EXPECT_TRUE(contains(common.out, "6 frames of 2000 discs compared")) << common.out;
  EXPECT_FALSE(contains(common.out, "by more than")) << common.out;
}

TEST(Program, ExitCodesOfMistakes)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  auto const bad = folder.write("bad.csv", "1,2,3");
  struct {
    int code;
    std::vector<std::string> arguments;
  } const calls[] = {
      {64, {}},
      {64, {s, "-anim"}},
      {64, {s, "--every", "0", "-o", "t"}},
      {64, {s, "--final", "-", "--json", "-"}},
      {64, {s, "--dt", "0.007"}},
      {64, {s, "--kokkos-frobnicate"}},
      {64, {s, "--kokkos-num-threads"}},
      {64, {s, "--final", folder / "x", "--json", folder / "x"}},
      {65, {bad}},
      {65, {s, s}},
      {65, {"info", s}},
      {65, {"compare", bad, s}},
      {66, {folder / "none.csv"}},
      {66, {s, folder / "none.csv"}},
      {66, {folder.path()}},
      {66, {"info", folder / "none.h5md"}},
      {66, {"compare", s, folder / "none.csv"}},
      {73, {s, "-o", folder / "no/folder/t.h5md"}},
      {73, {s, "--final", folder.path()}},
      {73, {s, "--final", s, "--force"}},
      {73, {s, "--json", s, "--force"}},
      {73, {s, "-o", s, "--force"}},
  };
  for (auto const& call : calls) {
    Outcome const outcome = ricochet(call.arguments);
    std::string const last = call.arguments.empty() ? "" : call.arguments.back();
    EXPECT_EQ(outcome.code, call.code) << last << ": " << outcome.err;
    EXPECT_EQ(outcome.out, "") << last;
    EXPECT_FALSE(outcome.err.empty()) << last;
  }
  EXPECT_EQ(text_of(s), two_discs);
}

TEST(Program, ProblemsOfASceneBeginWithTheirPlace)
{
  Folder const folder;
  auto const s = folder.write("s.csv", "1,2,3\n1,2,3,x\n");
  Outcome const outcome = ricochet({s});
  EXPECT_EQ(outcome.code, 65);
  EXPECT_EQ(outcome.err.rfind(s + ":1:1: ", 0), 0u) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "\n" + s + ":2:7: vy: ")) << outcome.err;
}

TEST(Program, NothingIsOverwrittenWithoutForce)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  for (std::string const option : {"--final", "--json", "-o"}) {
    auto const file = folder.write("precious", "precious");
    Outcome const refused = ricochet({s, "--steps", "1", option, file});
    EXPECT_EQ(refused.code, 73) << option;
    EXPECT_TRUE(contains(refused.err, "--force")) << refused.err;
    EXPECT_EQ(text_of(file), "precious");
    EXPECT_EQ(ricochet({s, "--steps", "1", option, file, "--force"}).code, 0) << option;
    EXPECT_NE(text_of(file), "precious") << option;
  }
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"precious", "s.csv"})) << "left-overs";
}

TEST(Program, AStateThatIsNotFiniteEndsTheRunWithItsTime)
{
  Folder const folder;
  auto const s = folder.write("s.csv", "0,0,1e300,1e300\n100,0,0,0\n");
  Outcome const outcome = ricochet({s, "--dt", "1e300", "--steps", "20", "--json", folder / "j",
                                    "--final", folder / "f.csv", "-o", folder / "t.h5md"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "no longer finite at step")) << outcome.err;
  EXPECT_TRUE(contains(text_of(folder / "j"), "null"));
  EXPECT_FALSE(std::filesystem::exists(folder / "f.csv"));
  EXPECT_GT(TrajectoryReader(folder / "t.h5md").frames(), 0);
}

// A ball on the floor bounces infinitely often before its fourth time unit.
TEST(Program, LastingContactEndsAnExactRunWithTheTrajectorySoFar)
{
  Folder const folder;
  auto const s = folder.write("s.csv", "0,0,0,0\n");
  auto const c = folder.write("c.csv", "width=20,height=20,alpha=0.2");
  Outcome const outcome = ricochet({"run", s, c, "--engine", "events", "--duration", "20", "-o",
                                    folder / "t.h5md", "--final", folder / "f.csv"});
  EXPECT_EQ(outcome.code, 1) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "lasting contact")) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "disc")) << outcome.err;
  EXPECT_FALSE(std::filesystem::exists(folder / "f.csv"));
  EXPECT_GT(TrajectoryReader(folder / "t.h5md").frames(), 10);
}

TEST(Program, CompareExitsTwoBeyondTheTolerance)
{
  Folder const folder;
  auto const a = folder.write("a.csv", "1,2,3,4");
  auto const b = folder.write("b.csv", "1,2,3,4.001");
  EXPECT_EQ(ricochet({"compare", a, a}).code, 0);
  Outcome const outcome = ricochet({"compare", a, b});
  EXPECT_EQ(outcome.code, 2);
  EXPECT_EQ(outcome.err, "");
  EXPECT_TRUE(contains(outcome.out, "disc 0: 4 and 4.001")) << outcome.out;
  EXPECT_EQ(ricochet({"compare", a, b, "--tolerance", "1e-3"}).code, 2); // 4.001 - 4 is a bit more
  EXPECT_EQ(ricochet({"compare", a, b, "--tolerance", "0.00101"}).code, 0);
}

TEST(Program, InfoTellsWhereATrajectoryComesFrom)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  ASSERT_EQ(ricochet({s, "--steps", "5", "-o", folder / "t.h5md", "-q"}).code, 0);
  Outcome const text = ricochet({"info", folder / "t.h5md"});
  EXPECT_EQ(text.code, 0);
  for (std::string const& what :
       {std::string("6 frames of 2 discs"), std::string("sweep, swap_scale, double"),
        "ricochet " + s + " --steps 5", std::string("HDF5"), std::string("energy")})
    EXPECT_TRUE(contains(text.out, what)) << what << "\n" << text.out;
  Outcome const json = ricochet({"info", folder / "t.h5md", "--json", "-"});
  EXPECT_EQ(json.out.front(), '{');
  EXPECT_TRUE(contains(json.out, "\"frames\": 6,")) << json.out;
  EXPECT_TRUE(contains(json.out, "\"complete\": true")) << json.out;
}

TEST(Program, ThreadsAreThoseAskedForByAnySpelling)
{
  Folder const folder;
  std::vector<std::string> const run{scene("gas_2000.csv"), "--steps", "2", "--json", "-", "-q"};
  auto const threads = [&](std::vector<std::string> more, std::vector<std::string> environment) {
    more.insert(more.begin(), run.begin(), run.end());
    ProcessOptions options;
    options.environment = std::move(environment);
    Outcome const outcome = ricochet(more, options);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::size_t const at = outcome.out.find("\"threads\": ") + 11;
    return outcome.out.substr(at, outcome.out.find(',', at) - at);
  };
  EXPECT_EQ(threads({"--threads", "1"}, {}), "1");
  EXPECT_EQ(threads({"--kokkos-num-threads=1"}, {}), "1");
  EXPECT_EQ(threads({}, {"OMP_NUM_THREADS=1"}), "1");
  // An option wins over a variable, also where Kokkos would refuse the two together.
  EXPECT_EQ(threads({"--threads", "1"}, {"KOKKOS_NUM_THREADS=2"}), "1");
}

TEST(Program, KokkosSpeaksWhenAskedAndOnlyThen)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  Outcome const help = ricochet({"--kokkos-help"});
  EXPECT_EQ(help.code, 0);
  EXPECT_TRUE(contains(help.out, "--kokkos-"));
  Outcome const configuration = ricochet({s, "--steps", "0", "--kokkos-print-configuration"});
  EXPECT_EQ(configuration.out, two_discs);
  EXPECT_TRUE(contains(configuration.err, "Kokkos Version"));
  Outcome const plain = ricochet({s, "--steps", "0", "-q"});
  EXPECT_EQ(plain.err, "");
}

TEST(Program, ALogHasNoBarAndNoControlCharacters)
{
  ProcessOptions options;
  options.environment = {"TERM=xterm"};
  Outcome const outcome = ricochet({scene("gas_2000.csv"), scene("gas_2000.config.csv"), "--steps",
                                    "400", "--final", "/dev/null"},
                                   options);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_FALSE(contains(outcome.err, "\r"));
  EXPECT_FALSE(contains(outcome.err, "\033"));
}

TEST(Program, ALogAsJsonIsAnObjectALine)
{
  Folder const folder;
  auto const s = folder.write("s.csv", two_discs);
  Arguments const run{
      "run",  s,         "--steps",       "5", "--engine", "simultaneous", "--log-format",
      "json", "--final", folder / "f.csv"};
  for (int const code : {0, 73}) {
    Outcome const outcome = ricochet(run);
    EXPECT_EQ(outcome.code, code);
    std::istringstream lines(outcome.err);
    std::string line, events;
    while (std::getline(lines, line)) {
      EXPECT_EQ(line.rfind("{\"time\":\"20", 0), 0u) << line;
      EXPECT_EQ(line.back(), '}') << line;
      std::size_t const at = line.find("\"event\":\"");
      events += at == std::string::npos ? "-" : line.substr(at + 9, 2);
    }
    EXPECT_EQ(events, code == 0 ? "st-reen" : "-en") << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "\"code\":" + std::to_string(code) + "}")) << outcome.err;
  }
  EXPECT_EQ(ricochet({"run", s, "--log-format", "xml"}).code, 64);
}

// The last lines of a log say what came out and how it ended, for programs to find.
TEST(Program, ALogEndsWithItsResultAndItsExitCode)
{
  Folder const folder;
  auto const s = folder.write("s.csv", "0,0,1,1\n50,0,-1,0\n");
  auto const last_lines = [](std::string const& log) {
    std::size_t const end = log.rfind('\n', log.size() - 2);
    std::size_t const start = log.rfind('\n', end - 1);
    return std::pair(log.substr(start + 1, end - start - 1), log.substr(end + 1));
  };
  Outcome const done = ricochet({"run", s, "--steps", "5", "--json", folder / "s.json"});
  EXPECT_EQ(done.code, 0) << done.err;
  auto const [result, end] = last_lines(done.err);
  EXPECT_NE(result.find("INFO result steps=5 "), std::string::npos) << done.err;
  EXPECT_NE(result.find(" disc_steps_per_second="), std::string::npos) << done.err;
  EXPECT_NE(result.find("s.json"), std::string::npos) << done.err;
  EXPECT_NE(end.find("INFO end code=0"), std::string::npos) << done.err;

  ProcessOptions late;
  late.environment = {"RICOCHET_STOP_AT=1"};
  Outcome const stopped = ricochet({"run", s, "--checkpoint", folder / "s.chk.h5"}, late);
  EXPECT_EQ(stopped.code, 75) << stopped.err;
  EXPECT_NE(last_lines(stopped.err).second.find("INFO end code=75"), std::string::npos)
      << stopped.err;
  EXPECT_EQ(ricochet({"run", s, "--steps", "5", "--quiet"}).err, "") << "no log, no end";
}

} // namespace
} // namespace ricochet::test
