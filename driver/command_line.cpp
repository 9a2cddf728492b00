#include "command_line.hpp"

#include "exit_codes.hpp"
#include "pictures/movie.hpp"
#include "provenance.hpp"
#include "settings.hpp"
#include "stop_request.hpp"
#include "text.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <sstream>

namespace ricochet::driver {

namespace {

std::vector<std::string> const commands{"run",  "ensemble", "generate", "validate",
                                        "info", "compare",  "render",   "plot"};

[[noreturn]] void wrong(std::string const& message)
{
  throw Failure(Exit::usage, message);
}

double decimal(std::string const& option, std::string const& word, bool zero_allowed)
{
  double value = 0;
  NumberError const error = parse_decimal(word, value);
  std::string const allowed = zero_allowed ? "a decimal number >= 0" : "a decimal number > 0";
  if (error != NumberError::none)
    wrong(fmt::format("{}: found {}, which {} (allowed: {})", option, in_quotes(word),
                      explain(error), allowed));
  if (value < 0 || (value == 0 && !zero_allowed))
    wrong(fmt::format("{}: found {} (allowed: {})", option, word, allowed));
  return value;
}

std::int64_t integer(std::string const& option, std::string const& word, std::int64_t least,
                     std::int64_t most)
{
  std::int64_t value = 0;
  NumberError const error = parse_integer(word, value);
  if (error != NumberError::none)
    wrong(fmt::format("{}: found {}, which {} (allowed: an integer in {}...{})", option,
                      in_quotes(word), explain(error), least, most));
  if (value < least || value > most)
    wrong(fmt::format("{}: found {} (allowed: an integer in {}...{})", option, word, least, most));
  return value;
}

// One of the words `allowed`.
std::string choice(std::string const& option, std::string const& word,
                   std::vector<std::string> const& allowed)
{
  if (std::find(allowed.begin(), allowed.end(), word) == allowed.end()) {
    std::string const hint = did_you_mean(word, allowed);
    wrong(fmt::format("{}: found {} (allowed: {}){}{}", option, in_quotes(word), joined(allowed),
                      hint.empty() ? "" : " ", hint));
  }
  return word;
}

// section.key=value
Override key_and_value(std::string const& option, std::string const& word)
{
  std::size_t const equals = word.find('=');
  if (equals == std::string::npos)
    wrong(fmt::format("{}: found {} without '=' (allowed: section.key=value)", option,
                      in_quotes(word)));
  std::string const key(trimmed(word.substr(0, equals)));
  return {option + " " + key, key, std::string(trimmed(word.substr(equals + 1)))};
}

std::vector<std::string> split(std::string const& text, char separator)
{
  std::vector<std::string> parts;
  std::istringstream rest(text);
  for (std::string part; std::getline(rest, part, separator);)
    parts.push_back(part);
  return parts;
}

PictureSize picture_size(std::string const& word)
{
  auto const parts = split(word, 'x');
  if (parts.size() != 2)
    wrong(fmt::format("--size: found {} (allowed: WIDTHxHEIGHT)", in_quotes(word)));
  auto const pixels = [](std::string const& part) {
    return static_cast<int>(integer("--size", part, 16, 16384));
  };
  return {pixels(parts[0]), pixels(parts[1])};
}

Region region(std::string const& word)
{
  std::vector<double> corners;
  for (std::string const& part : split(word, ',')) {
    double corner = 0;
    if (parse_decimal(part, corner) == NumberError::none)
      corners.push_back(corner);
  }
  bool const good = corners.size() == 4 && corners[0] < corners[2] && corners[1] < corners[3];
  if (!good)
    wrong(fmt::format("--region: found {} (allowed: X0,Y0,X1,Y1 with X0 < X1 and Y0 < Y1)",
                      in_quotes(word)));
  return {corners[0], corners[1], corners[2], corners[3]};
}

// Options that override a setting of the scene, for every command that reads one.
struct SettingOption {
  char const* names;
  char const* key;
  char const* value; ///< what the help calls it
  char const* help;
};
constexpr SettingOption run_settings[] = {
    {"-o,--output", "output.file", "FILE.h5md", "Write a trajectory (H5MD)"},
    {"--from", "discs.states", "FILE.h5md[@FRAME]",
     "Start from a frame of a trajectory, counted from 0 (default its last)"},
    {"--every", "output.every", "K", "Write a frame every K steps (default 1), and the last"},
    {"--every-time", "output.every_time", "T", "Write a frame every T time units, and the last"},
    {"--fields", "output.fields", "LIST",
     "What frames hold: position or position,velocity (default)"},
    {"--compress", "output.compress", "HOW", "auto (default), none or deflate"},
    {"--engine", "run.engine", "NAME",
     "sweep, simultaneous, toi or events; scenes in CSV take sweep by themselves"},
    {"--precision", "run.precision", "NAME", "double (default) or single"},
    {"--law", "contact.law", "NAME", "Contact law: swap_scale (default) or restitution"},
    {"--dt", "run.dt", "DT", "Length of a step (default 1/45)"},
    {"--steps-per-time", "run.steps_per_time", "F", "Steps per time unit (default 45)"},
    {"--duration", "run.duration", "T", "Time to simulate (default 60)"},
    {"--steps", "run.steps", "N", "Steps to simulate, instead of a duration"},
    {"--until", "run.until", "rest", "End earlier if all discs have come to rest"},
    {"--checkpoint", "checkpoint.file", "FILE",
     "Keep a checkpoint (default with --resume auto: beside the trajectory)"},
    {"--checkpoint-every", "checkpoint.every_seconds", "SECONDS",
     "From checkpoint to checkpoint (default 900)"}};

std::string const run_examples = R"(Examples:
  ricochet run gas.toml -o gas.h5md --every-time 1     simulate, with a frame every time unit
  ricochet run gas.toml --dry-run                      what it would take; --print-scene: all settings
  ricochet run gas.toml --dt 0.01 --set discs.generate.seed=2 --json - | jq .energy
                                                       another step and other discs, a summary for programs
  ricochet run gas.toml -o gas.h5md --resume auto --max-walltime 3:55:00
                                                       in a queue: go on where the last job stopped
  ricochet run gas.csv gas.config.csv                  the original's files: final states on standard output
  ricochet gas.csv gas.config.csv                      the same, as the original is called)";

std::string const ensemble_examples = R"(Examples:
  ricochet ensemble gas.toml --members 64 --vary seed -o gas.h5md > gas.csv
                                                       gas_0000.h5md to gas_0063.h5md, and a table
  ricochet ensemble gas.toml --members 11 --vary contact.restitution=0.9..1 --json alpha.json
                                                       0.9, 0.91, ... 1; no trajectories
  ricochet ensemble gas.toml --vary run.dt=0.01,0.02,0.04 --vary output.every=400,200,100 -o dt.h5md
                                                       three members: the first values, the second, ...
  ricochet ensemble gas.toml --members 64 --vary seed -o gas.h5md --csv gas.csv --resume auto
                                                       in a queue: finish what the last job did not)";

