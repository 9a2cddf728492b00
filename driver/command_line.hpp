// The command line: what it may say and what it says.
#pragma once

#include "kokkos_startup.hpp"

#include "ricochet/engine.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace ricochet::driver {

enum class Compression { automatic, none, deflate };

/// ricochet run STATES.csv [CONFIG.csv]
struct RunOptions {
  std::string states;
  std::string config; ///< empty: all defaults

  std::string output;     ///< trajectory; empty: none
  std::string final_file; ///< final states; empty: none, "-": standard output
  std::string json;       ///< summary; likewise
  std::optional<std::int64_t> every;
  std::optional<double> every_time;
  bool velocity = true;
  bool float32 = false;
  Compression compression = Compression::automatic;

  EngineKind engine = EngineKind::sweep;
  Precision precision = Precision::double_;
  Law law = Law::swap_scale;
  std::optional<double> dt;
  std::optional<double> duration;
  std::optional<std::int64_t> steps;

  bool force = false;
  KokkosOptions kokkos;     ///< with --quiet and --threads
  std::string command_line; ///< as it was given, in a form that a shell takes back
};

/// ricochet info FILE
struct InfoOptions {
  std::string file;
  std::string json; ///< empty: none, "-": standard output
  bool force = false;
};

/// ricochet compare A B
struct CompareOptions {
  std::string a, b;
  double tolerance = 0;
};

/// --kokkos-help
struct KokkosHelp {};

/// Text for standard output that answers the command line: --help, --version.
struct Answer {
  std::string text;
};

using Command = std::variant<RunOptions, InfoOptions, CompareOptions, KokkosHelp, Answer>;

/// Understands the arguments after the name of the program. Throws Failure(Exit::usage).
Command parse_command_line(std::vector<std::string> const& arguments);

} // namespace ricochet::driver
