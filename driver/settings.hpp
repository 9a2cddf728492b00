// The settings of a scene: what it may say, whichever file or option says it.
#pragma once

#include "problem_list.hpp"

#include "ricochet/engine.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

namespace ricochet::driver {

/// Most steps that a double still counts.
constexpr std::int64_t most_steps = std::int64_t{1} << 53;

enum class Compression { automatic, none, deflate };

/// How generated discs are placed.
enum class Arrangement {
  random, ///< anywhere, one after the other, without overlap
  square,
  triangular
};

/// What ends a run.
enum class Until {
  duration, ///< its last step
  rest      ///< that too, or that its discs rest, see rest.hpp
};

/// The settings of a scene with their defaults, those of the original. What is empty is not set.
///
/// The table of keys in settings.cpp is the one list of their names and of what they may be.
struct Settings {
  std::optional<double> width = 740, height = 740;
  std::optional<Boundary> x = Boundary::walls, y = Boundary::walls;

  std::optional<double> radius = 3;
  std::optional<bool> relax = false; ///< separate overlapping discs first
  std::optional<std::string> states; ///< a STATES.csv
  std::optional<std::int64_t> count; ///< of generated discs; or
  std::optional<double> packing;     ///< the share of the box that they cover
  std::optional<double> temperature; ///< sum of |v|^2 / 2N
  std::optional<bool> zero_momentum; ///< whether their total momentum vanishes
  std::optional<Arrangement> arrangement;
  std::optional<std::int64_t> seed;

  std::optional<double> gravity = 9.81;
  std::optional<double> restitution = 0.93, friction = 0.93;
  std::optional<Law> law = Law::swap_scale;
  std::optional<bool> pairs = true; ///< whether discs meet each other

  std::optional<double> duration = 60;
  std::optional<std::int64_t> steps; ///< instead of a duration
  std::optional<Until> until = Until::duration;
  std::optional<double> steps_per_time = 45;
  std::optional<double> dt; ///< instead of steps per time
  std::optional<EngineKind> engine;
  std::optional<Precision> precision = Precision::double_;
  std::optional<double> measure_from = 0; ///< time at which the measurement of pressure begins

  std::optional<std::string> file; ///< of the trajectory
  std::optional<std::int64_t> every = 1;
  std::optional<double> every_time; ///< instead of every
  std::optional<bool> velocity = true;
  std::optional<bool> float32 = false;
  std::optional<Compression> compression = Compression::automatic;

  std::optional<std::string> checkpoint; ///< the file
  std::optional<double> every_seconds;   ///< from one to the next; 900 if this is not set

  std::string scene;                        ///< the file that says all this, or most of it
  std::map<std::string, Origin> origins;    ///< where the keys stand that do not have their default
  std::map<std::string, std::string> names; ///< of keys, where that file has others for them
  std::set<std::string> wrong;              ///< keys whose value was refused
  bool is_partial = false;                  ///< something in the scene could not be understood
};

/// A word of a command line or a CONFIG.csv, which means what the setting wants it to.
struct Word {
  std::string text;
};

/// Something that no setting can be, such as a date, in words.
struct Misfit {
  std::string what;
};

/// A value on its way to a setting.
using Value =
    std::variant<Word, bool, std::int64_t, double, std::string, std::vector<std::string>, Misfit>;

/// Names of all keys, such as "run.dt".
std::vector<std::string> const& setting_keys();

/// Names of the tables that keys are in, such as "discs.generate".
std::vector<std::string> const& setting_sections();

/// Sets `key`, which stands at `origin`. A key of the command line replaces one of a file, and what
/// that file says instead of it. What is wrong goes to `problems`.
void assign(Settings& settings, std::string const& key, Value const& value, Origin origin,
            ProblemList& problems);

/// Reports that there is no `key`.
void report_unknown_key(std::string const& key, Origin const& origin, ProblemList& problems);

/// True if a refused value, of a key that begins with one of these, makes checking the rest idle.
bool any_wrong(Settings const& settings, std::vector<std::string> const& beginnings);

/// The settings as a scene in TOML, defaults included: reading it gives the same settings.
std::string as_toml(Settings settings);

/// A setting that an option of the command line makes.
struct Override {
  std::string option; ///< as it was given, such as "--dt"
  std::string key;
  std::string value;
};

/// Applies what a command line says, after all files.
void apply(std::vector<Override> const& overrides, Settings& settings, ProblemList& problems);

/// `key` as the scene calls it that the settings came from.
std::string shown_name(Settings const& settings, std::string const& key);

/// Where to tell of what is wrong with `key`: where it stands or, if it has its default, where the
/// first of `causes` stands that is set, or the beginning of the scene.
Origin blame(Settings const& settings, std::string const& key,
             std::vector<std::string> const& causes = {});

} // namespace ricochet::driver
