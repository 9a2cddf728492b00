#include "scene.hpp"

#include "exit_codes.hpp"
#include "states_csv.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace ricochet::driver {

namespace {

constexpr double most_steps = 9007199254740992; // 2^53

std::int64_t steps_or_fail(std::string const& quantity, double time, double dt)
{
  if (auto const steps = whole_steps(time, dt))
    return *steps;
  double const ratio = time / dt;
  if (!(ratio < most_steps))
    throw Failure(Exit::usage,
                  fmt::format("{} {} is {} steps of {}, more than can be counted", quantity,
                              shortest(time), shortest(ratio), shortest(dt)));
  double const nearest = std::max(1.0, std::round(ratio));
  throw Failure(
      Exit::usage,
      fmt::format("{} {} is not a whole number of steps: dt = {} gives {:.10g} (allowed: a "
                  "multiple of dt) --dt {} makes it {:.0f}",
                  quantity, shortest(time), shortest(dt), ratio, shortest(time / nearest),
                  nearest));
}

} // namespace

std::optional<std::int64_t> whole_steps(double time, double dt)
{
  double const ratio = time / dt;
  double const whole = std::round(ratio);
  // dt, the division and a `time` that was a product each round once.
  if (!(whole < most_steps) ||
      std::abs(ratio - whole) > 4 * std::numeric_limits<double>::epsilon() * whole)
    return std::nullopt;
  return static_cast<std::int64_t>(whole);
}

Scene read_scene(RunOptions const& options)
{
  ProblemList problems;
  Scene scene;
  if (!options.config.empty())
    scene.config = read_config(options.config, problems);
  bool const config_is_good = problems.empty();

  scene.model = model_of(scene.config);
  scene.model.contact.law = options.law;
  if (config_is_good)
    check_model(scene.config, scene.model, problems);
  std::optional<Model> checked;
  if (problems.empty())
    checked = scene.model;
  scene.discs = read_states(options.states, checked, problems);
  problems.throw_if_any();

  scene.method.engine = options.engine;
  scene.method.precision = options.precision;
  scene.method.dt = options.dt.value_or(1 / static_cast<double>(scene.config.steps_per_time));
  double const dt = scene.method.dt;
  if (options.steps)
    scene.steps = *options.steps;
  else
    scene.steps = steps_or_fail(
        "duration", options.duration.value_or(static_cast<double>(scene.config.duration)), dt);
  if (options.every_time)
    scene.every = steps_or_fail("--every-time", *options.every_time, dt);
  else
    scene.every = options.every.value_or(1);
  if (scene.every < 1)
    throw Failure(Exit::usage, "--every-time is shorter than a step");
  return scene;
}

} // namespace ricochet::driver
