#include "ensemble.hpp"

#include "kokkos_startup.hpp"
#include "log.hpp"
#include "output_file.hpp"
#include "provenance.hpp"
#include "run.hpp"
#include "text.hpp"
#include "variation.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <mutex>
#include <new>
#include <set>
#include <utility>

namespace ricochet::driver {

namespace {

using Json = nlohmann::ordered_json;

/// A run of the ensemble, and what became of it.
struct Member {
  RunOptions options;
  std::vector<std::string> values; ///< of the settings that vary
  std::string trajectory;          ///< empty: none
  Exit code = Exit::stopped;
  std::string error = "not begun";
  std::string summary; ///< as JSON; empty if it did not come to one
};

// NAME_0012.h5md for NAME.h5md; no file stays none.
std::string numbered(std::string const& path, std::size_t member, std::size_t members)
{
  if (path.empty())
    return path;
  std::size_t const digits = std::max<std::size_t>(4, std::to_string(members - 1).size());
  std::filesystem::path const name = path;
  return (name.parent_path() / fmt::format("{}_{:0{}}{}", name.stem().string(), member, digits,
                                           name.extension().string()))
      .string();
}

// Replaces what the command line says about a setting, or adds to it.
void set(std::vector<Override>& overrides, Override const& setting)
{
  auto const same = [&](Override const& other) { return other.key == setting.key; };
  overrides.erase(std::remove_if(overrides.begin(), overrides.end(), same), overrides.end());
  overrides.push_back(setting);
}

class Ensemble {
 public:
  explicit Ensemble(EnsembleOptions const& options);
  Exit go();

 private:
  void check() const;
  void run_all(StopRequests& stops);
  void run_member(std::size_t member, Placement placement, StopRequests& stops);
  void simulate(Member& member, Placement placement, StopRequests& stops);
  void tell_warnings(Run const& run, std::string const& name);
  void conclude(Member const& member, std::string const& name);
  std::string name_of(std::size_t member) const;
  Exit code() const;
  std::string as_csv() const;
  std::string as_json() const;
  void write_tables() const;