std::string const generate_examples = R"(Examples:
  ricochet generate gas.toml -o gas.csv                            the initial states of a scene
  ricochet generate gas.toml -o gas.csv --config gas.config.csv    all that the original program reads
  ricochet generate gas.toml --set discs.generate.count=50 | head  fewer discs, on standard output
  ricochet generate crowd.toml --relax -o apart.csv                states of a file, overlaps removed)";

std::string const validate_examples = R"(Examples:
  ricochet validate gas.toml                           exit code 0, or 65 and everything that is wrong
  ricochet validate gas.csv gas.config.csv             the same for the original's files
  ricochet validate gas.toml --set run.dt=0.1          would that do?)";

std::string const info_examples = R"(Examples:
  ricochet info gas.h5md              frames, discs, times, energy, and where the file comes from
  ricochet info gas.h5md --json -     the same for other programs)";

std::string const compare_examples = R"(Examples:
  ricochet compare a.h5md b.h5md                       equal in every number of every frame?
  ricochet compare a.csv b.csv --tolerance 1e-9        final states, up to 1e-9
  ricochet compare a.h5md last.csv                     the last frame of a.h5md and last.csv)";

std::string const render_examples = R"(Examples:
  ricochet render gas.h5md -o gas.mp4                  a movie, one picture for each frame
  ricochet render gas.h5md -o gas.gif --rate 2 --size 480x360   two time units a second
  ricochet render gas.h5md -o last.png --frame -1 --colour id   a still
  ricochet render gas.h5md --html gas.html             a page to play it in a browser, and to send
  ricochet render gas.toml -o start.png --frame 0      the initial states of a scene
  ricochet render gas.h5md -o g.png --region 0,0,50,50 the pictures g_000000.png, ... of a corner)";

