// A scene as it will be run: the files and the options that override them, checked as a whole.
#pragma once

#include "settings.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// What a command line says about a scene.
struct SceneOptions {
  std::string file;                ///< SCENE.toml or STATES.csv
  std::string config;              ///< CONFIG.csv of the latter; empty: all defaults
  std::vector<Override> overrides; ///< in the order given
};

struct Scene {
  Settings settings; ///< all that the scene says, with defaults and options
  Model model;
  Method method;
  std::int64_t steps = 0;
  std::int64_t every = 1;         ///< steps from frame to frame
  std::int64_t measure_from = 0;  ///< step at which the measurement of pressure begins
  std::vector<DiscState> discs;   ///< perhaps still to be melted, see melt.hpp
  std::vector<std::string> notes; ///< what was done to the discs that was asked for
};

/// What a scene is read for: its initial states alone, to be run, or to know whether it could be,
/// as far as that can be told without its discs.
enum class Purpose { states, run, settings };

/// What the files and options of a scene say, with defaults. What is wrong goes to `problems`.
Settings read_settings(SceneOptions const& options, ProblemList& problems);

/// Reads the scene. Throws Failure with everything that is wrong with it.
Scene read_scene(SceneOptions const& options, Purpose purpose = Purpose::run);

/// What the results of a run depend on, in words: the settings without the names of files, and what
/// the discs are at the start. Runs of which it is equal have equal results.
std::string identity(Settings settings, std::uint64_t initial_state_hash);

/// The model that `settings` describe.
Model model_of(Settings const& settings);

/// Tells which of `settings` make `model` impossible to simulate.
void check_model(Settings const& settings, Model const& model, ProblemList& problems);

/// True if `file` is a scene in TOML, by its name.
bool is_toml(std::string const& file);

/// How many steps of `dt` make up `time`; nothing if that is not a whole number, apart from
/// rounding.
std::optional<std::int64_t> whole_steps(double time, double dt);

} // namespace ricochet::driver
