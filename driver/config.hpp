// CONFIG.csv: the parameters of a scene in the original's form, one line of key=value,key=value.
#pragma once

#include "problem_list.hpp"

#include "ricochet/model.hpp"

#include <cstdint>
#include <map>
#include <string>

namespace ricochet::driver {

/// The content of a CONFIG.csv; what the file does not name keeps its default.
struct Config {
  double gravity = 9.81;
  double alpha = 0.93;
  double beta = 0.93;
  std::int64_t width = 740;
  std::int64_t height = 740;
  std::int64_t radius = 3;
  std::int64_t steps_per_time = 45; ///< key fps
  std::int64_t duration = 60;       ///< key totTime

  /// A value as it stands in the file.
  struct Entry {
    Place place; ///< of the key
    std::string value;
  };
  std::string path;                     ///< empty without a file
  std::string text;                     ///< the file, verbatim
  std::map<std::string, Entry> entries; ///< by key
};

/// Reads `text`, which came from `path`; what is wrong goes to `problems`.
Config parse_config(std::string const& path, std::string const& text, ProblemList& problems);

/// Reads the file `path`. Throws Failure if it cannot be read.
Config read_config(std::string const& path, ProblemList& problems);

/// The model that `config` describes. Walls stand at the integers +-(width div 2) and
/// +-(height div 2), as in the original.
Model model_of(Config const& config);

/// Tells which entries of `config` make `model` impossible to simulate.
void check_model(Config const& config, Model const& model, ProblemList& problems);

} // namespace ricochet::driver