std::string const plot_examples = R"(Examples:
  ricochet plot gas.h5md -o gas.svg                    energy, pressure, speeds, g(r) and more
  ricochet plot gas.h5md --csv gas.csv                 their numbers: gas_time.csv, gas_pairs.csv, ...)";

class Reader {
 public:
  explicit Reader(std::vector<std::string> const& arguments);
  Command read();

 private:
  void reject_mistaken_command() const;
  void declare_scene(CLI::App* command, SceneOptions& scene);
  void declare_threads(CLI::App* command, KokkosOptions& kokkos);
  void declare_simulation(CLI::App* command, RunOptions& options);
  void declare_run();
  void declare_ensemble();
  void declare_generate();
  void declare_validate();
  void declare_info();
  void declare_compare();
  void declare_render();
  void declare_plot();
  CLI::Option* option(CLI::App* app, std::string const& names, std::string const& what,
                      std::string const& value,
                      std::function<void(std::string const&)> const& read);
  [[noreturn]] void explain_error(CLI::ParseError const& error) const;
  std::vector<std::string> option_names(CLI::App const* app) const;
  void output(CLI::App* command, std::string const& names, std::string const& what,
              std::string const& value, std::string& target);
  void check_scene(SceneOptions const& scene) const;
  Command checked_run() const;
  Command checked_ensemble();
  Command checked_render();
  Command checked_plot() const;

  CLI::App app_{"Simulates equal discs that bounce in a two-dimensional box.", "ricochet"};
  CLI::App* run_ = nullptr;
  CLI::App* ensemble_ = nullptr;
  CLI::App* generate_ = nullptr;
  CLI::App* validate_ = nullptr;
  CLI::App* info_ = nullptr;
  CLI::App* compare_ = nullptr;
  CLI::App* render_ = nullptr;
  CLI::App* plot_ = nullptr;
  std::vector<std::string> arguments_;
  RunOptions run_options_;
  EnsembleOptions ensemble_options_;
  GenerateOptions generate_options_;
  ValidateOptions validate_options_;
  InfoOptions info_options_;
  CompareOptions compare_options_;
  RenderOptions render_options_;
  PlotOptions plot_options_;
};

Reader::Reader(std::vector<std::string> const& arguments)
{
  run_options_.command_line = "ricochet";
  for (std::string const& argument : arguments) {
    run_options_.command_line += " " + for_shell(argument);
    if (argument.rfind("--kokkos-", 0) == 0)
      run_options_.kokkos.flags.push_back(argument);
    else // the original's word has one dash
      arguments_.push_back(argument == "-animate" ? "--animate" : argument);
  }
  std::vector<std::string> first{"-h", "--help", "--version"};
  first.insert(first.end(), commands.begin(), commands.end());
  // The original's call has no word for the command.
  if (!arguments_.empty() && std::find(first.begin(), first.end(), arguments_[0]) == first.end()) {
    reject_mistaken_command();
    arguments_.insert(arguments_.begin(), "run");
  }

  app_.set_help_flag("-h,--help", "Print this help and exit");
  app_.set_version_flag("--version", version_text(), "Print version, Kokkos, HDF5 and backend");
  app_.require_subcommand(1);
  app_.get_formatter()->column_width(34);
  app_.footer("`ricochet SCENE` is short for `ricochet run SCENE`.\n"
              "Options that begin with --kokkos- go to Kokkos; --kokkos-help lists them.\n"
              "`ricochet COMMAND --help` explains a command.\n\n" +
              run_examples);
  declare_run();
  declare_ensemble();
  declare_generate();
  declare_validate();
  declare_info();
  declare_compare();
  declare_render();
  declare_plot();
}

// What looks like a command is not taken for a file.
void Reader::reject_mistaken_command() const
{
  std::string const& word = arguments_[0];
  if (word.rfind('-', 0) == 0) {
    for (std::string const& argument : arguments_)
      if (std::find(commands.begin(), commands.end(), argument) != commands.end())
        wrong(fmt::format("{}: options follow the command: ricochet {} ...", word, argument));
  } else if (word.find_first_of("./") == std::string::npos) {
    std::string const hint = did_you_mean(word, commands);
    if (!hint.empty())
      wrong(fmt::format("{}: unknown command; {} (a file of that name is ./{})", word, hint, word));
  }
}

