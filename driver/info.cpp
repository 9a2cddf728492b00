#include "info.hpp"

#include "checkpoint_file.hpp"
#include "json_output.hpp"
#include "output_file.hpp"
#include "text.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

namespace ricochet::driver {

namespace {

constexpr char const* parameter_names[] = {"dt",      "width",       "height",  "radius",
                                           "gravity", "restitution", "friction"};
constexpr char const* observable_names[] = {
    "kinetic",    "potential",       "lost_pairs", "lost_walls",  "numerical",
    "residual",   "temperature",     "pressure_z", "max_overlap", "max_outside",
    "collisions", "separating_hits", "wall_hits"};

std::string indented(std::string const& text)
{
  std::string out;
  for (std::size_t start = 0; start < text.size();) {
    std::size_t const end = std::min(text.find('\n', start), text.size());
    out += "  " + text.substr(start, end - start) + "\n";
    start = end + 1;
  }
  return out;
}

} // namespace

TrajectoryInfo describe(std::string const& path)
{
  TrajectoryReader const file(path);
  TrajectoryInfo info;
  info.file = path;
  std::error_code ignored;
  info.bytes = std::filesystem::file_size(path, ignored);
  info.creator = std::string(trimmed(file.creator("name") + " " + file.creator("version")));
  info.engine = file.text("engine");
  info.law = file.text("law");
  info.precision = file.text("precision");
  info.command_line = file.text("command_line");
  info.provenance = file.text("provenance");
  info.frames = file.frames();
  info.discs = file.discs();
  info.boundary = file.boundary();
  for (std::string const& field : file.fields())
    info.fields.push_back({field, file.is_single_precision(field), file.is_compressed(field)});
  for (char const* name : parameter_names)
    if (auto const value = file.parameter(name))
      info.parameters.emplace_back(name, *value);
  if (auto const steps = file.parameter("steps"))
    info.planned_steps = static_cast<std::int64_t>(*steps);
  if (info.frames == 0)
    return info;

  info.first_step = file.steps().front();
  info.last_step = file.steps().back();
  auto const times = file.times();
  if (!times.empty())
    info.time = TrajectoryInfo::Range{times.front(), times.back()};
  for (char const* name : observable_names) {
    auto const values = file.observable(name);
    if (!values.empty())
      info.observables.emplace_back(name, TrajectoryInfo::Range{values.front(), values.back()});
  }
  auto const kinetic = file.observable("kinetic");
  auto const potential = file.observable("potential");
  if (!kinetic.empty() && !potential.empty())
    info.energy = TrajectoryInfo::Range{kinetic.front() + potential.front(),
                                        kinetic.back() + potential.back()};
  return info;
}

bool is_complete(TrajectoryInfo const& info)
{
  return !info.planned_steps || info.last_step == info.planned_steps;
}

std::string in_words(TrajectoryInfo const& info)
{
  std::string text = fmt::format("{}: {} frames of {} discs, {:.1f} MB", info.file, info.frames,
                                 info.discs, static_cast<double>(info.bytes) / 1e6);
  if (!info.creator.empty())
    text += ", by " + info.creator;
  text += "\n";
  if (info.first_step)
    text += fmt::format("steps       {} ... {}\n", *info.first_step, *info.last_step);
  if (!is_complete(info))
    text += fmt::format("unfinished  the run was to take {} steps\n", *info.planned_steps);
  if (info.time)
    text += fmt::format("time        {} ... {}\n", shortest(info.time->first),
                        shortest(info.time->last));
  for (auto const& field : info.fields)
    text += fmt::format("{:<11} {} precision{}\n", field.name,
                        field.single_precision ? "single" : "double",
                        field.compressed ? ", compressed" : "");
  if (!info.boundary.empty())
    text += fmt::format("boundary    {}\n", joined(info.boundary));
  if (!info.engine.empty())
    text += fmt::format("engine      {}, {}, {}\n", info.engine, info.law, info.precision);
  for (auto const& [name, value] : info.parameters)
    text += fmt::format("{:<11} {}\n", name, shortest(value));
  if (!info.observables.empty())
    text += fmt::format("{:<16} {:>18} {:>18}\n", "", "first frame", "last frame");
  if (info.energy)
    text += fmt::format("{:<16} {:>18.10g} {:>18.10g}\n", "energy", info.energy->first,
                        info.energy->last);
  for (auto const& [name, range] : info.observables)
    text += fmt::format("{:<16} {:>18.10g} {:>18.10g}\n", name, range.first, range.last);
  if (!info.command_line.empty())
    text += "command line\n" + indented(info.command_line);
  if (!info.provenance.empty())
    text += "made by\n" + indented(info.provenance);
  return text;
}

std::string in_words(std::string const& file, SavedRun const& run)
{
  std::string text = fmt::format("{}: checkpoint of {} discs, by ricochet {}\n", file,
                                 run.engine.discs.size(), run.version);
  text += fmt::format("{:<11} {}\n", "step", run.step());
  if (run.frames > 0)
    text += fmt::format("{:<11} {}\n", "frames", run.frames);
  text += fmt::format("{:<11} {:.3g} s\n", "stepping", run.wall_seconds);
  if (run.summary.empty())
    text += "unfinished  the run can go on from here\n";
  else
    text += "finished\n" + indented(run.summary);
  return text + "of the run\n" + indented(run.identity);
}

Exit info(InfoOptions const& options)
{
  std::string words, json;
  if (is_checkpoint(options.file)) {
    SavedRun const run = read_checkpoint(options.file);
    words = in_words(options.file, run);
    json = as_json(options.file, run);
  } else {
    TrajectoryInfo const content = describe(options.file);
    words = in_words(content);
    json = as_json(content);
  }
  if (!options.json.empty()) {
    if (options.json != "-" && same_file(options.json, options.file))
      throw Failure(Exit::cannot_create, fmt::format("'{}' is the input", options.json));
    OutputFile file(options.json, options.force);
    file.write(json);
    file.commit();
  }
  if (options.json != "-") {
    OutputFile out("-", false);
    out.write(words);
    out.commit();
  }
  return Exit::done;
}

} // namespace ricochet::driver
