// Scenes from their text to their result, by the program and by its parts.
#include "exit_codes.hpp"
#include "jobs.hpp"
#include "outlook.hpp"
#include "random.hpp"
#include "scene.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace ricochet::test {
namespace {

using namespace driver;

// The only value of `key` in a summary.
std::string value(std::string const& json, std::string const& key)
{
  auto const values = all_of(json, key);
  EXPECT_EQ(values.size(), 1u) << key << "\n" << json;
  return values.empty() ? "" : values.front();
}

std::string hash_of(std::vector<std::string> arguments)
{
  arguments.insert(arguments.end(), {"--json", "-", "-q"});
  Outcome const outcome = ricochet(arguments);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return value(outcome.out, "state_hash");
}

std::string const lively = R"([box]
width = 120
height = 80
[discs]
radius = 2
[discs.generate]
count = 150
temperature = 300
seed = 3
[run]
engine = "sweep"
steps_per_time = 50
duration = 4
)";

TEST(Scenes, TheRoundTripOfASceneKeepsItsHash)
{
  Folder const folder;
  auto const toml = folder.write("s.toml", lively);
  auto const csv = folder / "s.csv", config = folder / "c.csv";
  ASSERT_EQ(ricochet({"generate", toml, "-o", csv, "--config", config}).code, 0);
  EXPECT_EQ(ricochet({"validate", toml}).code, 0);
  EXPECT_EQ(ricochet({"validate", csv, config}).code, 0);
  EXPECT_EQ(text_of(config),
            "g=9.81,alpha=0.93,beta=0.93,width=120,height=80,radius=2,fps=50,totTime=4\n");

  std::string const hash = hash_of({toml});
  EXPECT_EQ(hash_of({"run", csv, config}), hash);
  for (auto const& scene :
       {std::vector<std::string>{toml}, std::vector<std::string>{csv, config}}) {
    auto arguments = scene;
    arguments.insert(arguments.end(), {"--print-scene"});
    Outcome const printed = ricochet(arguments);
    EXPECT_EQ(printed.code, 0);
    EXPECT_EQ(printed.err, "");
    std::filesystem::create_directory(folder / "elsewhere");
    EXPECT_EQ(hash_of({folder.write("elsewhere/p.toml", printed.out)}), hash);
  }
}

TEST(Scenes, APrintedSceneHoldsWhatTheOptionsSay)
{
  Folder const folder;
  auto const crowded = folder.write("c.csv", "0,0,30,1\n1,1,-20,0\n2,3,4,5\n");
  auto const toml =
      folder.write("s.toml", "[discs]\nstates = \"c.csv\"\n" + lively.substr(lively.find("[run]")));
  std::vector<std::string> const options[] = {
      {"--dt", "0.01"},
      {"--steps", "77", "--law", "restitution"},
      {"--precision", "single", "--set", "forces.gravity=-3.25"},
      {"--relax", "--set", "contact.restitution=0.5"},
      {"--engine", "simultaneous", "--set", "box.x=periodic"}};
  std::string const plain = hash_of({toml});
  for (auto arguments : options) {
    arguments.insert(arguments.begin(), toml);
    std::string const hash = hash_of(arguments);
    EXPECT_NE(hash, plain) << arguments[1];
    arguments.emplace_back("--print-scene");
    EXPECT_EQ(hash_of({folder.write("p.toml", ricochet(arguments).out)}), hash) << arguments[1];
  }
}

TEST(Scenes, TheOriginalsCallDoesTheSequentialModelWithItsLaw)
{
  Folder const folder;
  std::vector<std::string> const call{scene("seven_discs.csv"),
                                      folder.write("c.csv", "g=10,radius=10")};
  auto plain = call;
  plain.insert(plain.end(), {"--json", "-", "-q"});
  std::string const summary = ricochet(plain).out;
  EXPECT_EQ(value(summary, "engine"), "\"sweep\"");
  EXPECT_EQ(value(summary, "law"), "\"swap_scale\"");
  EXPECT_EQ(value(summary, "precision"), "\"double\"");
  EXPECT_EQ(value(summary, "steps"), "2700");
  Outcome const outcome = ricochet(call);
  EXPECT_EQ(outcome.code, 0);
  EXPECT_EQ(std::count(outcome.out.begin(), outcome.out.end(), '\n'), 7);
  EXPECT_EQ(hash_of({scene("seven_discs.toml")}), value(summary, "state_hash"));
}

