#include "jobs.hpp"

#include "checkpoint_file.hpp"
#include "trajectory_reader.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <thread>

namespace ricochet::test {

bool contains(std::string const& text, std::string const& part)
{
  return text.find(part) != std::string::npos;
}

Arguments all_of(std::string const& json, std::string const& key)
{
  std::string const mark = "\"" + key + "\": ";
  Arguments values;
  for (std::size_t at = json.find(mark); at != std::string::npos; at = json.find(mark, at)) {
    at += mark.size();
    values.push_back(json.substr(at, json.find_first_of(",\n", at) - at));
  }
  return values;
}

Arguments operator+(Arguments a, Arguments const& b)
{
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

std::string write_gas(Folder const& folder)
{
  std::string const scene = fmt::format(R"(
[discs.generate]
count = 12000
temperature = 400

[box]
width = 1600
height = 1600
y = "periodic"

[forces]
gravity = 0

[run]
engine = "sweep"
steps = {}
dt = 0.0078125
measure_from = 0.5

[output]
every = {}
)",
                                        gas_steps, gas_every);
  return folder.write("gas.toml", scene);
}

Arguments Job::run() const
{
  return Arguments{"run"} + scene +
         Arguments{"-o", trajectory(), "--final", states(), "--json", json()};
}

Arguments Job::resume() const
{
  return run() + Arguments{"--resume", "auto", "--checkpoint-every", "0.01"};
}

std::int64_t Job::step() const
{
  try {
    return driver::read_checkpoint(checkpoint()).step();
  } catch (driver::Failure const&) {
    return -1;
  }
}

::testing::AssertionResult eventually(Process& process, std::function<bool()> const& condition)
{
  for (int tries = 0; tries < 12000; ++tries) {
    if (condition())
      return ::testing::AssertionSuccess();
    if (!process.is_running())
      return ::testing::AssertionFailure() << "ended: " << process.wait().err;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return ::testing::AssertionFailure() << "nothing happened";
}

namespace {

// A summary without what depends on the machine's mood and on the number of threads.
std::string facts(std::string const& json)
{
  std::string kept;
  for (std::size_t start = 0; start < json.size();) {
    std::size_t const end = json.find('\n', start) + 1;
    std::string const line = json.substr(start, end - start);
    bool const is_mood = contains(line, "_seconds\"") || contains(line, "_per_second\"") ||
                         contains(line, "\"backend\"") || contains(line, "\"threads\"");
    kept += is_mood ? "" : line;
    start = end;
  }
  return kept;
}

} // namespace

void expect_equal_trajectories(Job const& a, Job const& b)
{
  Outcome const comparison = ricochet({"compare", a.trajectory(), b.trajectory()});
  EXPECT_EQ(comparison.code, 0) << comparison.out << comparison.err;
  driver::TrajectoryReader const one(a.trajectory()), other(b.trajectory());
  EXPECT_EQ(one.steps(), other.steps());
  EXPECT_EQ(one.times(), other.times());
  for (char const* name :
       {"kinetic", "potential", "lost_pairs", "lost_walls", "numerical", "residual", "temperature",
        "max_overlap", "max_outside", "collisions", "separating_hits", "wall_hits"})
    EXPECT_EQ(one.observable(name), other.observable(name)) << name;
  auto const pressure = one.observable("pressure_z"),
             other_pressure = other.observable("pressure_z");
  ASSERT_EQ(pressure.size(), other_pressure.size());
  for (std::size_t i = 0; i < pressure.size(); ++i) // not a number before it is measured
    EXPECT_TRUE(pressure[i] == other_pressure[i] ||
                (std::isnan(pressure[i]) && std::isnan(other_pressure[i])));
}

void expect_equal_results(Job const& a, Job const& b)
{
  EXPECT_EQ(text_of(a.states()), text_of(b.states()));
  EXPECT_EQ(facts(text_of(a.json())), facts(text_of(b.json())));
  expect_equal_trajectories(a, b);
}

} // namespace ricochet::test
