#include "command_line.hpp"

#include "exit_codes.hpp"
#include "provenance.hpp"
#include "text.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <functional>

namespace ricochet::driver {

namespace {

std::vector<std::string> const commands{"run", "info", "compare"};

[[noreturn]] void wrong(std::string const& message)
{
  throw Failure(Exit::usage, message);
}

char const* name(Compression compression)
{
  switch (compression) {
  case Compression::automatic:
    return "auto";
  case Compression::none:
    return "none";
  case Compression::deflate:
    return "deflate";
  }
  return "";
}

// `argument` as a shell would take it back.
std::string for_shell(std::string const& argument)
{
  std::string const plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos)
    return argument;
  std::string out = "'";
  for (char const c : argument)
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
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

// The element of `list` that is called `word`.
template <class Kind>
Kind by_name(std::string const& option, std::string const& word, std::vector<Kind> const& list)
{
  std::vector<std::string> names;
  for (Kind const kind : list) {
    names.emplace_back(name(kind));
    if (word == names.back())
      return kind;
  }
  std::string const hint = did_you_mean(word, names);
  wrong(fmt::format("{}: found {} (allowed: {}){}{}", option, in_quotes(word), joined(names),
                    hint.empty() ? "" : " ", hint));
}

constexpr std::int64_t most_steps = std::int64_t{1} << 53; // a double still counts them

std::string const run_examples = R"(Examples:
  ricochet run gas.csv gas.config.csv                  the final states on standard output
  ricochet gas.csv gas.config.csv                      the same, as the original is called
  ricochet run gas.csv gas.config.csv -o gas.h5md --every 45 --final last.csv
                                                       a frame every 45 steps, and the final states
  ricochet run gas.csv --duration 10 --json - | jq .energy
                                                       a summary for other programs
  ricochet run gas.csv --engine simultaneous --law restitution --threads 4 --final last.csv)";

std::string const info_examples = R"(Examples:
  ricochet info gas.h5md              frames, discs, times, energy, and where the file comes from
  ricochet info gas.h5md --json -     the same for other programs)";

std::string const compare_examples = R"(Examples:
  ricochet compare a.h5md b.h5md                       equal in every number of every frame?
  ricochet compare a.csv b.csv --tolerance 1e-9        final states, up to 1e-9
  ricochet compare a.h5md last.csv                     the last frame of a.h5md and last.csv)";

class Reader {
 public:
  explicit Reader(std::vector<std::string> const& arguments);
  Command read();

 private:
  void reject_mistaken_command() const;
  void declare_run();
  void declare_info();
  void declare_compare();
  CLI::Option* option(CLI::App* app, std::string const& names, std::string const& what,
                      std::string const& value,
                      std::function<void(std::string const&)> const& read);
  [[noreturn]] void explain_error(CLI::ParseError const& error) const;
  std::vector<std::string> option_names(CLI::App const* app) const;
  void read_fields(std::string const& word);

  CLI::App app_{"Simulates equal discs that bounce in a two-dimensional box.", "ricochet"};
  CLI::App* run_ = nullptr;
  CLI::App* info_ = nullptr;
  CLI::App* compare_ = nullptr;
  std::vector<std::string> arguments_;
  RunOptions run_options_;
  InfoOptions info_options_;
  CompareOptions compare_options_;
};