CLI::Option* Reader::option(CLI::App* app, std::string const& names, std::string const& what,
                            std::string const& value,
                            std::function<void(std::string const&)> const& read)
{
  return app->add_option_function<std::string>(names, read, what)->type_name(value);
}

// An option that names a file to write.
void Reader::output(CLI::App* command, std::string const& names, std::string const& what,
                    std::string const& value, std::string& target)
{
  auto const name = names.substr(names.find("--"));
  option(command, names, what, value, [&target, name](std::string const& word) {
    if (word.empty())
      wrong(name + ": found no file name");
    target = word;
  });
}

// The scene, and the options that override it whatever is done with it.
void Reader::declare_scene(CLI::App* command, SceneOptions& scene)
{
  command
      ->add_option("SCENE", scene.file,
                   "A scene in TOML, or STATES.csv: records x,y,vx,vy separated by white space")
      ->required()
      ->type_name("FILE");
  command
      ->add_option("CONFIG", scene.config,
                   "Parameters of STATES.csv: key=value,key=value (all have defaults)")
      ->type_name("FILE.csv");
  command
      ->add_option_function<std::vector<std::string>>(
          "--set",
          [&scene](std::vector<std::string> const& settings) {
            for (std::string const& setting : settings)
              scene.overrides.push_back(key_and_value("--set", setting));
          },
          "Override a setting of the scene; may be repeated")
      ->type_name("section.key=value")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  auto const flag = [&](char const* name, char const* key, char const* value, char const* help) {
    command->add_flag_callback(
        name,
        [&scene, name, key, value] {
          scene.overrides.push_back({name, key, value});
        },
        help);
  };
  flag("--relax", "discs.relax", "true", "Separate overlapping discs first");
  flag("--no-pairs", "contact.pairs", "false", "Discs pass through each other");
}

void Reader::declare_threads(CLI::App* command, KokkosOptions& kokkos)
{
  option(command, "--threads", "Threads of the host (default: what OpenMP gives)", "N",
         [&kokkos](std::string const& word) {
           kokkos.threads = static_cast<int>(integer("--threads", word, 1, 65536));
         });
}

// What a scene is run with, alone or as a member of an ensemble.
void Reader::declare_simulation(CLI::App* command, RunOptions& o)
{
  declare_scene(command, o.scene);
  for (SettingOption const& setting : run_settings) {
    std::string const names = setting.names, key = setting.key;
    std::string const name = names.substr(names.find("--"));
    option(command, names, setting.help, setting.value, [&o, name, key](std::string const& word) {
      o.scene.overrides.push_back({name, key, word});
    });
  }
  command->add_flag_callback(
      "--float32",
      [&o] {
        o.scene.overrides.push_back({"--float32", "output.float32", "true"});
      },
      "Store frames in single precision");
  output(command, "--final", "Write the final states as CSV; - is standard output", "FILE.csv",
         o.final_file);
  option(command, "--resume",
         "Go on from a checkpoint: from this one; auto: from the run's own, or begin", "auto|FILE",
         [&o](std::string const& word) {
           if (word.empty())
             wrong("--resume: found no file name (allowed: auto, a checkpoint)");
           o.resume = word;
         });
  option(command, "--max-walltime", "Stop with a checkpoint before this time is over", "HH:MM:SS",
         [&o](std::string const& word) {
           o.walltime = parse_duration(word);
           if (!o.walltime)
             wrong(fmt::format("--max-walltime: found {} (allowed: HH:MM:SS, D-HH:MM:SS)",
                               in_quotes(word)));
         });
  declare_threads(command, o.kokkos);
  command->add_flag("--force", o.force, "Replace files that exist");
  option(command, "--log-format", "text (default) or json: an object a line on stderr", "NAME",
         [&o](std::string const& word) {
           if (word != "text" && word != "json")
             wrong(fmt::format("--log-format: found {} (allowed: text, json)", in_quotes(word)));
           o.log_format = word == "json" ? LogFormat::json : LogFormat::text;
         });
  command->add_flag("-q,--quiet", o.kokkos.quiet,
                    "No progress and no summary; warnings and errors stay");
}

