// Scenes in TOML: what they mean, and what every mistake is told as.
#include "scene_toml.hpp"

#include "exit_codes.hpp"
#include "process.hpp"
#include "scene.hpp"

#include <gtest/gtest.h>

namespace ricochet::driver {
namespace {

using test::Folder;

#define TWO_DISCS "[discs.generate]\ncount = 2\n"
#define SWEEP "[run]\nengine = \"sweep\"\n"

// What is wrong with a scene of this text, as the program prints it; it is called s.toml, and
// beside it is s.csv with one disc.
std::string problems_of(std::string const& text, std::vector<Override> const& overrides = {})
{
  Folder const folder;
  folder.write("s.csv", "0,0,1,1\n");
  std::string message;
  try {
    read_scene({folder.write("s.toml", text), "", overrides});
  } catch (Failure const& failure) {
    message = failure.what();
    EXPECT_EQ(failure.code(),
              dynamic_cast<BadScene const*>(&failure) ? Exit::bad_data : Exit::usage);
  }
  std::string const path = folder.path() + "/";
  for (std::size_t at = message.find(path); at != std::string::npos; at = message.find(path))
    message.erase(at, path.size());
  return message;
}

Scene good(std::string const& text, std::vector<Override> const& overrides = {})
{
  Folder const folder;
  folder.write("s.csv", "0,0,1,1\n");
  return read_scene({folder.write("s.toml", text), "", overrides});
}

TEST(TomlScene, DefaultsAreTheOriginals)
{
  Scene const scene = good(TWO_DISCS SWEEP);
  EXPECT_EQ(scene.model.box.width, 740);
  EXPECT_EQ(scene.model.box.height, 740);
  EXPECT_EQ(scene.model.box.x, Boundary::walls);
  EXPECT_EQ(scene.model.box.y, Boundary::walls);
  EXPECT_EQ(scene.model.radius, 3);
  EXPECT_EQ(scene.model.gravity, 9.81);
  EXPECT_EQ(scene.model.contact.restitution, 0.93);
  EXPECT_EQ(scene.model.contact.friction, 0.93);
  EXPECT_EQ(scene.model.contact.law, Law::swap_scale);
  EXPECT_EQ(scene.method.dt, 1.0 / 45);
  EXPECT_EQ(scene.method.precision, Precision::double_);
  EXPECT_EQ(scene.steps, 2700);
  EXPECT_EQ(scene.every, 1);
  EXPECT_EQ(scene.discs.size(), 2u);
}

TEST(TomlScene, EveryKeyIsRead)
{
  Scene const scene = good(R"(
box = { width = 75.5, height = 60, x = "periodic", y = "walls" } # inline
forces.gravity = -1.5                                            # dotted
[discs]
radius = 0.5
relax = true
[discs.generate]
packing_fraction = 0.1
temperature = 2
zero_momentum = true
arrangement = "square"
seed = 5
[contact]
restitution = 0.5
friction = 1
law = "restitution"
pairs = false
[run]
steps = 40
until = "rest"
dt = 0.125
engine = "simultaneous"
precision = "single"
measure_from = 2.5
[output]
file = "t.h5md"
every_time = 0.5
fields = ["position"]
float32 = true
compress = "none"
)");
  EXPECT_EQ(scene.model.box.width, 75.5);
  EXPECT_EQ(scene.model.box.height, 60);
  EXPECT_EQ(scene.model.box.x, Boundary::periodic);
  EXPECT_EQ(scene.model.box.y, Boundary::walls);
  EXPECT_EQ(scene.model.gravity, -1.5);
  EXPECT_EQ(scene.settings.until, Until::rest);
  EXPECT_EQ(scene.model.radius, 0.5);
  EXPECT_EQ(scene.discs.size(), 577u); // 0.1 * 75.5 * 60 / (pi / 4) = 576.8
  EXPECT_EQ(scene.model.contact.restitution, 0.5);
  EXPECT_EQ(scene.model.contact.friction, 1);
  EXPECT_EQ(scene.model.contact.law, Law::restitution);
  EXPECT_FALSE(scene.model.contact.pairs);
  EXPECT_EQ(scene.steps, 40);
  EXPECT_EQ(scene.method.dt, 0.125);
  EXPECT_EQ(scene.method.engine, EngineKind::simultaneous);
  EXPECT_EQ(scene.method.precision, Precision::single_);
  EXPECT_EQ(scene.measure_from, 20);
  EXPECT_EQ(scene.every, 4);
  EXPECT_EQ(scene.settings.relax, true);
  EXPECT_EQ(scene.settings.zero_momentum, true);
  EXPECT_EQ(scene.settings.seed, 5);
  EXPECT_EQ(scene.settings.file, "t.h5md");
  EXPECT_EQ(scene.settings.velocity, false);
  EXPECT_EQ(scene.settings.float32, true);
  EXPECT_EQ(scene.settings.compression, Compression::none);
}

TEST(TomlScene, StatesAreRelativeToTheScene)
{
  Scene const scene = good("[discs]\nstates = \"s.csv\"\n" SWEEP);
  ASSERT_EQ(scene.discs.size(), 1u);
  EXPECT_EQ(scene.discs[0].vx, 1);
}

TEST(TomlScene, OptionsOverrideTheSceneAndWhatItSaysInstead)
{
  std::string const texts[] = {"[discs]\nstates = \"s.csv\"\n" SWEEP
                               "dt = 0.1\nsteps = 50\n[output]\nevery_time = 1\n",
                               "[discs.generate]\npacking_fraction = 0.1\n" SWEEP
                               "steps_per_time = 10\nduration = 5\n[output]\nevery = 10\n"};
  for (std::string const& text : texts) {
    Scene const by_key = good(text, {{"--steps-per-time", "run.steps_per_time", "4"},
                                     {"--duration", "run.duration", "3"},
                                     {"--every", "output.every", "5"},
                                     {"--set", "discs.generate.count", "7"}});
    EXPECT_EQ(by_key.method.dt, 0.25);
    EXPECT_EQ(by_key.steps, 12);
    EXPECT_EQ(by_key.every, 5);
    EXPECT_EQ(by_key.discs.size(), 7u);
    Scene const by_other_key = good(text, {{"--dt", "run.dt", "0.5"},
                                           {"--steps", "run.steps", "3"},
                                           {"--every-time", "output.every_time", "1"},
                                           {"--set", "discs.states", "/dev/null"}});
    EXPECT_EQ(by_other_key.method.dt, 0.5);
    EXPECT_EQ(by_other_key.steps, 3);
    EXPECT_EQ(by_other_key.every, 2);
    EXPECT_TRUE(by_other_key.discs.empty());
  }
}

TEST(TomlScene, AnOptionThatDoesNotFitTheSceneIsBlamed)
{
  EXPECT_EQ(
      problems_of(TWO_DISCS SWEEP, {{"--set discs.radius", "discs.radius", "380"}}),
      "--set discs.radius: box.width: found 740 by default (allowed: at least 760, the "
      "diameter of a disc)\n--set discs.radius: box.height: found 740 by default (allowed: at "
      "least 760, the diameter of a disc)");
  EXPECT_EQ(problems_of(TWO_DISCS SWEEP "duration = 1\n", {{"--dt", "run.dt", "0.3"}}),
            "--dt: run.duration 1 is not a whole number of steps (dt = 0.3 gives 3.333333333) dt = "
            "0.3333333333333333 makes it 3");
}

TEST(TomlScene, PrintedItReadsAsTheSame)
{
  std::string const texts[] = {
      TWO_DISCS SWEEP,
      "[discs]\nstates = \"s.csv\"\n" SWEEP "dt = 0.1\nsteps = 7\n[output]\nfields = "
      "[\"position\"]\nevery_time = 0.2\nfile = \"a \\\"b\\\" \\\\ \\u0007.h5md\"\n",
      "[box]\nwidth = 1e300\nheight = 1e22\n[forces]\ngravity = 5e-324\n" TWO_DISCS
      "temperature = 0.1\n" SWEEP,
  };
  for (std::string const& text : texts) {
    Folder const folder;
    folder.write("s.csv", "0,0,1,1\n");
    Scene const scene = read_scene({folder.write("s.toml", text), "", {}});
    std::string const printed = as_toml(scene.settings);
    Scene const again = read_scene({folder.write("t.toml", printed), "", {}});
    EXPECT_EQ(as_toml(again.settings), printed);
    EXPECT_EQ(again.model.box.width, scene.model.box.width);
    EXPECT_EQ(again.model.gravity, scene.model.gravity);
    EXPECT_EQ(again.method.dt, scene.method.dt);
    EXPECT_EQ(again.steps, scene.steps);
    EXPECT_EQ(again.settings.file, scene.settings.file);
    ASSERT_EQ(again.discs.size(), scene.discs.size());
    for (std::size_t i = 0; i < scene.discs.size(); ++i) {
      EXPECT_EQ(again.discs[i].x, scene.discs[i].x);
      EXPECT_EQ(again.discs[i].vy, scene.discs[i].vy);
    }
  }
}

// Every key has a place in the printed scene, so nothing that a scene says is lost there.
TEST(TomlScene, EverySettingIsPrinted)
{
  for (std::string const& key : setting_keys()) {
    Settings one;
    bool printed = false;
    for (char const* value : {"1", "0.5", "true", "random", "walls", "sweep", "swap_scale",
                              "double", "auto", "position", "rest"}) {
      ProblemList wrong;
      assign(one, key, Word{value}, {"--set", std::nullopt, key, value}, wrong);
      if (!wrong.empty()) {
        one = {};
        continue;
      }
      std::string const name = key.substr(key.rfind('.') + 1);
      printed = as_toml(one).find("\n" + name + " = ") != std::string::npos;
      break;
    }
    EXPECT_TRUE(printed) << key;
  }
}

struct Case {
  char const* text;
  char const* message;
};

class BadScenes : public testing::TestWithParam<Case> {};

TEST_P(BadScenes, AreToldWithPlaceFindingAndWhatIsAllowed)
{
  EXPECT_EQ(problems_of(GetParam().text), GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Table, BadScenes,
    testing::Values(
        Case{"", "s.toml:1:1: found no discs (discs.states names a file of them; "
                 "discs.generate.count or packing_fraction makes them) add count = 100 below "
                 "[discs.generate]\ns.toml:1:1: found no run.engine (allowed: "
                 "sweep, simultaneous, toi, events) add engine = \"sweep\" below [run]"},
        Case{SWEEP,
             "s.toml:1:1: found no discs (discs.states names a file of them; discs.generate.count "
             "or packing_fraction makes them) add count = 100 below [discs.generate]"},
        Case{TWO_DISCS, "s.toml:1:1: found no run.engine (allowed: sweep, simultaneous, toi, "
                        "events) add engine "
                        "= \"sweep\" below [run]"},
        Case{"gravity = 1\n" TWO_DISCS SWEEP,
             "s.toml:1:1: unknown key 'gravity' (allowed: box, discs, forces, contact, run, "
             "output, checkpoint) did you mean 'forces.gravity'?"},
        Case{TWO_DISCS SWEEP "duratoin = 1\n",
             "s.toml:5:1: unknown key 'duratoin' (allowed in run: duration, steps, until, "
             "steps_per_time, "
             "dt, engine, precision, measure_from) did you mean 'duration'?"},
        Case{TWO_DISCS SWEEP "foo = 1\n", "s.toml:5:1: unknown key 'foo' (allowed in run: "
                                          "duration, steps, until, steps_per_time, dt, "
                                          "engine, precision, measure_from)"},
        Case{TWO_DISCS SWEEP "[forcse]\ngravity = 1\n",
             "s.toml:5:2: unknown key 'forcse' (allowed: box, discs, forces, contact, run, output, "
             "checkpoint) "
             "did you mean 'forces'?"},
        Case{TWO_DISCS SWEEP "[physics]\nviscosity = 1\n",
             "s.toml:5:2: unknown key 'physics' (allowed: box, discs, forces, contact, run, "
             "output, checkpoint)"},
        Case{TWO_DISCS SWEEP "[box.size]\nwidth = 5\n",
             "s.toml:5:6: unknown key 'size' (allowed in box: width, height, x, y)"},
        Case{"box = 5\n" TWO_DISCS SWEEP,
             "s.toml:1:7: box: found no table (its keys stand below [box])"},
        Case{"[[box]]\nwidth = 5\n" TWO_DISCS SWEEP,
             "s.toml:1:1: box: found no table (its keys stand below [box])"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = \"heavy\"\n",
             "s.toml:6:11: forces.gravity: found 'heavy', which is not a number (allowed: a "
             "decimal number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = true\n",
             "s.toml:6:11: forces.gravity: found true, which is not a number (allowed: a decimal "
             "number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = nan\n",
             "s.toml:6:11: forces.gravity: found nan, which is not finite (allowed: a decimal "
             "number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = -inf\n",
             "s.toml:6:11: forces.gravity: found -inf, which is not finite (allowed: a decimal "
             "number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = [1, 2]\n",
             "s.toml:6:11: forces.gravity: found a list, which is not a number (allowed: a decimal "
             "number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = { x = 1 }\n",
             "s.toml:6:11: forces.gravity: found a table, which is not a number (allowed: a "
             "decimal number)"},
        Case{TWO_DISCS SWEEP "[forces]\ngravity = 2020-01-01\n",
             "s.toml:6:11: forces.gravity: found a date or time, which is not a number (allowed: a "
             "decimal number)"},
        Case{TWO_DISCS SWEEP "[box]\nwidth = -5\n",
             "s.toml:6:9: box.width: found -5 (allowed: a finite number above 0)"},
        Case{TWO_DISCS SWEEP "[box]\nwidth = 5\n",
             "s.toml:6:9: box.width: found 5 (allowed: at least 6, the diameter of a disc)"},
        Case{TWO_DISCS SWEEP "[box]\nheight = 0\n",
             "s.toml:6:10: box.height: found 0 (allowed: a finite number above 0)"},
        Case{TWO_DISCS SWEEP "[box]\nx = \"open\"\n",
             "s.toml:6:5: box.x: found 'open' (allowed: walls, periodic)"},
        Case{TWO_DISCS SWEEP "[box]\nx = \"period\"\n",
             "s.toml:6:5: box.x: found 'period' (allowed: walls, periodic) did you mean "
             "'periodic'?"},
        Case{TWO_DISCS SWEEP "[box]\ny = 1\n",
             "s.toml:6:5: box.y: found 1, which is not a text (allowed: walls, periodic)"},
        Case{TWO_DISCS SWEEP "[box]\ny = \"periodic\"\n",
             "s.toml:6:5: forces.gravity: found 9.81 by default (allowed: 0, because box.y is "
             "periodic and discs would fall for ever)"},
        Case{"[discs]\nradius = 0\n" TWO_DISCS SWEEP,
             "s.toml:2:10: discs.radius: found 0 (allowed: a finite number above 0)"},
        Case{"[discs]\nradius = 400\n" TWO_DISCS SWEEP,
             "s.toml:2:10: box.width: found 740 by default (allowed: at least 800, the diameter of "
             "a disc)\ns.toml:2:10: box.height: found 740 by default (allowed: at least 800, the "
             "diameter of a disc)"},
        Case{"[discs]\nradius = \"3\"\n" TWO_DISCS SWEEP,
             "s.toml:2:10: discs.radius: found '3', which is not a number (allowed: a decimal "
             "number)"},
        Case{"[discs]\nradius = 3\nrelax = \"yes\"\n" TWO_DISCS SWEEP,
             "s.toml:3:9: discs.relax: found 'yes' (allowed: true, false)"},
        Case{"[discs]\nstates = 5\n" SWEEP, "s.toml:2:10: discs.states: found 5, which is not a "
                                            "text (allowed: the name of a file)"},
        Case{"[discs]\nstates = \"\"\n" SWEEP,
             "s.toml:2:10: discs.states: found no name (allowed: the name of a file)"},
        Case{"[discs]\nstates = \"s.csv\"\n" TWO_DISCS SWEEP,
             "s.toml:4:9: discs.generate.count: found beside discs.states in line 2 (only one of "
             "them can hold) keep one of them"},
        Case{"[discs]\ncount = 5\n" SWEEP,
             "s.toml:2:1: unknown key 'count' (allowed in discs: radius, relax, states, generate) "
             "did you mean 'discs.generate.count'?"},
        Case{"[discs.generate]\ncount = -1\n" SWEEP,
             "s.toml:2:9: discs.generate.count: found -1 (allowed: an integer in 0...1073741823)"},
        Case{"[discs.generate]\ncount = 2.5\n" SWEEP,
             "s.toml:2:9: discs.generate.count: found 2.5, which is not an integer (allowed: an "
             "integer in 0...1073741823)"},
        Case{TWO_DISCS "packing_fraction = 0.1\n" SWEEP,
             "s.toml:3:20: discs.generate.packing_fraction: found beside discs.generate.count in "
             "line 2 (only one of them can hold) keep one of them"},
        Case{"[discs.generate]\npacking_fraction = 0\n" SWEEP,
             "s.toml:2:20: discs.generate.packing_fraction: found 0 (allowed: a decimal number > 0 "
             "and <= 0.9069)"},
        Case{"[discs.generate]\npacking_fraction = 0.95\n" SWEEP,
             "s.toml:2:20: discs.generate.packing_fraction: found 0.95 (allowed: a decimal number "
             "> 0 and <= 0.9069)"},
        Case{
            "[discs.generate]\npacking_fraction = 0.75\n" SWEEP,
            "s.toml:2:20: discs.generate.packing_fraction: 14526 discs would cover 0.75 of the box "
            "(allowed: up to 0.7 at random places, beyond which discs freeze) choose arrangement = "
            "\"triangular\""},
        Case{
            "[discs.generate]\ncount = 15000\n" SWEEP,
            "s.toml:2:9: discs.generate.count: 15000 discs would cover 0.7745 of the box "
            "(allowed: up to 0.7 at random places, beyond which discs freeze) choose arrangement = "
            "\"triangular\""},
        Case{"[discs.generate]\ncount = 30000\narrangement = \"triangular\"\n" SWEEP,
             "s.toml:2:9: discs.generate.count: 30000 discs would cover 1.549 of the box (allowed: "
             "up to 0.9069) make the box larger"},
        Case{"[discs.generate]\ncount = 16000\narrangement = \"square\"\n" SWEEP,
             "s.toml:2:9: discs.generate.count: 16000 discs do not fit on a lattice that fills the "
             "box (the best has a spacing of 5.646, less than the diameter 6) choose arrangement = "
             "\"triangular\""},
        Case{"[discs.generate]\npacking_fraction = 0.5\n[discs]\nradius = 1e-4\n" SWEEP,
             "s.toml:2:20: discs.generate.packing_fraction: this makes 8.72e+12 discs (allowed: "
             "fewer than 2^30)"},
        Case{TWO_DISCS "temperature = -1\n" SWEEP,
             "s.toml:3:15: discs.generate.temperature: found -1 (allowed: a decimal number >= 0)"},
        Case{TWO_DISCS "temperature = 1e999\n" SWEEP,
             "s.toml:3:20: not TOML (parsing floating-point: '1e999' could not be interpreted as a "
             "value)"},
        Case{"[discs.generate]\ncount = 1\ntemperature = 1\nzero_momentum = true\n" SWEEP,
             "s.toml:4:17: discs.generate.zero_momentum: one disc without momentum has no "
             "temperature (but one above 0 is asked for) set the temperature to 0"},
        Case{TWO_DISCS "zero_momentum = 1\n" SWEEP,
             "s.toml:3:17: discs.generate.zero_momentum: found 1 (allowed: true, false)"},
        Case{TWO_DISCS "arrangement = \"hexagonal\"\n" SWEEP,
             "s.toml:3:15: discs.generate.arrangement: found 'hexagonal' (allowed: random, square, "
             "triangular)"},
        Case{TWO_DISCS "arrangement = \"triangle\"\n" SWEEP,
             "s.toml:3:15: discs.generate.arrangement: found 'triangle' (allowed: random, square, "
             "triangular) did you mean 'triangular'?"},
        Case{TWO_DISCS "seed = -1\n" SWEEP, "s.toml:3:8: discs.generate.seed: found -1 (allowed: "
                                            "an integer in 0...9223372036854775807)"},
        Case{TWO_DISCS "seed = 1.0\n" SWEEP,
             "s.toml:3:8: discs.generate.seed: found 1.0, which is not an integer (allowed: an "
             "integer in 0...9223372036854775807)"},
        Case{TWO_DISCS SWEEP "[contact]\nrestitution = 1.5\n",
             "s.toml:6:15: contact.restitution: found 1.5 (allowed: 0 to 1)"},
        Case{TWO_DISCS SWEEP "[contact]\nfriction = -0.1\n",
             "s.toml:6:12: contact.friction: found -0.1 (allowed: 0 to 1)"},
        Case{TWO_DISCS SWEEP "[contact]\nlaw = \"swap\"\n",
             "s.toml:6:7: contact.law: found 'swap' (allowed: swap_scale, restitution)"},
        Case{TWO_DISCS SWEEP "[contact]\nalpha = 1\n",
             "s.toml:6:1: unknown key 'alpha' (allowed in contact: restitution, friction, law, "
             "pairs)"},
        Case{TWO_DISCS SWEEP "duration = -1\n",
             "s.toml:5:12: run.duration: found -1 (allowed: a decimal number >= 0)"},
        Case{TWO_DISCS SWEEP "duration = 1\nsteps = 5\n",
             "s.toml:6:9: run.steps: found beside run.duration in line 5 (only one of them can "
             "hold) keep one of them"},
        Case{TWO_DISCS SWEEP "duration = 1\ndt = 0.3\n",
             "s.toml:5:12: run.duration 1 is not a whole number of steps (dt = 0.3 gives "
             "3.333333333) dt = 0.3333333333333333 makes it 3"},
        Case{TWO_DISCS SWEEP "duration = 1e300\ndt = 1e-300\n",
             "s.toml:5:12: run.duration 1e+300 is inf steps of 1e-300, more than can be counted"},
        Case{TWO_DISCS SWEEP "steps = 1.5\n",
             "s.toml:5:9: run.steps: found 1.5, which is not an integer (allowed: an integer in "
             "0...9007199254740992)"},
        Case{TWO_DISCS SWEEP "steps = -1\n",
             "s.toml:5:9: run.steps: found -1 (allowed: an integer in 0...9007199254740992)"},
        Case{TWO_DISCS SWEEP "dt = 0\n",
             "s.toml:5:6: run.dt: found 0 (allowed: a decimal number > 0)"},
        Case{TWO_DISCS SWEEP "dt = 0.1\nsteps_per_time = 10\n",
             "s.toml:6:18: run.steps_per_time: found beside run.dt in line 5 (only one of them can "
             "hold) keep one of them"},
        Case{TWO_DISCS SWEEP "steps_per_time = 0\n",
             "s.toml:5:18: run.steps_per_time: found 0 (allowed: what has a reciprocal)"},
        Case{TWO_DISCS "[run]\nengine = \"event\"\n",
             "s.toml:4:10: run.engine: found 'event' (allowed: sweep, simultaneous, toi, events) "
             "did you mean 'events'?"},
        Case{TWO_DISCS "[run]\nengine = \"contacts\"\n",
             "s.toml:4:10: run.engine: found 'contacts' (allowed: sweep, simultaneous, toi, "
             "events)"},
        Case{TWO_DISCS "[run]\nengine = 3\n", "s.toml:4:10: run.engine: found 3, which is not a "
                                              "text (allowed: sweep, simultaneous, toi, events)"},
        Case{TWO_DISCS "[run]\nengin = \"sweep\"\n",
             "s.toml:4:1: unknown key 'engin' (allowed in run: duration, steps, until, "
             "steps_per_time, "
             "dt, engine, precision, measure_from) did you mean 'engine'?"},
        Case{TWO_DISCS SWEEP "precision = \"half\"\n",
             "s.toml:5:13: run.precision: found 'half' (allowed: double, single)"},
        Case{TWO_DISCS SWEEP "until = \"still\"\n",
             "s.toml:5:9: run.until: found 'still' (allowed: duration, rest)"},
        Case{TWO_DISCS SWEEP "until = \"rest\"\n[forces]\ngravity = 0\n",
             "s.toml:5:9: run.until: found \"rest\", but discs never rest without gravity leave it "
             "out"},
        Case{TWO_DISCS "[run]\nengine = \"events\"\nuntil = \"rest\"\n",
             "s.toml:5:9: run.until: found \"rest\", but discs never rest under engine events, "
             "which "
             "stops where contacts last leave it out"},
        Case{TWO_DISCS SWEEP "measure_from = 0.001\n",
             "s.toml:5:16: run.measure_from 0.001 is not a whole number of steps (dt = "
             "0.022222222222222223 gives 0.045) dt = 0.001 makes it 1"},
        Case{TWO_DISCS SWEEP "measure_from = 100\n",
             "s.toml:5:16: run.measure_from: found 100, which is after the end of the run (it "
             "takes 2700 steps of 0.022222222222222223)"},
        Case{TWO_DISCS SWEEP "tolerance = 0.01\n",
             "s.toml:5:1: unknown key 'tolerance' (allowed in run: duration, steps, "
             "until, steps_per_time, dt, engine, precision, measure_from)"},
        Case{TWO_DISCS SWEEP "[output]\nevery = 0\n",
             "s.toml:6:9: output.every: found 0 (allowed: an integer in 1...9007199254740992)"},
        Case{TWO_DISCS SWEEP "[output]\nevery = 2\nevery_time = 1\n",
             "s.toml:7:14: output.every_time: found beside output.every in line 6 (only one of "
             "them can hold) keep one of them"},
        Case{TWO_DISCS SWEEP "[output]\nevery_time = 0.3\n",
             "s.toml:6:14: output.every_time 0.3 is not a whole number of steps (dt = "
             "0.022222222222222223 gives 13.5) dt = 0.023076923076923075 makes it 13"},
        Case{
            TWO_DISCS SWEEP "[output]\nfields = [\"velocity\"]\n",
            "s.toml:6:10: output.fields: found no position (allowed: position; position,velocity)"},
        Case{TWO_DISCS SWEEP "[output]\nfields = [\"position\", \"spin\"]\n",
             "s.toml:6:10: output.fields: found 'spin' (allowed: position; position,velocity)"},
        Case{TWO_DISCS SWEEP "[output]\nfields = [\"position\", \"position\"]\n",
             "s.toml:6:10: output.fields: found 'position' twice (allowed: position; "
             "position,velocity)"},
        Case{TWO_DISCS SWEEP "[output]\nfields = 5\n",
             "s.toml:6:10: output.fields: found 5, which is not a list of texts (allowed: "
             "position; position,velocity)"},
        Case{TWO_DISCS SWEEP "[output]\nfloat32 = 1\n",
             "s.toml:6:11: output.float32: found 1 (allowed: true, false)"},
        Case{TWO_DISCS SWEEP "[output]\ncompress = \"zip\"\n",
             "s.toml:6:12: output.compress: found 'zip' (allowed: auto, none, deflate)"},
        Case{TWO_DISCS SWEEP "[output]\nfile = [\"a\"]\n",
             "s.toml:6:8: output.file: found [a], which is not a text (allowed: a file; a "
             "trajectory "
             "cannot go to standard output)"},
        Case{TWO_DISCS SWEEP "[output]\nfile = \"-\"\n",
             "s.toml:6:8: output.file: found '-' (allowed: a file; a trajectory cannot go to "
             "standard output)"},
        Case{TWO_DISCS SWEEP "dt = \n",
             "s.toml:5:6: not TOML (parsing key-value pair: expected value, saw '\\n')"},
        Case{TWO_DISCS SWEEP "dt = 0.1\ndt = 0.2\n",
             "s.toml:6:6: not TOML (parsing key-value pair: cannot redefine existing "
             "floating-point 'dt')"},
        Case{TWO_DISCS SWEEP "dt = 0x\nduration = 1 2\nfoo = 1\n",
             "s.toml:5:8: not TOML (parsing hexadecimal integer: expected digit, saw "
             "'\\n')\ns.toml:6:14: not TOML (parsing key-value pair: expected a comment or "
             "whitespace, saw '2')\ns.toml:7:1: unknown key 'foo' (allowed in run: duration, "
             "steps, until, steps_per_time, dt, engine, precision, measure_from)"},
        Case{TWO_DISCS "[run\nengine = \"sweep\"\n",
             "s.toml:3:5: not TOML (parsing table header: expected ']', saw '\\n')"},
        Case{TWO_DISCS SWEEP "file = \"unclosed\n",
             "s.toml:5:17: not TOML (parsing string: unescaped control characters other than TAB "
             "(U+0009) are explicitly prohibited)"},
        Case{TWO_DISCS "[run]\nengine = sweep\n",
             "s.toml:4:10: not TOML (parsing value: could not determine value type)"}));

TEST(TomlScene, AllMistakesAreToldAtOnceInTheOrderOfTheFile)
{
  std::string const text = R"([box]
widht = 500
height = 5
x = "open"

[discs.generate]
count = 2.5
temperature = -1

[contact]
restitution = 1.2

[run]
engine = "swep"
dt = 0.1
dt = 0.2
duration = "long"
)";
  std::string const problems = problems_of(text);
  std::string at;
  for (std::size_t start = 0; start < problems.size(); start = problems.find('\n', start) + 1) {
    at += problems.substr(start, problems.find(": ", start) - start) + " ";
    if (problems.find('\n', start) == std::string::npos)
      break;
  }
  EXPECT_EQ(at, "s.toml:2:1 s.toml:3:10 s.toml:4:5 s.toml:7:9 s.toml:8:15 s.toml:11:15 "
                "s.toml:14:10 s.toml:16:6 s.toml:17:12 ")
      << problems;
}

TEST(TomlScene, ProblemsOfItsStatesAreToldToo)
{
  Folder const folder;
  folder.write("s.csv", "0,0,x,1\n");
  try {
    read_scene(
        {folder.write("s.toml", "[discs]\nstates = \"s.csv\"\n[run]\nengine = 1\n"), "", {}});
    FAIL();
  } catch (BadScene const& problems) {
    std::string const text = problems.what();
    EXPECT_NE(text.find("s.toml:4:10: run.engine: "), std::string::npos) << text;
    EXPECT_NE(text.find("s.csv:1:5: vx: "), std::string::npos) << text;
  }
}

} // namespace
} // namespace ricochet::driver
