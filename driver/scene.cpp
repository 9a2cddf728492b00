#include "scene.hpp"

#include "config.hpp"
#include "exit_codes.hpp"
#include "generate.hpp"
#include "overlaps.hpp"
#include "scene_toml.hpp"
#include "states_csv.hpp"
#include "states_h5md.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

namespace ricochet::driver {

namespace {

// What is missing that has no default.
void check_completeness(Settings const& settings, Purpose purpose, ProblemList& problems)
{
  if (settings.is_partial)
    return; // it may be there, misspelt
  if (!settings.states && !settings.count && !settings.packing && !any_wrong(settings, {"discs."}))
    problems.add(settings.scene, {},
                 "found no discs (discs.states names a file of them; discs.generate.count or "
                 "packing_fraction makes them)",
                 "add count = 100 below [discs.generate]");
  if (purpose != Purpose::states && !settings.engine && !any_wrong(settings, {"run.engine"})) {
    std::vector<std::string> names;
    for (EngineKind const kind : engine_kinds())
      names.emplace_back(name(kind));
    problems.add(settings.scene, {},
                 fmt::format("found no run.engine (allowed: {})", joined(names)),
                 "add engine = \"sweep\" below [run]");
  }
}

// Steps of `dt` that make up the time that `key` names.
std::int64_t steps_in(Settings const& settings, std::string const& key, double time, double dt,
                      ProblemList& problems)
{
  if (auto const steps = whole_steps(time, dt))
    return *steps;
  std::string const of_dt = settings.dt ? "run.dt" : "run.steps_per_time";
  // The latest word on the matter is that of the command line.
  bool const dt_is_option = settings.origins.count(of_dt) > 0 && !blame(settings, of_dt).place;
  Origin at = dt_is_option ? blame(settings, of_dt) : blame(settings, key, {of_dt});
  at.name = "";
  double const ratio = time / dt;
  std::string const what = fmt::format("{} {}", shown_name(settings, key), shortest(time));
  if (!(ratio < static_cast<double>(most_steps))) {
    problems.add(at, fmt::format("{} is {} steps of {}, more than can be counted", what,
                                 shortest(ratio), shortest(dt)));
    return 0;
  }
  double const nearest = std::max(1.0, std::round(ratio));
  problems.add(at,
               fmt::format("{} is not a whole number of steps (dt = {} gives {:.10g})", what,
                           shortest(dt), ratio),
               fmt::format("dt = {} makes it {:.0f}", shortest(time / nearest), nearest));
  return 0;
}

// Steps and frames.
void set_times(Scene& scene, ProblemList& problems)
{
  Settings const& s = scene.settings;
  if (any_wrong(s, {"run.", "output.every"}))
    return;
  std::size_t const before = problems.count();
  double const dt = s.dt ? *s.dt : 1 / *s.steps_per_time;
  scene.method.dt = dt;
  scene.steps = s.steps ? *s.steps : steps_in(s, "run.duration", *s.duration, dt, problems);
  scene.every =
      s.every_time ? steps_in(s, "output.every_time", *s.every_time, dt, problems) : *s.every;
  scene.measure_from = steps_in(s, "run.measure_from", *s.measure_from, dt, problems);
  if (problems.count() > before)
    return;
  if (scene.every < 1)
    problems.add(blame(s, "output.every_time"),
                 fmt::format("found {}, which is shorter than a step (dt = {})",
                             shortest(*s.every_time), shortest(dt)));
  if (scene.measure_from > scene.steps)
    problems.add(
        blame(s, "run.measure_from"),
        fmt::format("found {}, which is after the end of the run (it takes {} steps of {})",
                    shortest(*s.measure_from), scene.steps, shortest(dt)));
}

// Whether the discs can come to rest at all.
void check_rest(Scene const& scene, ProblemList& problems)
{
  Settings const& s = scene.settings;
  if (*s.until != Until::rest)
    return;
  auto const refuse = [&](std::string const& key, std::string const& why) {
    problems.add(blame(s, "run.until", {key}),
                 fmt::format("found \"rest\", but discs never rest {}", why), "leave it out");
  };
  if (scene.model.gravity == 0)
    refuse("forces.gravity", "without gravity");
  else if (scene.method.engine == EngineKind::events && scene.model.contact.pairs)
    refuse("run.engine", "under engine events, which stops where contacts last");
}

void relax_discs(Scene& scene, ProblemList& problems)
{
  double const diameter = 2 * scene.model.radius;
  double const packing = packing_fraction(scene.model, scene.discs.size());
  if (packing > densest_packing)
    return problems.add(blame(scene.settings, "discs.relax"),
                        fmt::format("the discs cover {:.4g} of the box (without overlaps at most "
                                    "{} is possible)",
                                    packing, densest_packing),
                        "make the box larger");
  Relaxation const done = relax(scene.model, scene.discs);
  if (done.left.pairs > 0)
    problems.add(blame(scene.settings, "discs.relax"),
                 fmt::format("{} pairs of discs still overlap, by up to {:.2g} diameters, after {} "
                             "passes (the discs cover {:.4g} of the box)",
                             done.left.pairs, done.left.deepest / diameter, done.passes, packing));
  scene.notes.push_back(
      done.moved == 0
          ? "relax: no disc overlapped anything"
          : fmt::format("relax: moved {} of {} discs in {} passes; disc {} the farthest, by {:.4g} "
                        "({:.2g} diameters)",
                        done.moved, scene.discs.size(), done.passes, done.disc, done.farthest,
                        done.farthest / diameter));
}

} // namespace

Settings read_settings(SceneOptions const& options, ProblemList& problems)
{
  Settings settings;
  if (is_toml(options.file)) {
    settings = read_scene_toml(options.file, problems);
  } else {
    if (!options.config.empty())
      settings = read_config(options.config, problems);
    settings.states = options.file;
    settings.engine = EngineKind::sweep; // the original's
    if (settings.scene.empty())
      settings.scene = options.file;
  }
  apply(options.overrides, settings, problems);
  if (settings.count || settings.packing) {
    settings.temperature = settings.temperature.value_or(0);
    settings.zero_momentum = settings.zero_momentum.value_or(false);
    settings.arrangement = settings.arrangement.value_or(Arrangement::random);
    settings.seed = settings.seed.value_or(1);
  }
  return settings;
}

std::string identity(Settings settings, std::uint64_t initial_state_hash)
{
  settings.states.reset();
  settings.file.reset();
  settings.checkpoint.reset();
  settings.every_seconds.reset();
  return fmt::format("{}\n[discs.initial]\nstate_hash = \"{:016x}\"\n", as_toml(settings),
                     initial_state_hash);
}

Model model_of(Settings const& settings)
{
  Model model;
  model.box = {*settings.width, *settings.height, *settings.x, *settings.y};
  model.radius = *settings.radius;
  model.gravity = *settings.gravity;
  model.contact = {*settings.law, *settings.restitution, *settings.friction, *settings.pairs};
  return model;
}

void check_model(Settings const& settings, Model const& model, ProblemList& problems)
{
  for (Problem const& problem : ricochet::problems(model)) {
    if (any_wrong(settings, {problem.quantity, "discs.radius"}))
      continue; // the value is a default, and was not asked for
    bool const of_box = problem.quantity == "box.width" || problem.quantity == "box.height";
    Origin const at =
        blame(settings, problem.quantity, {of_box ? "discs.radius" : "box.y", "discs.radius"});
    bool const by_default = settings.origins.count(problem.quantity) == 0;
    bool const of_config = settings.names.count("box.width") > 0;
    problems.add(
        at, fmt::format("{}found {}{} (allowed: {}{})",
                        by_default ? shown_name(settings, problem.quantity) + ": " : "",
                        by_default || at.found.empty() ? problem.found : at.found,
                        by_default ? " by default" : "", problem.allowed,
                        of_box && of_config ? "; the walls stand at the integer half of it" : ""));
  }
}

bool is_toml(std::string const& file)
{
  return std::filesystem::path(file).extension() == ".toml";
}

std::optional<std::int64_t> whole_steps(double time, double dt)
{
  double const ratio = time / dt;
  double const whole = std::round(ratio);
  // dt, the division and a `time` that was a product each round once.
  if (!(whole < static_cast<double>(most_steps)) ||
      std::abs(ratio - whole) > 4 * std::numeric_limits<double>::epsilon() * whole)
    return std::nullopt;
  return static_cast<std::int64_t>(whole);
}

Scene read_scene(SceneOptions const& options, Purpose purpose)
{
  ProblemList problems;
  Scene scene;
  scene.settings = read_settings(options, problems);
  Settings const& settings = scene.settings;
  check_completeness(settings, purpose, problems);
  scene.model = model_of(settings);
  scene.method.engine = settings.engine.value_or(EngineKind::sweep);
  scene.method.precision = *settings.precision;
  check_model(settings, scene.model, problems);
  set_times(scene, problems);
  check_rest(scene, problems);
  if (purpose == Purpose::settings) {
    problems.throw_if_any();
    return scene;
  }

  bool const model_is_good =
      ricochet::problems(scene.model).empty() && !any_wrong(settings, {"box.", "discs."});
  if (settings.states && is_trajectory(*settings.states))
    scene.discs = read_frame(*settings.states, blame(settings, "discs.states"), problems);
  else if (settings.states)
    scene.discs = read_states(*settings.states,
                              model_is_good ? std::optional(scene.model) : std::nullopt, problems);
  else if ((settings.count || settings.packing) && model_is_good)
    scene.discs = generate_discs(settings, scene.model, problems);
  problems.throw_if_any();

  if (*settings.relax)
    relax_discs(scene, problems);
  problems.throw_if_any();
  return scene;
}

} // namespace ricochet::driver
