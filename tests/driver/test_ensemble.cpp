// The members of an ensemble are the runs that each would be alone, whatever becomes of the others.
#include "jobs.hpp"
#include "trajectory_reader.hpp"

#include <Kokkos_Macros.hpp>

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>

namespace ricochet::test {
namespace {

#if defined(KOKKOS_ENABLE_OPENMP)
constexpr char const* at_once_of_two_threads = "2";
#else
constexpr char const* at_once_of_two_threads = "1"; // the host has one thread
#endif

std::string number(std::size_t member)
{
  return "_000" + std::to_string(member);
}

std::string write_small_gas(Folder const& folder)
{
  return folder.write("gas.toml", R"(
[discs.generate]
count = 300
temperature = 400
seed = 5

[box]
width = 250
height = 250
y = "periodic"

[forces]
gravity = 0

[run]
engine = "sweep"
steps = 400
dt = 0.0078125

[output]
every = 7
)");
}

/// An ensemble and what it writes.
struct Members {
  Folder const& folder;
  Arguments words; ///< scene, number and variation

  Job member(std::size_t k) const { return {folder, "m" + number(k), {}}; }
  std::string csv() const { return folder / "table.csv"; }
  std::string json() const { return folder / "table.json"; }
  Arguments command() const
  {
    return Arguments{"ensemble"} + words + Arguments{"-o",      folder / "m.h5md",
                                                     "--final", folder / "m.csv",
                                                     "--csv",   csv(),
                                                     "--json",  json(),
                                                     "-q"};
  }
  Arguments resume() const
  {
    return command() + Arguments{"--resume", "auto", "--checkpoint-every", "0.01"};
  }
};

// Compares member `k` with `alone`, which was run with the same settings.
void expect_member(Members const& ensemble, std::size_t k, Job const& alone)
{
  EXPECT_EQ(text_of(ensemble.member(k).states()), text_of(alone.states()));
  expect_equal_trajectories(ensemble.member(k), alone);
  auto const hashes = all_of(text_of(ensemble.json()), "state_hash");
  ASSERT_GT(hashes.size(), k);
  EXPECT_EQ(Arguments{hashes[k]}, all_of(text_of(alone.json()), "state_hash"));
}

struct Kind {
  std::string engine, precision;
};

std::ostream& operator<<(std::ostream& out, Kind const& kind)
{
  return out << kind.engine << " " << kind.precision;
}

class Ensemble : public testing::TestWithParam<Kind> {};

TEST_P(Ensemble, MembersHaveTheBitsOfRunsAlone)
{
  Folder const folder;
  Arguments const gas{write_small_gas(folder), "--engine", GetParam().engine, "--precision",
                      GetParam().precision};
  Members const ensemble{folder,
                         gas + Arguments{"--vary", "seed", "--vary", "contact.restitution=0.8..1",
                                         "--members", "5", "--threads", "2"}};
  Outcome const outcome = ricochet(ensemble.command());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(all_of(text_of(ensemble.json()), "at_once"), Arguments{at_once_of_two_threads})
      << "or this test shows little";
  char const* const restitution[] = {"0.8", "0.85", "0.9", "0.95", "1"};
  for (std::size_t k = 0; k < 5; ++k) {
    SCOPED_TRACE(k);
    Job const alone{folder, "alone" + number(k),
                    gas + Arguments{"--set", "discs.generate.seed=" + std::to_string(5 + k),
                                    "--set", std::string("contact.restitution=") + restitution[k],
                                    "-q"}};
    ASSERT_EQ(ricochet(alone.run()).code, 0);
    expect_member(ensemble, k, alone);
  }
}

INSTANTIATE_TEST_SUITE_P(Engines, Ensemble,
                         testing::Values(Kind{"sweep", "double"}, Kind{"sweep", "single"},
                                         Kind{"simultaneous", "double"}, Kind{"events", "double"},
                                         Kind{"events", "single"}));

// What is copied of them is copied by all threads when they run alone.
TEST(Ensemble, MembersThatWouldUseAllThreadsHaveTheirBitsToo)
{
  Folder const folder;
  Arguments const gas{write_gas(folder), "--steps", "70"};
  Members const ensemble{folder, gas + Arguments{"--vary", "seed", "--members", "3"}};
  Outcome const outcome = ricochet(ensemble.command());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  for (std::size_t k = 0; k < 3; ++k) {
    Job const alone{folder, "alone" + number(k),
                    gas + Arguments{"--set", "discs.generate.seed=" + std::to_string(1 + k), "-q"}};
    ASSERT_EQ(ricochet(alone.run()).code, 0);
    expect_member(ensemble, k, alone);
  }
}

TEST(Ensemble, ADenseFluidIsMeltedAsAlone)
{
  Folder const folder;
  Arguments const fluid{write_small_gas(folder),
                        "--set",
                        "box.width=140",
                        "--set",
                        "box.height=110",
                        "--engine",
                        "events",
                        "--steps",
                        "5"};
  Members const ensemble{folder, fluid + Arguments{"--vary", "seed", "--members", "3"}};
  Outcome const outcome = ricochet(ensemble.command());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  Job const alone{folder, "alone", fluid + Arguments{"--set", "discs.generate.seed=6", "-q"}};
  ASSERT_EQ(ricochet(alone.run()).code, 0);
  expect_member(ensemble, 1, alone);
}

TEST(Ensemble, TheTableHasARowForEachMember)
{
  Folder const folder;
  std::string const gas = write_small_gas(folder);
  Outcome const outcome = ricochet({"ensemble", gas, "--steps", "20", "--vary",
                                    "run.dt=0.0078125,0.00390625,0.001953125", "-q"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  std::istringstream table(outcome.out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(table, line);)
    lines.push_back(line);
  ASSERT_EQ(lines.size(), 4u) << outcome.out;
  EXPECT_EQ(lines[0].rfind("member,run.dt,trajectory,code,error,version,", 0), 0u) << lines[0];
  EXPECT_TRUE(contains(lines[0], ",energy.kinetic,")) << lines[0];
  EXPECT_EQ(lines[1].rfind("0,0.0078125,,0,,", 0), 0u) << lines[1];
  EXPECT_EQ(lines[3].rfind("2,0.001953125,,0,,", 0), 0u) << lines[3];
  EXPECT_EQ(folder.names(), Arguments{"gas.toml"});

  Outcome const listed = ricochet(
      {"ensemble", gas, "--members", "2", "--vary", "seed", "-o", folder / "m.h5md", "--dry-run"});
  EXPECT_EQ(listed.out, "member,discs.generate.seed,trajectory\n0,5," + folder.path() +
                            "/m_0000.h5md\n1,6," + folder.path() + "/m_0001.h5md\n");
  EXPECT_EQ(folder.names(), Arguments{"gas.toml"});
}

TEST(Ensemble, AMemberThatFailsLeavesTheOthersAlone)
{
  Folder const folder;
  folder.write("a.csv", "0,0,1,1\n50,0,-1,0\n");
  folder.write("far.csv", "0,0,1,1\n5000,0,-1,0\n");
  auto const path = [&](char const* name) { return folder / name; };
  Members const ensemble{folder,
                         {path("a.csv"), "--steps", "30", "--vary",
                          "contact.restitution=0.9,0.8,0.7", "--vary",
                          "output.every_time=1,0.3,1"}};
  Outcome const refused = ricochet(ensemble.command());
  EXPECT_EQ(refused.code, 64) << "known before anything begins: 0.3 is no whole number of steps";
  EXPECT_EQ(folder.names(), (Arguments{"a.csv", "far.csv"}));

  std::string const scene = folder.write("s.toml", "[run]\nengine = \"sweep\"\nsteps = 30\n");
  Members const files{folder,
                      {scene, "--vary",
                       "discs.states=" + path("a.csv") + "," + path("far.csv") + "," +
                           path("none.csv") + "," + path("a.csv")}};
  Outcome const outcome = ricochet(files.command());
  EXPECT_EQ(outcome.code, 65) << "of the first that failed: " << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "member 1 (discs.states=")) << outcome.err;
  EXPECT_TRUE(contains(outcome.err, "none.csv")) << outcome.err;
  std::string const json = text_of(files.json());
  EXPECT_EQ(all_of(json, "code"), (Arguments{"0", "65", "66", "0"}));
  EXPECT_EQ(all_of(json, "state_hash").size(), 2u);
  EXPECT_EQ(text_of(files.member(0).states()), text_of(files.member(3).states()));
  EXPECT_FALSE(std::filesystem::exists(files.member(1).trajectory()));
}

TEST(Ensemble, GoesOnWhereItWasStopped)
{
  Folder const folder;
  Arguments const gas{write_small_gas(folder), "--steps", "8000", "--every", "500"};
  Members const ensemble{folder, gas + Arguments{"--vary", "seed", "--members", "4"}};
  Process first(ensemble.resume());
  ASSERT_TRUE(eventually(first, [&] { return ensemble.member(0).step() > 0; }));
  first.send(SIGTERM);
  Outcome const stopped = first.wait();
  ASSERT_EQ(stopped.code, 75) << stopped.err;
  auto const codes = all_of(text_of(ensemble.json()), "code");
  EXPECT_EQ(codes, Arguments(4, "75"));
  EXPECT_TRUE(contains(text_of(ensemble.json()), "not begun because of SIGTERM"));

  Outcome const rest = ricochet(ensemble.resume());
  EXPECT_EQ(rest.code, 0) << rest.err;
  EXPECT_EQ(all_of(text_of(ensemble.json()), "code"), Arguments(4, "0"));
  for (std::size_t const k : {0, 3}) {
    Job const alone{folder, "alone" + number(k),
                    gas + Arguments{"--set", "discs.generate.seed=" + std::to_string(5 + k), "-q"}};
    ASSERT_EQ(ricochet(alone.run()).code, 0);
    expect_member(ensemble, k, alone);
  }

  // What is finished is not run again, and gives the same table.
  std::string const table = text_of(ensemble.csv());
  EXPECT_EQ(ricochet(ensemble.resume()).code, 0);
  EXPECT_EQ(text_of(ensemble.csv()), table);
}

TEST(Ensemble, WithoutCheckpointASignalEndsIt)
{
  Folder const folder;
  Members const ensemble{folder,
                         {write_small_gas(folder), "--steps", "10000000", "--every", "1000",
                          "--vary", "seed", "--members", "3"}};
  Process run(ensemble.command());
  ASSERT_TRUE(
      eventually(run, [&] { return std::filesystem::exists(ensemble.member(0).trajectory()); }));
  run.send(SIGINT);
  EXPECT_EQ(run.wait().code, 128 + SIGINT);
  EXPECT_EQ(all_of(text_of(ensemble.json()), "code"), Arguments(3, "130"));
  EXPECT_GT(driver::TrajectoryReader(ensemble.member(0).trajectory()).frames(), 0);
}

TEST(Ensemble, TwoOnOneOutputAreRefused)
{
  Folder const folder;
  Arguments const gas{write_small_gas(folder), "--steps", "10000000", "--every", "1000"};
  Members const ensemble{folder, gas + Arguments{"--vary", "seed", "--members", "3"}};
  Process first(ensemble.resume());
  ASSERT_TRUE(eventually(first, [&] { return ensemble.member(0).step() > 0; }));
  Job const member{folder, "m_0000", gas + Arguments{"-q", "--force"}};
  for (Arguments const& second : {ensemble.resume(), member.run()}) {
    Outcome const refused = ricochet(second);
    EXPECT_EQ(refused.code, 73) << refused.err;
    EXPECT_TRUE(contains(refused.err, "another run is at work")) << refused.err;
  }
  first.send(SIGTERM);
  EXPECT_EQ(first.wait().code, 75);
  for (std::string const& name : folder.names())
    EXPECT_NE(name[0], '.') << name << " is left over";
}

TEST(Ensemble, MistakesAreToldBeforeAnythingBegins)
{
  Folder const folder;
  std::string const gas = write_small_gas(folder);
  folder.write("m_0001.h5md", "mine");
  std::string const out = folder / "m.h5md";
  struct {
    int code;
    Arguments words;
    std::string part;
  } const calls[] = {
      {64, {"--members", "3"}, "nothing varies"},
      {64, {"--vary", "seed"}, "--members"},
      {64, {"--members", "0", "--vary", "seed"}, "--members: found 0"},
      {64, {"--members", "2", "--vary", "run.dt"}, "--vary: found 'run.dt' without '='"},
      {64, {"--members", "2", "--vary", "run.dx=1,2"}, "unknown key 'dx'"},
      {64,
       {"--members", "3", "--vary", "contact.restitution=0.5..1.5"},
       "--vary contact.restitution: found 1.5 (allowed: 0 to 1)"},
      {64, {"--members", "3", "--vary", "discs.generate.count=1..2"}, "found '1.5'"},
      {64, {"--members", "2", "--vary", "seed", "--set", "discs.generate.seed=1"}, "second time"},
      {64, {"--members", "2", "--vary", "seed", "--final", "-"}, "--final"},
      {64, {"--members", "2", "--vary", "seed", "--resume", "c.chk.h5"}, "--resume"},
      {64, {"--members", "2", "--vary", "seed", "--csv", "-", "--json", "-"}, "--csv"},
      {73, {"--members", "2", "--vary", "seed", "-o", out}, "m_0001.h5md': it exists already"},
      {73, {"--members", "2", "--vary", "seed", "--csv", gas}, "it is an input"},
  };
  for (auto const& call : calls) {
    Outcome const outcome = ricochet(Arguments{"ensemble", gas} + call.words);
    EXPECT_EQ(outcome.out, "");
    EXPECT_EQ(outcome.code, call.code) << call.part << ": " << outcome.err;
    EXPECT_TRUE(contains(outcome.err, call.part)) << call.part << ": " << outcome.err;
  }
  EXPECT_EQ(folder.names(), (Arguments{"gas.toml", "m_0001.h5md"}));
  EXPECT_EQ(text_of(folder / "m_0001.h5md"), "mine");
}

} // namespace
} // namespace ricochet::test