void Reader::declare_run()
{
  RunOptions& o = run_options_;
  run_ = app_.add_subcommand("run", "Simulate a scene");
  run_->footer(run_examples);
  declare_simulation(run_, o);
  output(run_, "--json", "Write a summary as JSON; - is standard output", "FILE", o.json);
  run_->add_flag_callback(
      "--window", [&o] { o.watching = Watching::window; }, "Show it in a window on the way");
  run_->add_flag_callback(
      "--animate", [&o] { o.watching = Watching::animation; },
      "The original's animation: a time unit a second; -animate is the same");
  run_->add_flag("--dry-run", o.dry_run,
                 "Write nothing; tell what the run is, and what memory, disk and time it takes");
  run_->add_flag("--print-scene", o.print_scene,
                 "Write the scene with all settings as TOML to standard output, and stop");
}

void Reader::declare_ensemble()
{
  EnsembleOptions& o = ensemble_options_;
  ensemble_ = app_.add_subcommand("ensemble", "Simulate many variants of a scene at once");
  ensemble_->footer(ensemble_examples);
  declare_simulation(ensemble_, o.run);
  option(ensemble_, "--members", "How many variants (default: as many as lists have values)", "N",
         [&o](std::string const& word) { o.members = integer("--members", word, 1, 1000000); });
  ensemble_
      ->add_option_function<std::vector<std::string>>(
          "--vary",
          [&o](std::vector<std::string> const& words) {
            for (std::string const& word : words)
              o.vary.push_back(word == "seed"
                                   ? Override{"--vary seed", "discs.generate.seed", "seed"}
                                   : key_and_value("--vary", word));
          },
          "What differs; VALUES are A..B, evenly spaced, or a list A,B,C; seed alone: seeds "
          "count up; may be repeated")
      ->type_name("section.key=VALUES|seed")
      ->expected(1)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  output(ensemble_, "--csv", "Write the table of members as CSV (default: to standard output)",
         "FILE.csv", o.csv);
  output(ensemble_, "--json", "Write it as JSON; - is standard output", "FILE", o.json);
  ensemble_->add_flag("--dry-run", o.run.dry_run, "Simulate nothing; list the members");
}

void Reader::declare_generate()
{
  GenerateOptions& o = generate_options_;
  generate_ = app_.add_subcommand("generate", "Write the initial states of a scene as CSV");
  generate_->footer(generate_examples);
  declare_scene(generate_, o.scene);
  output(generate_, "-o,--output", "The states; - is standard output (default)", "STATES.csv",
         o.output);
  output(generate_, "--config", "The settings too, as the original program reads them",
         "CONFIG.csv", o.config);
  generate_->add_flag("--force", o.force, "Replace files that exist");
}

void Reader::declare_validate()
{
  validate_ = app_.add_subcommand("validate",
                                  "Tell all that is wrong with a scene, and what to expect of it");
  validate_->footer(validate_examples);
  declare_scene(validate_, validate_options_.scene);
}

void Reader::declare_info()
{
  info_ = app_.add_subcommand("info", "Tell what is in a trajectory");
  info_->footer(info_examples);
  info_->add_option("FILE", info_options_.file, "Trajectory (H5MD)")
      ->required()
      ->type_name("FILE.h5md");
  info_
      ->add_option("--json", info_options_.json,
                   "Write it as JSON; with - (standard output) there is no other text")
      ->type_name("FILE");
  info_->add_flag("--force", info_options_.force, "Replace the JSON file if it exists");
}

void Reader::declare_compare()
{
  CompareOptions& o = compare_options_;
  compare_ = app_.add_subcommand("compare",
                                 "Compare two trajectories or states: exit 0 if equal, 2 if not");
  compare_->footer(compare_examples);
  compare_->add_option("A", o.a, "Trajectory, or states as CSV")->required()->type_name("FILE");
  compare_->add_option("B", o.b, "Likewise; states compare with the last frame of a trajectory")
      ->required()
      ->type_name("FILE");
  option(compare_, "--tolerance",
         "Largest deviation of a number that still counts as equal (default 0)", "EPS",
         [&](std::string const& word) { o.tolerance = decimal("--tolerance", word, true); });
}

