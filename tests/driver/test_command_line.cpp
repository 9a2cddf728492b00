// The command line: what is understood, and what every mistake is told as.
#include "command_line.hpp"

#include "exit_codes.hpp"

#include <gtest/gtest.h>

namespace ricochet::driver {
namespace {

RunOptions run_options(std::vector<std::string> const& arguments)
{
  return std::get<RunOptions>(parse_command_line(arguments));
}

// The settings that the options of a command line make.
Settings settings_of(std::vector<std::string> const& arguments)
{
  Settings settings;
  ProblemList problems;
  apply(run_options(arguments).scene.overrides, settings, problems);
  EXPECT_EQ(problems.text(), "");
  return settings;
}

TEST(CommandLine, TheOriginalsCallIsRun)
{
  for (auto const& arguments : {std::vector<std::string>{"s.csv", "c.csv"},
                                std::vector<std::string>{"run", "s.csv", "c.csv"}}) {
    RunOptions const options = run_options(arguments);
    EXPECT_EQ(options.scene.file, "s.csv");
    EXPECT_EQ(options.scene.config, "c.csv");
    EXPECT_TRUE(options.scene.overrides.empty());
  }
  EXPECT_EQ(run_options({"--quiet", "s.csv"}).scene.file, "s.csv");
  EXPECT_EQ(run_options({"s.toml"}).scene.file, "s.toml");
}

TEST(CommandLine, EveryOptionOfRunArrives)
{
  std::vector<std::string> const arguments{"run",
                                           "s.csv",
                                           "-o",
                                           "t.h5md",
                                           "--every",
                                           "10",
                                           "--fields",
                                           "position",
                                           "--float32",
                                           "--compress",
                                           "deflate",
                                           "--final",
                                           "-",
                                           "--json",
                                           "j",
                                           "--engine",
                                           "simultaneous",
                                           "--precision",
                                           "single",
                                           "--law",
                                           "restitution",
                                           "--dt",
                                           "0.125",
                                           "--duration",
                                           "2",
                                           "--threads",
                                           "3",
                                           "--force",
                                           "--quiet",
                                           "--relax",
                                           "--set",
                                           "box.width=7.5",
                                           "--set",
                                           "box.x = periodic",
                                           "--dry-run",
                                           "--print-scene",
                                           "--kokkos-disable-warnings"};
  Settings const s = settings_of(arguments);
  EXPECT_EQ(s.file, "t.h5md");
  EXPECT_EQ(s.every, 10);
  EXPECT_EQ(s.velocity, false);
  EXPECT_EQ(s.float32, true);
  EXPECT_EQ(s.compression, Compression::deflate);
  EXPECT_EQ(s.engine, EngineKind::simultaneous);
  EXPECT_EQ(s.precision, Precision::single_);
  EXPECT_EQ(s.law, Law::restitution);
  EXPECT_EQ(s.dt, 0.125);
  EXPECT_EQ(s.steps_per_time, std::nullopt) << "dt replaces it";
  EXPECT_EQ(s.duration, 2);
  EXPECT_EQ(s.relax, true);
  EXPECT_EQ(s.width, 7.5);
  EXPECT_EQ(s.x, Boundary::periodic);
  RunOptions const o = run_options(arguments);
  EXPECT_EQ(o.final_file, "-");
  EXPECT_EQ(o.json, "j");
  EXPECT_EQ(o.kokkos.threads, 3);
  EXPECT_TRUE(o.force);
  EXPECT_TRUE(o.dry_run);
  EXPECT_TRUE(o.print_scene);
  EXPECT_TRUE(o.kokkos.quiet);
  EXPECT_EQ(o.kokkos.flags, std::vector<std::string>{"--kokkos-disable-warnings"});
  EXPECT_EQ(settings_of({"s.csv", "--steps-per-time", "8"}).steps_per_time, 8);
  EXPECT_EQ(settings_of({"s.csv", "--steps", "0"}).steps, 0);
  EXPECT_EQ(settings_of({"s.csv", "--every-time", "0.5"}).every_time, 0.5);
}

TEST(CommandLine, OtherCommandsTakeAScene)
{
  auto const g = std::get<GenerateOptions>(
      parse_command_line({"generate", "s.toml", "-o", "s.csv", "--config", "c.csv", "--set",
                          "discs.generate.seed=7", "--relax", "--force"}));
  EXPECT_EQ(g.scene.file, "s.toml");
  EXPECT_EQ(g.output, "s.csv");
  EXPECT_EQ(g.config, "c.csv");
  EXPECT_EQ(g.scene.overrides.size(), 2u);
  EXPECT_TRUE(g.force);
  EXPECT_EQ(std::get<GenerateOptions>(parse_command_line({"generate", "s.toml"})).output, "-");
  auto const v = std::get<ValidateOptions>(parse_command_line({"validate", "s.csv", "c.csv"}));
  EXPECT_EQ(v.scene.file, "s.csv");
  EXPECT_EQ(v.scene.config, "c.csv");
}

TEST(CommandLine, TheCommandLineIsKeptInAFormThatAShellTakesBack)
{
  EXPECT_EQ(run_options({"a b.csv", "--final", "it's", "-q"}).command_line,
            "ricochet 'a b.csv' --final 'it'\\''s' -q");
}

TEST(CommandLine, EveryHelpHasExamples)
{
  for (auto const& arguments :
       {std::vector<std::string>{"--help"}, std::vector<std::string>{"run", "--help"},
        std::vector<std::string>{"generate", "--help"}, std::vector<std::string>{"validate", "-h"},
        std::vector<std::string>{"info", "--help"}, std::vector<std::string>{"compare", "-h"}}) {
    Answer const answer = std::get<Answer>(parse_command_line(arguments));
    EXPECT_NE(answer.text.find("Examples:"), std::string::npos) << arguments[0];
  }
}

struct BadCall {
  std::vector<std::string> arguments;
  char const* message;
};

class BadCalls : public testing::TestWithParam<BadCall> {};

TEST_P(BadCalls, AreUsageErrorsThatSayWhatIsAllowed)
{
  try {
    parse_command_line(GetParam().arguments);
    FAIL() << GetParam().message;
  } catch (Failure const& failure) {
    EXPECT_EQ(failure.code(), Exit::usage);
    EXPECT_STREQ(failure.what(), GetParam().message);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadCalls,
    testing::Values(
        BadCall{{}, "no STATES file and no command (`ricochet --help` explains)"},
        BadCall{{"rnu", "s.csv"},
                "rnu: unknown command; did you mean 'run'? (a file of that name is ./rnu)"},
        BadCall{{"--quiet", "run", "s.csv"},
                "--quiet: options follow the command: ricochet run ..."},
        BadCall{{"s.csv", "-anim"}, "-anim: unknown option (`ricochet run --help` explains)"},
        BadCall{
            {"s.csv", "--forse"},
            "--forse: unknown option; did you mean '--force'? (`ricochet run --help` explains)"},
        BadCall{{"s.csv", "c.csv", "d.csv"},
                "d.csv: unknown argument (`ricochet run --help` explains)"},
        BadCall{{"s.csv", "--final", "-", "--json", "-"},
                "--final - and --json - both ask for standard output: give one of them a file"},
        BadCall{{"s.csv", "-o", "-"},
                "--output: found '-' (allowed: a file; a trajectory cannot go to standard output)"},
        BadCall{{"s.toml", "c.csv"}, "c.csv: a scene in TOML takes no CONFIG"},
        BadCall{{"s.toml", "--set", "run.dt"},
                "--set: found 'run.dt' without '=' (allowed: section.key=value)"},
        BadCall{{"s.toml", "--set", "run.td=1"},
                "--set run.td: unknown key 'td' (allowed in run: duration, steps, until, "
                "steps_per_time, "
                "dt, engine, precision, measure_from) did you mean 'dt'?"},
        BadCall{{"s.toml", "--set", "run.dt=fast"},
                "--set run.dt: found 'fast', which is not a decimal number (allowed: a decimal "
                "number > 0)"},
        BadCall{{"s.toml", "--dt", "1", "--set", "run.dt=2"},
                "--dt: found a second time (first as --set run.dt) keep one of them"},
        BadCall{{"s.toml", "--steps", "1", "--duration", "2"},
                "--steps: found beside run.duration as --duration (only one of them can hold) keep "
                "one of them"},
        BadCall{{"s.toml", "--set", "discs.generate.count=1", "--set", "discs.states=s.csv"},
                "--set discs.states: found beside discs.generate.count as --set "
                "discs.generate.count (only one of them can hold) keep one of them"},
        BadCall{{"s.toml", "--dt", "0", "--law", "x"},
                "--law: found 'x' (allowed: swap_scale, restitution)\n--dt: found 0 (allowed: a "
                "decimal number > 0)"},
        BadCall{{"s.toml", "--engine", "contacts"},
                "--engine: found 'contacts' (allowed: sweep, simultaneous, toi, events)"},
        BadCall{{"generate", "s.toml", "--config", "-"},
                "--output and --config both ask for standard output: give one of them a file"},
        BadCall{{"validate", "s.toml", "--engine", "sweep"},
                "--engine: unknown option (`ricochet validate --help` explains)"},
        BadCall{{"generat", "s.toml"},
                "generat: unknown command; did you mean 'generate'? (a file of that name is "
                "./generat)"},
        BadCall{{"s.csv", "--every", "0", "-o", "t"},
                "--every: found 0 (allowed: an integer in 1...9007199254740992)"},
        BadCall{{"s.csv", "--every", "1.5", "-o", "t"},
                "--every: found '1.5', which is not an integer (allowed: an integer in "
                "1...9007199254740992)"},
        BadCall{{"s.csv", "--every-time", "0", "-o", "t"},
                "--every-time: found 0 (allowed: a decimal number > 0)"},
        BadCall{{"s.csv", "--steps", "-1"},
                "--steps: found -1 (allowed: an integer in 0...9007199254740992)"},
        BadCall{{"s.csv", "--steps", "0x10"},
                "--steps: found '0x10', which is hexadecimal (allowed: an integer in "
                "0...9007199254740992)"},
        BadCall{{"s.csv", "--dt", "0"}, "--dt: found 0 (allowed: a decimal number > 0)"},
        BadCall{{"s.csv", "--dt", "nan"},
                "--dt: found 'nan', which is not finite (allowed: a decimal number > 0)"},
        BadCall{{"s.csv", "--steps-per-time", "1e-320"},
                "--steps-per-time: found 1e-320 (allowed: what has a reciprocal)"},
        BadCall{{"s.csv", "--duration", "-2"},
                "--duration: found -2 (allowed: a decimal number >= 0)"},
        BadCall{{"s.csv", "--threads", "0"},
                "--threads: found 0 (allowed: an integer in 1...65536)"},
        BadCall{{"s.csv", "--engine", "swep"},
                "--engine: found 'swep' (allowed: sweep, simultaneous, toi, events) did you mean "
                "'sweep'?"},
        BadCall{{"s.csv", "--law", "x"}, "--law: found 'x' (allowed: swap_scale, restitution)"},
        BadCall{{"s.csv", "--precision", "half"},
                "--precision: found 'half' (allowed: double, single)"},
        BadCall{{"s.csv", "--compress", "gzip", "-o", "t"},
                "--compress: found 'gzip' (allowed: auto, none, deflate)"},
        BadCall{{"s.csv", "--fields", "velocity", "-o", "t"},
                "--fields: found no position (allowed: position; position,velocity)"},
        BadCall{{"s.csv", "--fields", "position,spin", "-o", "t"},
                "--fields: found 'spin' (allowed: position; position,velocity)"},
        BadCall{{"s.csv", "--final", ""}, "--final: found no file name"},
        BadCall{{"compare", "a", "b", "--tolerance", "-1"},
                "--tolerance: found -1 (allowed: a decimal number >= 0)"},
        BadCall{{"info", "a", "--kokkos-threads=2"},
                "--kokkos-threads=2: only `ricochet run`, `ensemble` and `render` start Kokkos"}));

TEST(CommandLine, TheOriginalsWordForTheAnimationIsKnown)
{
  EXPECT_EQ(run_options({"s.csv", "c.csv", "-animate"}).watching, Watching::animation);
  EXPECT_EQ(run_options({"s.csv", "--window"}).watching, Watching::window);
  EXPECT_EQ(run_options({"s.csv"}).watching, Watching::no);
}

TEST(CommandLine, OptionsThatContradictEachOtherAreRefused)
{
  for (auto const& arguments :
       {std::vector<std::string>{"s.csv", "--dt", "1", "--steps-per-time", "1"},
        std::vector<std::string>{"s.csv", "--steps", "1", "--duration", "1"},
        std::vector<std::string>{"s.csv", "-o", "t", "--every", "1", "--every-time", "1"},
        std::vector<std::string>{"s.csv", "--dt", "1", "--dt", "2"},
        std::vector<std::string>{"s.csv", "--dt"}, std::vector<std::string>{"info"},
        std::vector<std::string>{"compare", "a"}}) {
    try {
      parse_command_line(arguments);
      FAIL() << arguments[1];
    } catch (Failure const& failure) {
      EXPECT_EQ(failure.code(), Exit::usage) << failure.what();
    }
  }
}

} // namespace
} // namespace ricochet::driver