TEST(Scenes, ReadyMadeOnesAreValidAndSayWhatTheyShow)
{
  int count = 0;
  for (auto const& entry : std::filesystem::directory_iterator(scene("")))
    if (entry.path().extension() == ".toml") {
      ++count;
      std::string const path = entry.path().string();
      EXPECT_EQ(text_of(path).substr(0, 2), "# ") << path;
      Outcome const outcome = ricochet({"validate", path});
      EXPECT_EQ(outcome.code, 0) << outcome.err;
      EXPECT_TRUE(contains(outcome.out, ": valid: ")) << outcome.out;
    }
  EXPECT_GE(count, 10);
}

TEST(Scenes, ABadOneIsRefusedByEveryCommandWithTheSameWords)
{
  Folder const folder;
  auto const bad =
      folder.write("s.toml", "[box]\nwidth = -1\n[run]\nengine = \"sweep\"\ndtt = 1\n");
  std::string first;
  for (auto const& command : {"run", "validate", "generate"}) {
    Outcome const outcome = ricochet({command, bad});
    EXPECT_EQ(outcome.code, 65);
    EXPECT_EQ(outcome.out, "");
    EXPECT_TRUE(contains(outcome.err, bad + ":2:9: box.width: found -1 (")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, bad + ":5:1: unknown key 'dtt' (")) << outcome.err;
    EXPECT_TRUE(contains(outcome.err, "did you mean 'dt'?")) << outcome.err;
    first = first.empty() ? outcome.err : first;
    EXPECT_EQ(outcome.err, first);
  }
}