void Reader::declare_render()
{
  RenderOptions& o = render_options_;
  render_ = app_.add_subcommand("render", "Make pictures or a movie of a trajectory or a scene");
  render_->footer(render_examples);
  declare_scene(render_, o.scene);
  render_->get_option("SCENE")->description("A trajectory, or a scene, which is simulated");
  output(render_, "-o,--output", "The picture or movie", "OUT.png|mp4|gif", o.output);
  output(render_, "--html", "A page that plays it, complete in one file", "OUT.html", o.html);
  render_->add_flag("--window", o.window, "Play it in a window");
  option(render_, "--frame", "This frame alone; the first is 0, the last -1", "K",
         [&](std::string const& word) {
           constexpr std::int64_t most = std::int64_t{1} << 53;
           o.frame = integer("--frame", word, -most, most);
         });
  option(render_, "--every", "Every K-th frame (default 1)", "K", [&](std::string const& word) {
    o.every = integer("--every", word, 1, std::int64_t{1} << 53);
  });
  option(render_, "--rate", "Time units of the simulation a second of the movie", "R",
         [&](std::string const& word) { o.rate = decimal("--rate", word, false); });
  option(render_, "--fps", "Pictures a second of a movie (default 30)", "F",
         [&](std::string const& word) { o.fps = decimal("--fps", word, false); });
  option(render_, "--size", "Pixels (default: 1080 high, at most 1920 wide)", "WxH",
         [&](std::string const& word) { o.look.size = picture_size(word); });
  option(render_, "--region", "The part of the plane that is shown (default: the box)",
         "X0,Y0,X1,Y1", [&](std::string const& word) { o.look.region = region(word); });
  option(render_, "--colour,--color", "What colour tells: speed (default), id or none", "WHAT",
         [&](std::string const& word) {
           std::string const name = choice("--colour", word, {"speed", "id", "none"});
           o.look.colouring = name == "speed" ? Colouring::speed
                              : name == "id"  ? Colouring::id
                                              : Colouring::none;
         });
  option(render_, "--top-speed", "The speed at the end of the colours (default: from the energy)",
         "V",
         [&](std::string const& word) { o.look.top_speed = decimal("--top-speed", word, false); });
  option(render_, "--style", "plain (default), or classic: the original's red on black", "NAME",
         [&](std::string const& word) {
           o.look.style = choice("--style", word, {"plain", "classic"}) == "classic"
                              ? Style::classic
                              : Style::plain;
         });
  declare_threads(render_, o.kokkos);
  render_->add_flag("--force", o.force, "Replace files that exist");
  render_->add_flag("-q,--quiet", o.kokkos.quiet, "Say nothing; warnings and errors stay");
}

void Reader::declare_plot()
{
  PlotOptions& o = plot_options_;
  plot_ = app_.add_subcommand("plot", "Plot what happened in a trajectory, with gnuplot");
  plot_->footer(plot_examples);
  plot_->add_option("FILE", o.file, "Trajectory (H5MD)")->required()->type_name("FILE.h5md");
  output(plot_, "-o,--output", "The plots", "OUT.png|svg", o.output);
  output(plot_, "--csv", "Their numbers: OUT_time.csv, OUT_speeds.csv and others", "OUT.csv",
         o.csv);
  plot_->add_flag("--force", o.force, "Replace files that exist");
}

std::vector<std::string> Reader::option_names(CLI::App const* app) const
{
  std::vector<std::string> names;
  for (CLI::Option const* known : app->get_options())
    for (std::string const& name : known->get_lnames())
      names.push_back("--" + name);
  return names;
}

void Reader::explain_error(CLI::ParseError const& error) const
{
  CLI::App const* app = &app_;
  for (CLI::App const* used : app_.get_subcommands())
    app = used;
  std::string message = error.what();
  if (dynamic_cast<CLI::ExtrasError const*>(&error)) {
    // CLI11 lists every unknown word; the first is the one to explain.
    std::vector<std::string> const extra = app->remaining(true);
    if (!extra.empty()) {
      std::string const word = extra.back().empty() ? "''" : extra.front();
      std::string const hint = did_you_mean(word.substr(0, word.find('=')), option_names(app));
      message = fmt::format("{}: unknown {}{}{}", word, word[0] == '-' ? "option" : "argument",
                            hint.empty() ? "" : "; ", hint);
    }
  }
  std::string const which = app == &app_ ? "" : " " + app->get_name();
  wrong(fmt::format("{} (`ricochet{} --help` explains)", message, which));
}

