// Runs that end when their discs rest.
#include "info.hpp"
#include "jobs.hpp"
#include "rest.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>

namespace ricochet::test {
namespace {

using driver::RestWatch;

driver::Scene fine_scene()
{
  driver::Scene scene;
  scene.model.gravity = 9.81;
  scene.model.radius = 3;
  scene.method.dt = 1e-4;
  return scene;
}

// Whether a disc of the given velocity in the course of time is said to be at rest within `looks`.
template <class Velocity>
bool rests(Velocity const& velocity, int looks)
{
  auto const scene = fine_scene();
  RestWatch watch(scene);
  std::int64_t step = 0;
  for (int k = 0; k < looks; ++k) {
    step = watch.next_look(step);
    watch.look({{0, 0, 0, 0}, {0, 0, 0, velocity(static_cast<double>(step) * scene.method.dt)}});
    if (watch.is_at_rest())
      return true;
  }
  return false;
}

TEST(Rest, ADiscInFlightIsNeverAtRest)
{
  double const g = fine_scene().model.gravity;
  for (double upwards = -30; upwards <= 30; upwards += 0.01)
    ASSERT_FALSE(rests([&](double t) { return upwards - g * t; }, 20)) << upwards;
}

// Elastic bounces, of any height above r/25 and begun at any time.
TEST(Rest, ADiscThatBouncesIsNeverAtRest)
{
  auto const scene = fine_scene();
  double const g = scene.model.gravity;
  for (double height = scene.model.radius / 25; height < 20; height *= 1.01)
    for (double begun = 0; begun < 1; begun += 0.1) {
      double const speed = std::sqrt(2 * g * height), period = 2 * speed / g;
      ASSERT_FALSE(rests(
          [&](double t) {
            double const since = t + begun * period;
            return speed - g * (since - std::floor(since / period) * period);
          },
          40))
          << height << " " << begun;
    }
}

TEST(Rest, DiscsThatTrembleAreAtRestAtTheSixthLook)
{
  auto const tremble = [](double t) { return 0.7 * std::sin(1000 * t); };
  EXPECT_FALSE(rests(tremble, 5));
  EXPECT_TRUE(rests(tremble, 6));
}

Arguments at_rest(Job const& job)
{
  return all_of(text_of(job.json()), "at_rest");
}

TEST(Rest, ARunUntilThenIsTheRunOfAsManySteps)
{
  for (std::string const engine : {"sweep", "toi"}) {
    Folder const folder;
    Arguments const seven{scene("seven_discs.toml"), "--engine", engine, "--every", "7", "-q"};
    Job const until_rest{folder, "rest", seven + Arguments{"--until", "rest", "--duration", "500"}};
    ASSERT_EQ(ricochet(until_rest.run()).code, 0);
    EXPECT_EQ(at_rest(until_rest), Arguments{"true"});
    auto const info = driver::describe(until_rest.trajectory());
    EXPECT_TRUE(is_complete(info));
    ASSERT_TRUE(info.last_step);
    EXPECT_LT(*info.last_step, 500 * 45);

    Job const counted{folder, "counted",
                      seven + Arguments{"--steps", std::to_string(*info.last_step)}};
    ASSERT_EQ(ricochet(counted.run()).code, 0);
    EXPECT_EQ(at_rest(counted), Arguments{"null"});
    EXPECT_EQ(text_of(until_rest.states()), text_of(counted.states()));
    expect_equal_trajectories(until_rest, counted);
  }
}

TEST(Rest, ARunThatDoesNotComeToItEndsAfterItsTime)
{
  Folder const folder;
  Job const job{folder, "t", {scene("seven_discs.toml"), "--until", "rest", "--duration", "2"}};
  Outcome const outcome = ricochet(job.run());
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(at_rest(job), Arguments{"false"});
  EXPECT_EQ(driver::describe(job.trajectory()).last_step, 90);
}

// Discs lie on the floor, and rest at the sixth look; the run is stopped after the first.
TEST(Rest, ARunThatWasStoppedInBetweenEndsAtTheSameStep)
{
  Folder const folder;
  constexpr int discs = 2000;
  constexpr std::int64_t look = 2000; // sqrt(r/g)/2/dt
  std::string states;
  for (int i = 0; i < discs; ++i)
    states += fmt::format("{},-49.5,0,0\n", 1.25 * i - 0.625 * discs + 0.6);
  folder.write("floor.csv", states);
  std::string const file = folder.write("floor.toml", R"([box]
width = 2500
height = 100
[discs]
radius = 0.5
states = "floor.csv"
[forces]
gravity = 8
[run]
engine = "sweep"
duration = 10
dt = 0.0000625
until = "rest"
[output]
every = 1000
)");
  Job const whole{folder, "whole", {file, "-q"}}, parts{folder, "parts", {file, "-q"}};
  ASSERT_EQ(ricochet(whole.run()).code, 0);
  EXPECT_EQ(driver::describe(whole.trajectory()).last_step, 6 * look);

  Process run(parts.resume());
  ASSERT_TRUE(eventually(run, [&] { return parts.step() >= look; }));
  run.send(SIGTERM);
  ASSERT_EQ(run.wait().code, 75);
  EXPECT_LT(parts.step(), 6 * look);
  ASSERT_EQ(ricochet(parts.resume()).code, 0);
  expect_equal_results(parts, whole);
}

} // namespace
} // namespace ricochet::test