TEST(Scenes, WarningsHaveAPlaceAndAreNoErrors)
{
  Folder const folder;
  folder.write("s.csv", "0,0,1,1\n0,3,1,1\n39,0,1,1\n");
  struct {
    char const* text;
    char const* place;
    char const* warning;
  } const cases[] = {
      {"[discs]\nstates = \"s.csv\"\n",
       ":2:10: warning: ", "1 pairs of discs overlap, discs 0 and 1"},
      {"[discs]\nstates = \"s.csv\"\n[box]\nwidth = 80\n",
       ":2:10: warning: ", "1 discs poke through a wall"},
      {"[discs.generate]\ncount = 9\ntemperature = 90\n[run]\ndt = 1\n",
       ":5:6: warning: ", "radii in a step"},
      {"[discs.generate]\ncount = 9\ntemperature = 9\n[run]\ndt = 0.1\n[forces]\ngravity = 0\n",
       ":5:6: warning: ", "a thermal disc moves 0.05 diameters in a step"},
      {"[discs.generate]\npacking_fraction = 0.7\narrangement = \"triangular\"\n",
       ":2:20: warning: ", "near or above freezing"},
      {"[discs.generate]\npacking_fraction = 0.65\narrangement = \"triangular\"\ntemperature = "
       "100\n"
       "[run]\ndt = 0.1\n[forces]\ngravity = 0\n",
       ":6:6: warning: ", "collisions of a disc are expected in a step"},
      {"[discs.generate]\ncount = 9000\n[forces]\ngravity = 0\n[contact]\nrestitution = 0.9\n",
       ":6:15: warning: ", "inelastic collapse is likely"},
      {"[discs.generate]\ncount = 2\n[contact]\nrestitution = 0.9\n",
       ":4:15: warning: ", "come to rest on each other"},
  };
  for (auto const& c : cases) {
    auto const toml = folder.write("s.toml", c.text);
    Outcome const outcome = ricochet({"validate", toml, "--set", "run.engine=sweep"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    std::size_t const at = outcome.out.find(c.warning);
    ASSERT_NE(at, std::string::npos) << c.warning << "\n" << outcome.out;
    std::size_t const line = outcome.out.rfind('\n', at) + 1;
    EXPECT_EQ(outcome.out.substr(line, toml.size() + std::string(c.place).size()), toml + c.place);
  }
  Outcome const calm = ricochet(
      {"validate",
       folder.write("s.toml",
                    "[discs.generate]\ncount = 100\ntemperature = 1\n[forces]\n"
                    "gravity = 0\n[contact]\nrestitution = 1\n[run]\nengine = \"sweep\"\n")});
  EXPECT_TRUE(contains(calm.out, " 0 warnings")) << calm.out;
}

// Kinetic theory, evaluated by hand: sigma = 1, packing 0.1 in 100 x 100, T = 4. Event-driven truth
// (see physics/test_cooling.cpp): 0.5329 collisions of a disc per sigma / sqrt(T).
TEST(Scenes, TheOutlookIsThatOfKineticTheory)
{
  Folder const folder;
  Scene const scene = read_scene(
      {folder.write("s.toml",
                    "[box]\nwidth = 100\nheight = 100\n[discs]\nradius = 0.5\n"
                    "[discs.generate]\npacking_fraction = 0.1\ntemperature = 4\n[forces]\n"
                    "gravity = 0\n[run]\nengine = \"sweep\"\ndt = 0.01\nduration = 1\n"),
       "",
       {}});
  Outlook const o = outlook(scene);
  EXPECT_NEAR(o.packing, 0.1, 1e-4); // a whole number of discs
  EXPECT_NEAR(o.temperature, 4, 1e-12);
  EXPECT_NEAR(o.collision_rate, 0.5329 * 2, 0.002);
  EXPECT_NEAR(o.free_path, std::sqrt(std::acos(-1) * 2) / (0.5329 * 2), 0.005); // mean speed / rate
  EXPECT_NEAR(o.collisions_a_step, 0.5329 * 2 * 0.01, 2e-5);
  EXPECT_DOUBLE_EQ(o.step_in_sizes, 2 * 0.01);
}

TEST(Scenes, ADryRunWritesNothingAndForecastsSizes)
{
  Folder const folder;
  auto const toml = folder.write("s.toml", lively);
  auto const file = folder / "t.h5md";
  for (auto const& options :
       {std::vector<std::string>{"--every", "1"}, std::vector<std::string>{"--every", "50"},
        std::vector<std::string>{"--every", "2", "--compress", "deflate"},
        std::vector<std::string>{"--every", "2", "--float32", "--fields", "position"}}) {
    auto arguments = options;
    arguments.insert(arguments.begin(), {"run", toml, "-o", file});
    auto dry = arguments;
    dry.emplace_back("--dry-run");
    Outcome const outcome = ricochet(dry);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_FALSE(std::filesystem::exists(file));
    for (char const* word : {"discs       150", "steps       200", "memory", "trajectory", "time"})
      EXPECT_TRUE(contains(outcome.out, word)) << outcome.out;
    std::size_t const at = outcome.out.find("trajectory  ") + 12;
    double const forecast = std::stod(outcome.out.substr(at)) * 1e6;

    EXPECT_EQ(ricochet(arguments).code, 0);
    auto const real = static_cast<double>(std::filesystem::file_size(file));
    EXPECT_NEAR(forecast, real, 0.3 * real) << options[1];
    std::filesystem::remove(file);
  }
}

TEST(Scenes, OutputIsThatOfTheSceneUnlessAnOptionSaysOtherwise)
{
  Folder const folder;
  auto const file = folder / "a.h5md", other = folder / "b.h5md";
  auto const toml =
      folder.write("s.toml", lively + "[output]\nfile = \"" + file + "\"\nevery_time = 1\n");
  EXPECT_EQ(ricochet({toml, "-q"}).code, 0);
  EXPECT_EQ(TrajectoryReader(file).frames(), 5);
  EXPECT_EQ(ricochet({toml, "-q"}).code, 73) << "it exists";
  EXPECT_EQ(ricochet({toml, "-q", "-o", other, "--every", "100"}).code, 0);
  EXPECT_EQ(TrajectoryReader(other).frames(), 3);
  // What the file says of its scene is a scene again.
  auto const again = folder.write("again.toml", TrajectoryReader(other).text("scene"));
  EXPECT_EQ(hash_of({again, "-o", folder / "c.h5md"}), hash_of({toml, "-o", folder / "d.h5md"}));
}

TEST(Scenes, FrameOptionsNeedATrajectory)
{
  Folder const folder;
  auto const toml = folder.write("s.toml", lively);
  for (auto const& options :
       {std::vector<std::string>{"--every", "2"}, std::vector<std::string>{"--float32"}}) {
    auto arguments = options;
    arguments.insert(arguments.begin(), toml);
    Outcome const outcome = ricochet(arguments);
    EXPECT_EQ(outcome.code, 64);
    EXPECT_EQ(outcome.err,
              "ricochet: " + options[0] + ": needs a trajectory: add --output FILE.h5md\n");
  }
}

TEST(Scenes, PressureIsMeasuredFromTheMomentAskedFor)
{
  Folder const folder;
  auto const toml = folder.write("s.toml", lively);
  std::vector<std::string> const run{toml, "--every", "50", "-q", "--set", "contact.restitution=1"};
  auto const z_of = [&](std::vector<std::string> more) {
    more.insert(more.begin(), run.begin(), run.end());
    more.insert(more.end(), {"-o", folder / "t.h5md", "--force"});
    EXPECT_EQ(ricochet(more).code, 0);
    return TrajectoryReader(folder / "t.h5md").observable("pressure_z");
  };
  auto const all = z_of({}), late = z_of({"--set", "run.measure_from=2"});
  ASSERT_EQ(all.size(), 5u);
  ASSERT_EQ(late.size(), 5u);
  for (std::size_t frame = 0; frame < 3; ++frame)
    EXPECT_TRUE(std::isnan(late[frame])) << frame;
  EXPECT_FALSE(std::isnan(late[3]));
  EXPECT_NE(late[4], all[4]);
}

TEST(Scenes, GenerateRefusesOverlapsUnlessTheyAreRemoved)
{
  Folder const folder;
  folder.write("s.csv", "0,0,1,1\n0,3,1,1\n");
  auto const toml = folder.write("s.toml", "[discs]\nstates = \"s.csv\"\n");
  Outcome const refused = ricochet({"generate", toml});
  EXPECT_EQ(refused.code, 65);
  EXPECT_EQ(refused.err, toml + ":2:10: discs.states: 1 pairs of discs overlap, discs 0 and 1 by 3 "
                                "(the deepest) --relax separates them\n");
  Outcome const relaxed = ricochet({"generate", toml, "--relax", "-o", folder / "t.csv"});
  EXPECT_EQ(relaxed.code, 0);
  EXPECT_TRUE(contains(relaxed.err, "relax: moved 2 of 2 discs")) << relaxed.err;
  EXPECT_EQ(ricochet({"generate", folder / "t.csv"}).code, 0);
  Outcome const outside = ricochet({"generate", folder.write("u.csv", "369,0,0,0\n")});
  EXPECT_EQ(outside.code, 65);
  EXPECT_TRUE(contains(outside.err, "1 discs poke through a wall --relax")) << outside.err;
  Outcome const dense = ricochet({"generate", toml, "--relax", "--set", "box.width=7", "--set",
                                  "box.height=7", "--set", "discs.radius=3"});
  EXPECT_EQ(dense.code, 64) << "an option is to blame";
  EXPECT_TRUE(contains(dense.err, "the discs cover 1.154 of the box")) << dense.err;
  EXPECT_EQ(ricochet({"generate", toml, "--relax", "-o", folder / "t.csv"}).code, 73) << "exists";
  EXPECT_EQ(ricochet({"generate", folder / "t.csv", "-o", folder / "t.csv", "--force"}).code, 73);
}

// A scene with anything in it that a scene may have.
std::string random_scene(std::uint64_t seed)
{
  Random random(seed, 0);
  auto const between = [&](double low, double high) { return low + (high - low) * random.unit(); };
  auto const one_of = [&](std::vector<std::string> const& words) {
    return words[random.below(words.size())];
  };
  auto const magnitude = [&] { return std::pow(10.0, between(-6, 6)); };
  double const radius = magnitude(), width = radius * between(8, 60),
               height = radius * between(8, 60);
  std::string const y = one_of({"walls", "periodic"});
  std::string const arrangement = one_of({"random", "square", "triangular"});
  double const packing = between(0.001, arrangement == "random" ? 0.45 : 0.65);
  double const temperature = random.below(4) == 0 ? 0 : magnitude();
  // Steps of up to some diameters of a thermal disc.
  double const dt = radius / std::sqrt(temperature + 1e-3) * std::pow(10.0, between(-3, 0.5));
  double const gravity =
      y == "periodic" || random.below(3) == 0
          ? 0
          : (random.below(2) == 0 ? 1 : -1) * between(0, 0.1) * radius / (dt * dt);
  return fmt::format(
      "[box]\nwidth = {}\nheight = {}\nx = \"{}\"\ny = \"{}\"\n"
      "[discs]\nradius = {}\nrelax = {}\n"
      "[discs.generate]\npacking_fraction = {}\ntemperature = {}\narrangement = \"{}\"\n"
      "seed = {}\nzero_momentum = {}\n"
      "[forces]\ngravity = {}\n"
      "[contact]\nrestitution = {}\nfriction = {}\nlaw = \"{}\"\n"
      "[run]\nengine = \"{}\"\nprecision = \"{}\"\ndt = {}\nsteps = {}\n",
      width, height, one_of({"walls", "periodic"}), y, radius, one_of({"true", "false"}), packing,
      temperature, arrangement, random.bits() >> 1, one_of({"true", "false"}), gravity,
      random.below(3) == 0 ? 1 : random.unit(), random.below(3) == 0 ? 1 : random.unit(),
      one_of({"swap_scale", "restitution"}), one_of({"sweep", "simultaneous"}),
      one_of({"double", "single"}), dt, 20 + random.below(100));
}

TEST(Scenes, AnyValidOneRunsStaysFiniteAndBalancesItsBooks)
{
  int runs = 0;
  for (std::uint64_t seed = 0; seed < 150; ++seed) {
    Folder const folder;
    std::string const text = random_scene(seed);
    SCOPED_TRACE(text);
    Scene scene;
    try {
      scene = read_scene({folder.write("s.toml", text), "", {}});
    } catch (BadScene const& problems) {
      // One disc at rest has no temperature, and a lattice does not fit every small box.
      std::string const why = problems.what();
      EXPECT_TRUE(contains(why, "has no temperature") || contains(why, "do not fit")) << why;
      continue;
    }
    ++runs;
    auto const engine = make_engine(scene.model, scene.method, scene.discs);
    engine->advance(scene.steps);
    Report const report = engine->report();
    std::vector<DiscState> states(scene.discs.size());
    engine->states(states.data());
    for (DiscState const& disc : states)
      ASSERT_TRUE(std::isfinite(disc.x + disc.y + disc.vx + disc.vy));
    // Every entry is rounded to a share of 2^-80 of the initial energy or to its own precision, and
    // the sums to doubles; `simultaneous` may create far more energy than there was.
    EnergyLedger const& e = report.energy;
    double const scale = e.kinetic_initial + std::fabs(e.potential_initial) + e.kinetic +
                         std::fabs(e.potential) + std::fabs(e.lost_pairs) +
                         std::fabs(e.lost_walls) + std::fabs(e.numerical);
    double const rounding = scene.method.precision == Precision::double_ ? 1e-12 : 1e-4;
    ASSERT_LE(std::fabs(e.residual()), rounding * scale);
  }
  EXPECT_GT(runs, 100);
}

} // namespace
} // namespace ricochet::test