Command Reader::read()
{
  auto const& flags = run_options_.kokkos.flags;
  if (std::find(flags.begin(), flags.end(), "--kokkos-help") != flags.end())
    return KokkosHelp{};
  if (arguments_.empty())
    wrong("no STATES file and no command (`ricochet --help` explains)");
  try {
    std::vector<std::string> reversed(arguments_.rbegin(), arguments_.rend()); // as CLI11 wants it
    app_.parse(std::move(reversed));
  } catch (CLI::CallForHelp const&) {
    return Answer{app_.help()};
  } catch (CLI::CallForVersion const& answer) {
    return Answer{answer.what()};
  } catch (CLI::ParseError const& error) {
    explain_error(error);
  }
  if (!flags.empty() && !run_->parsed() && !ensemble_->parsed() && !render_->parsed())
    wrong(flags[0] + ": only `ricochet run`, `ensemble` and `render` start Kokkos");
  if (run_->parsed())
    return checked_run();
  if (ensemble_->parsed())
    return checked_ensemble();
  if (generate_->parsed()) {
    check_scene(generate_options_.scene);
    if (generate_options_.output == "-" && generate_options_.config == "-")
      wrong("--output and --config both ask for standard output: give one of them a file");
    return generate_options_;
  }
  if (validate_->parsed()) {
    check_scene(validate_options_.scene);
    return validate_options_;
  }
  if (info_->parsed())
    return info_options_;
  if (render_->parsed())
    return checked_render();
  if (plot_->parsed())
    return checked_plot();
  return compare_options_;
}

// What is wrong with the overrides by themselves, whatever the scene.
void Reader::check_scene(SceneOptions const& scene) const
{
  if (is_toml(scene.file) && !scene.config.empty())
    wrong(fmt::format("{}: a scene in TOML takes no CONFIG", scene.config));
  Settings settings;
  ProblemList problems;
  apply(scene.overrides, settings, problems);
  problems.throw_if_any();
}

Command Reader::checked_run() const
{
  RunOptions const& o = run_options_;
  check_scene(o.scene);
  if (o.final_file == "-" && o.json == "-")
    wrong("--final - and --json - both ask for standard output: give one of them a file");
  return o;
}

Command Reader::checked_ensemble()
{
  EnsembleOptions& o = ensemble_options_;
  o.run.kokkos.flags = run_options_.kokkos.flags;
  o.run.command_line = run_options_.command_line;
  check_scene(o.run.scene);
  if (o.run.final_file == "-")
    wrong("--final: the members' states cannot all go to standard output: name a file");
  if (!o.run.resume.empty() && o.run.resume != "auto")
    wrong(fmt::format("--resume: found {} (allowed: auto; each member has a checkpoint)",
                      in_quotes(o.run.resume)));
  if (o.csv == "-" && o.json == "-")
    wrong("--csv - and --json - both ask for standard output: give one of them a file");
  return o;
}

Command Reader::checked_render()
{
  RenderOptions& o = render_options_;
  o.kokkos.flags = run_options_.kokkos.flags;
  check_scene(o.scene);
  if (o.output.empty() && o.html.empty() && !o.window)
    wrong(
        "nothing to make: add --output OUT.png, OUT.mp4 or OUT.gif, --html OUT.html, or --window");
  bool const is_film = is_movie(o.output);
  if (!o.output.empty() && !is_film && std::filesystem::path(o.output).extension() != ".png")
    wrong(fmt::format("--output: found {} (allowed: a name that ends in .png, .mp4 or .gif)",
                      in_quotes(o.output)));
  if (is_film && o.frame)
    wrong("--frame: a movie has many (a picture, OUT.png, has one)");
  if (o.rate && (o.frame || o.every != 1))
    wrong(fmt::format("--rate and {} both choose frames: give one of them",
                      o.frame ? "--frame" : "--every"));
  return o;
}

Command Reader::checked_plot() const
{
  PlotOptions const& o = plot_options_;
  if (o.output.empty() && o.csv.empty())
    wrong("nothing to make: add --output OUT.png or OUT.svg, or --csv OUT.csv");
  auto const kind = std::filesystem::path(o.output).extension();
  if (!o.output.empty() && kind != ".png" && kind != ".svg")
    wrong(fmt::format("--output: found {} (allowed: a name that ends in .png or .svg)",
                      in_quotes(o.output)));
  return o;
}

} // namespace

Command parse_command_line(std::vector<std::string> const& arguments)
{
  return Reader(arguments).read();
}

} // namespace ricochet::driver