  EnsembleOptions const& options_;
  std::vector<Variation> variations_;
  std::vector<Member> members_;
  std::string base_; ///< the trajectory whose name the members' have with a number
  int at_once_ = 1;
  double seconds_ = 0;
  std::mutex telling_;
  std::size_t finished_ = 0;
  std::set<std::string> told_; ///< warnings
};

Ensemble::Ensemble(EnsembleOptions const& options) : options_(options)
{
  ProblemList later; // the members are checked with what varies
  Settings const scene = read_settings(options.run.scene, later);
  variations_ = variations(options.vary, options.members, scene.seed.value_or(1));
  base_ = scene.file.value_or("");
  members_.resize(variations_.front().values.size());
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Member& member = members_[k];
    member.options = options.run;
    member.options.kokkos.quiet = true; // the ensemble speaks for it
    member.options.final_file = numbered(options.run.final_file, k, members_.size());
    auto& overrides = member.options.scene.overrides;
    member.trajectory = numbered(base_, k, members_.size());
    if (scene.file)
      set(overrides, {"--output", "output.file", member.trajectory});
    if (scene.checkpoint)
      set(overrides,
          {"--checkpoint", "checkpoint.file", numbered(*scene.checkpoint, k, members_.size())});
    for (Variation const& variation : variations_) {
      member.values.push_back(variation.values[k]);
      overrides.push_back({variation.option, variation.key, variation.values[k]});
    }
  }
}

// Nothing begins before all is known to be right that can be known without the discs.
void Ensemble::check() const
{
  RunOptions const& run = options_.run;
  for (Member const& member : members_) {
    Scene const scene = read_scene(member.options.scene, Purpose::settings);
    check_run(member.options, scene.settings);
  }
  check_outputs({options_.csv, options_.json}, {run.scene.file, run.scene.config},
                run.force || !run.resume.empty());
}

std::string Ensemble::name_of(std::size_t member) const
{
  std::string values;
  for (std::size_t i = 0; i < variations_.size(); ++i)
    values +=
        fmt::format("{}{}={}", i == 0 ? "" : ", ", variations_[i].key, members_[member].values[i]);
  return fmt::format("member {} ({})", member, values);
}

Exit Ensemble::go()
{
  check();
  if (options_.run.dry_run) {
    OutputFile out("-", false);
    out.write(as_csv());
    out.commit();
    return Exit::done;
  }
  auto const locks = lock_outputs({base_, options_.csv, options_.json});
  Member const& first = members_.front();
  StopRequests stops(
      options_.run.walltime,
      stop_file(first.options, read_scene(first.options.scene, Purpose::settings).settings));
  {
    KokkosSession const kokkos(options_.run.kokkos);
    run_all(stops);
  }
  write_tables();
  if (!options_.run.kokkos.quiet)
    log_event("result", {{"members", static_cast<std::int64_t>(members_.size())},
                         {"finished", std::count_if(members_.begin(), members_.end(),
                                                    [](Member const& member) {
                                                      return member.code == Exit::done;
                                                    })},
                         {"wall_seconds", seconds_}});
  return code();
}

void Ensemble::run_all(StopRequests& stops)
{
  auto const start = std::chrono::steady_clock::now();
  auto const count = static_cast<int>(members_.size());
  at_once_ = std::min(count, host_threads());
  // One at a time, a member may use all that there is.
  Placement const placement = at_once_ > 1 ? Placement::serial : Placement::automatic;
  if (!options_.run.kokkos.quiet)
    log_event("start", {{"version", version()},
                        {"command", options_.run.command_line},
                        {"host", host_name()},
                        {"members", std::int64_t{count}},
                        {"at_once", std::int64_t{at_once_}}});
  on_host_threads(count, [&](int k) { run_member(static_cast<std::size_t>(k), placement, stops); });
  std::chrono::duration<double> const spent = std::chrono::steady_clock::now() - start;
  seconds_ = spent.count();
}

void Ensemble::run_member(std::size_t k, Placement placement, StopRequests& stops)
{
  Member& member = members_[k];
  try {
    simulate(member, placement, stops);
    member.code = Exit::done;
    member.error = "";
  } catch (Failure const& failure) {
    member.code = failure.code();
    member.error = failure.what();
  } catch (std::bad_alloc const&) {
    member.code = Exit::failed;
    member.error = "not enough memory for this scene";
  } catch (std::exception const& error) {
    member.code = Exit::internal;
    member.error = error.what();
  }
  conclude(member, name_of(k));
}

void Ensemble::simulate(Member& member, Placement placement, StopRequests& stops)
{
  member.options.at_once = at_once_;
  Scene scene = read_scene(member.options.scene);
  auto const outputs = outputs_of(member.options, scene.settings);
  bool const can_go_on = !outputs.back().empty();
  if (std::string const why = stops.reason(0, !can_go_on); !why.empty())
    throw Failure(can_go_on ? Exit::stopped : static_cast<Exit>(128 + stops.signal()),
                  fmt::format("not begun because of {}", why));
  auto const locks = lock_outputs(outputs);
  scene.method.placement = placement;
  Run run(member.options, std::move(scene));
  tell_warnings(run, name_of(static_cast<std::size_t>(&member - members_.data())));
  try {
    run.go(stops);
  } catch (...) {
    member.summary = run.result().json; // of a run that broke
    throw;
  }
  member.summary = run.result().json;
}

// Members are much alike: what one was warned of is not told of the others.
void Ensemble::tell_warnings(Run const& run, std::string const& name)
{
  std::lock_guard const lock(telling_);
  for (std::string const& warning : run.warnings())
    if (told_.insert(warning).second)
      tell(LogLevel::warning, fmt::format("{}: {}", name, warning));
}

void Ensemble::conclude(Member const& member, std::string const& name)
{
  std::lock_guard const lock(telling_);
  ++finished_;
  if (!member.error.empty())
    tell(LogLevel::error, fmt::format("{}: {}", name, member.error));
  if (options_.run.kokkos.quiet)
    return;
  std::vector<LogField> fields{{"member", std::int64_t{&member - members_.data()}},
                               {"code", std::int64_t{static_cast<int>(member.code)}},
                               {"ended", static_cast<std::int64_t>(finished_)},
                               {"members", static_cast<std::int64_t>(members_.size())}};
  for (std::size_t i = 0; i < variations_.size(); ++i)
    fields.emplace_back(variations_[i].key, member.values[i]);
  log_event("member", fields);
}

// A job that is submitted again finishes what was stopped, so that comes first.
Exit Ensemble::code() const
{
  Exit worst = Exit::done;
  for (Member const& member : members_) {
    if (member.code == Exit::stopped)
      return Exit::stopped;
    if (worst == Exit::done)
      worst = member.code;
  }
  return worst;
}

// A value of a setting as JSON: a number if it reads as one.
Json as_value(std::string const& text)
{
  std::int64_t integer = 0;
  if (parse_integer(text, integer) == NumberError::none)
    return integer;
  double real = 0;
  if (parse_decimal(text, real) == NumberError::none)
    return real;
  return text;
}

Json or_null(std::string const& text)
{
  return text.empty() ? Json(nullptr) : Json(text);
}

std::string Ensemble::as_json() const
{
  Json json;
  json["version"] = version();
  json["git"] = git_state();
  json["command_line"] = options_.run.command_line;
  json["at_once"] = at_once_;
  json["wall_seconds"] = seconds_;
  json["members"] = Json::array();
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Member const& member = members_[k];
    Json row;
    row["member"] = k;
    for (std::size_t i = 0; i < variations_.size(); ++i)
      row["vary"][variations_[i].key] = as_value(member.values[i]);
    row["trajectory"] = or_null(member.trajectory);
    row["code"] = static_cast<int>(member.code);
    row["error"] = or_null(member.error);
    row["summary"] = member.summary.empty() ? Json(nullptr) : Json::parse(member.summary);
    json["members"].push_back(row);
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

// Calls use(name, value) for the numbers and texts of a summary; lists of texts are left out.
template <class Use>
void for_numbers(Json const& json, std::string const& name, Use const& use)
{
  if (json.is_structured())
    for (auto const& [key, value] : json.items())
      for_numbers(value, name.empty() ? key : fmt::format("{}.{}", name, key), use);
  else if (name.rfind("warnings.", 0) != 0)
    use(name, json);
}

// Quoted where a comma, a quote or a line end would be mistaken (RFC 4180).
std::string as_cell(std::string const& text)
{
  if (text.find_first_of(",\"\r\n") == std::string::npos)
    return text;
  std::string cell = "\"";
  for (char const c : text)
    cell += c == '"' ? std::string("\"\"") : std::string(1, c);
  return cell + "\"";
}

std::string as_row(std::vector<std::string> const& cells)
{
  std::string row;
  for (std::string const& cell : cells) {
    row += row.empty() ? "" : ",";
    row += as_cell(cell);
  }
  return row + "\n";
}

std::string Ensemble::as_csv() const
{
  std::vector<std::string> head{"member"}, numbers;
  for (Variation const& variation : variations_)
    head.push_back(variation.key);
  head.emplace_back("trajectory");
  bool const are_run = !options_.run.dry_run;
  if (are_run)
    head.insert(head.end(), {"code", "error"});
  auto const some = std::find_if(members_.begin(), members_.end(),
                                 [](Member const& member) { return !member.summary.empty(); });
  if (some != members_.end())
    for_numbers(Json::parse(some->summary), "",
                [&](std::string const& name, Json const&) { numbers.push_back(name); });
  head.insert(head.end(), numbers.begin(), numbers.end());

  std::string text = as_row(head);
  for (std::size_t k = 0; k < members_.size(); ++k) {
    Member const& member = members_[k];
    std::vector<std::string> row{std::to_string(k)};
    row.insert(row.end(), member.values.begin(), member.values.end());
    row.push_back(member.trajectory);
    if (are_run)
      row.insert(row.end(), {std::to_string(static_cast<int>(member.code)), member.error});
    if (!member.summary.empty())
      for_numbers(Json::parse(member.summary), "", [&](std::string const&, Json const& value) {
        row.push_back(value.is_string() ? value.get<std::string>()
                      : value.is_null() ? ""
                                        : value.dump());
      });
    row.resize(head.size());
    text += as_row(row);
  }
  return text;
}

void Ensemble::write_tables() const
{
  bool const replace = options_.run.force || !options_.run.resume.empty();
  auto const write = [&](std::string const& path, std::string const& text) {
    OutputFile file(path, replace);
    file.write(text);
    file.commit();
  };
  if (!options_.json.empty())
    write(options_.json, as_json());
  if (!options_.csv.empty() || options_.json.empty())
    write(options_.csv.empty() ? "-" : options_.csv, as_csv());
}

} // namespace

Exit ensemble(EnsembleOptions const& options)
{
  set_log_format(options.run.log_format);
  return Ensemble(options).go();
}

} // namespace ricochet::driver
