// The command line: what it may say and what it says.
#pragma once

#include "kokkos_startup.hpp"
#include "log.hpp"
#include "pictures/look.hpp"
#include "scene.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace ricochet::driver {

/// Whether a run is shown in a window: as fast as it goes, or as the original's animation.
enum class Watching { no, window, animation };

/// ricochet run SCENE
struct RunOptions {
  SceneOptions scene;
  std::string final_file; ///< final states; empty: none, "-": standard output
  std::string json;       ///< summary; likewise
  std::string resume;     ///< empty: begin; "auto": go on if possible; else a checkpoint's file
  std::optional<double> walltime; ///< most seconds from the start of the program
  LogFormat log_format = LogFormat::text;
  bool dry_run = false;
  bool print_scene = false;
  bool force = false;
  Watching watching = Watching::no;
  KokkosOptions kokkos;     ///< with --quiet and --threads
  std::string command_line; ///< as it was given, in a form that a shell takes back
  int at_once = 1;          ///< runs that take turns at writing files
};

/// ricochet ensemble SCENE
struct EnsembleOptions {
  RunOptions run; ///< of each member; where it names files, members' have a number besides
  std::optional<std::int64_t> members;
  std::vector<Override> vary; ///< what variations() understands
  std::string csv;            ///< a table of the members; empty: none, "-": standard output
  std::string json;           ///< likewise
};

/// ricochet generate SCENE
struct GenerateOptions {
  SceneOptions scene;
  std::string output = "-"; ///< states; "-": standard output
  std::string config;       ///< CONFIG.csv; empty: none
  bool force = false;
};

/// ricochet validate SCENE
struct ValidateOptions {
  SceneOptions scene;
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

/// ricochet render INPUT
struct RenderOptions {
  SceneOptions scene; ///< its file may be a trajectory
  std::string output; ///< OUT.png, OUT.mp4 or OUT.gif; empty: none
  bool window = false;
  std::string html; ///< a page for browsers; empty: none
  Look look;
  std::optional<std::int64_t> frame; ///< this one alone; -1: the last
  std::int64_t every = 1;            ///< of the stored frames, every so many is shown
  std::optional<double> rate;        ///< time units a second, instead
  double fps = 30;                   ///< pictures of a movie a second
  bool force = false;
  KokkosOptions kokkos;
};

/// ricochet plot FILE
struct PlotOptions {
  std::string file;
  std::string output; ///< OUT.png or OUT.svg; empty: none
  std::string csv;    ///< names the tables: OUT_time.csv and others for OUT.csv; empty: none
  bool force = false;
};

/// --kokkos-help
struct KokkosHelp {};

/// Text for standard output that answers the command line: --help, --version.
struct Answer {
  std::string text;
};

using Command =
    std::variant<RunOptions, GenerateOptions, ValidateOptions, InfoOptions, CompareOptions,
                 RenderOptions, PlotOptions, EnsembleOptions, KokkosHelp, Answer>;

/// Understands the arguments after the name of the program. Throws Failure(Exit::usage).
Command parse_command_line(std::vector<std::string> const& arguments);

} // namespace ricochet::driver