Reader::Reader(std::vector<std::string> const& arguments)
{
  run_options_.command_line = "ricochet";
  for (std::string const& argument : arguments) {
    run_options_.command_line += " " + for_shell(argument);
    if (argument.rfind("--kokkos-", 0) == 0)
      run_options_.kokkos.flags.push_back(argument);
    else
      arguments_.push_back(argument);
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
  app_.footer("`ricochet STATES.csv [CONFIG.csv]` is short for `ricochet run ...`.\n"
              "Options that begin with --kokkos- go to Kokkos; --kokkos-help lists them.\n"
              "`ricochet COMMAND --help` explains a command.\n\n" +
              run_examples);
  declare_run();
  declare_info();
  declare_compare();
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

void Reader::declare_run()
{
  RunOptions& o = run_options_;
  run_ = app_.add_subcommand("run", "Simulate a scene");
  run_->footer(run_examples);
  run_->add_option("STATES", o.states, "Initial states: records x,y,vx,vy separated by white space")
      ->required()
      ->type_name("FILE.csv");
  run_->add_option("CONFIG", o.config, "Parameters: key=value,key=value (all have defaults)")
      ->type_name("FILE.csv");

  auto const output = [&](std::string const& names, std::string const& what,
                          std::string const& value, std::string& target) {
    auto const name = names.substr(names.find("--"));
    option(run_, names, what, value, [&target, name](std::string const& word) {
      if (word.empty())
        wrong(name + ": found no file name");
      target = word;
    });
  };
  output("-o,--output", "Write a trajectory (H5MD)", "FILE.h5md", o.output);
  CLI::Option* const every =
      option(run_, "--every", "Write a frame every K steps (default 1), and the last", "K",
             [&](std::string const& word) { o.every = integer("--every", word, 1, most_steps); });
  option(run_, "--every-time", "Write a frame every T time units, and the last", "T",
         [&](std::string const& word) { o.every_time = decimal("--every-time", word, false); })
      ->excludes(every);
  option(run_, "--fields", "What frames hold: position or position,velocity (default)", "LIST",
         [&](std::string const& word) { read_fields(word); });
  run_->add_flag("--float32", o.float32, "Store frames in single precision");
  option(
      run_, "--compress", "auto (default), none or deflate", "HOW", [&](std::string const& word) {
        o.compression = by_name<Compression>(
            "--compress", word, {Compression::automatic, Compression::none, Compression::deflate});
      });
  output("--final", "Write the final states as CSV; - is standard output", "FILE.csv",
         o.final_file);
  output("--json", "Write a summary as JSON; - is standard output", "FILE", o.json);

  option(run_, "--engine", "sweep (default) or simultaneous", "NAME",
         [&](std::string const& word) { o.engine = by_name("--engine", word, engine_kinds()); });
  option(run_, "--precision", "double (default) or single", "NAME", [&](std::string const& word) {
    o.precision = by_name<Precision>("--precision", word, {Precision::double_, Precision::single_});
  });
  option(run_, "--law", "Contact law: swap_scale (default) or restitution", "NAME",
         [&](std::string const& word) {
           o.law = by_name<Law>("--law", word, {Law::swap_scale, Law::restitution});
         });
  CLI::Option* const dt =
      option(run_, "--dt", "Length of a step (default 1/fps)", "DT",
             [&](std::string const& word) { o.dt = decimal("--dt", word, false); });
  option(run_, "--steps-per-time", "Steps per time unit (default fps)", "F",
         [&](std::string const& word) {
           double const steps = decimal("--steps-per-time", word, false);
           o.dt = 1 / steps;
           if (!(*o.dt > 0) || !std::isfinite(*o.dt))
             wrong(
                 fmt::format("--steps-per-time: found {} (allowed: what has a reciprocal)", word));
         })
      ->excludes(dt);
  CLI::Option* const duration =
      option(run_, "--duration", "Time to simulate (default totTime)", "T",
             [&](std::string const& word) { o.duration = decimal("--duration", word, true); });
  option(run_, "--steps", "Steps to simulate, instead of a duration", "N",
         [&](std::string const& word) { o.steps = integer("--steps", word, 0, most_steps); })
      ->excludes(duration);
  option(run_, "--threads", "Threads of the host (default: what OpenMP gives)", "N",
         [&](std::string const& word) {
           o.kokkos.threads = static_cast<int>(integer("--threads", word, 1, 65536));
         });
  run_->add_flag("--force", o.force, "Replace files that exist");
  run_->add_flag("-q,--quiet", o.kokkos.quiet,
                 "No progress and no summary; warnings and errors stay");
}

void Reader::read_fields(std::string const& word)
{
  bool position = false;
  run_options_.velocity = false;
  for (std::size_t start = 0; start <= word.size();) {
    std::size_t const end = std::min(word.find(',', start), word.size());
    std::string const field(trimmed(word.substr(start, end - start)));
    bool& seen = field == "velocity" ? run_options_.velocity : position;
    if ((field != "position" && field != "velocity") || seen)
      wrong(fmt::format("--fields: found {}{} (allowed: position; position,velocity)",
                        in_quotes(field),
                        field == "position" || field == "velocity" ? " twice" : ""));
    seen = true;
    start = end + 1;
  }
  if (!position)
    wrong("--fields: found no position (allowed: position; position,velocity)");
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
  if (!flags.empty() && !run_->parsed())
    wrong(flags[0] + ": only `ricochet run` starts Kokkos");
  if (run_->parsed() && run_options_.final_file == "-" && run_options_.json == "-")
    wrong("--final - and --json - both ask for standard output: give one of them a file");
  if (run_->parsed() && run_options_.output == "-")
    wrong("--output: found '-' (allowed: a file; a trajectory cannot go to standard output)");
  if (run_->parsed() && run_options_.output.empty())
    for (char const* name : {"--every", "--every-time", "--fields", "--float32", "--compress"})
      if (run_->count(name) > 0)
        wrong(fmt::format("{}: needs a trajectory: add --output FILE.h5md", name));
  if (run_->parsed())
    return run_options_;
  if (info_->parsed())
    return info_options_;
  return compare_options_;
}

} // namespace

Command parse_command_line(std::vector<std::string> const& arguments)
{
  return Reader(arguments).read();
}

} // namespace ricochet::driver
