#include "json_output.hpp"

#include "provenance.hpp"

#include <nlohmann/json.hpp>

namespace ricochet::driver {

namespace {

using Json = nlohmann::ordered_json; // which writes null for numbers that are not finite

std::string text_of(Json const& json)
{
  // Paths and command lines may hold any bytes.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

template <class T>
Json or_null(std::optional<T> const& value)
{
  return value ? Json(*value) : Json(nullptr);
}

Json text_or_null(std::string const& text)
{
  return text.empty() ? Json(nullptr) : Json(text);
}

} // namespace

std::string as_json(Summary const& summary)
{
  Report const& report = summary.report;
  EnergyLedger const& energy = report.energy;
  Json json;
  json["version"] = version();
  json["git"] = git_state();
  json["engine"] = summary.engine;
  json["law"] = summary.law;
  json["precision"] = summary.precision;
  json["backend"] = summary.backend;
  json["threads"] = summary.threads;
  json["discs"] = report.discs;
  json["steps"] = report.steps;
  json["dt"] = summary.dt;
  json["simulated_time"] = report.time;
  json["wall_seconds"] = summary.wall_seconds;
  json["disc_steps_per_second"] = summary.disc_steps_per_second();
  json["collisions"] = report.collisions;
  json["collisions_per_second"] = summary.collisions_per_second();
  json["wall_hits"] = report.wall_hits;
  json["separating_hits"] = report.separating_hits;
  json["windows"] = report.windows;
  json["executions"] = {{"islands", report.executions.islands},
                        {"crowd", report.executions.crowd},
                        {"rounds", report.executions.rounds},
                        {"in_order", report.executions.in_order}};
  json["max_overlap"] = report.max_overlap;
  json["max_outside"] = report.max_outside;
  json["energy"] = {{"kinetic_initial", energy.kinetic_initial},
                    {"potential_initial", energy.potential_initial},
                    {"kinetic", energy.kinetic},
                    {"potential", energy.potential},
                    {"lost_pairs", energy.lost_pairs},
                    {"lost_walls", energy.lost_walls},
                    {"numerical", energy.numerical},
                    {"residual", energy.residual()}};
  json["momentum"] = {report.momentum_x, report.momentum_y};
  json["temperature"] = report.temperature;
  json["pressure_z"] = or_null(report.pressure_z);
  json["packing_fraction"] = summary.packing_fraction;
  json["at_rest"] = or_null(summary.is_at_rest);
  json["state_hash"] = hash_text(summary.state_hash);
  json["verified"] = "not checked";
  json["error_estimate"] = nullptr;
  json["warnings"] = summary.warnings;
  return text_of(json);
}

std::string as_json(TrajectoryInfo const& info)
{
  auto const range = [](TrajectoryInfo::Range const& r) {
    return Json{{"first", r.first}, {"last", r.last}};
  };
  Json json;
  json["file"] = info.file;
  json["bytes"] = info.bytes;
  json["creator"] = text_or_null(info.creator);
  json["frames"] = info.frames;
  json["discs"] = info.discs;
  json["step"] = info.first_step ? Json{{"first", *info.first_step}, {"last", *info.last_step}}
                                 : Json(nullptr);
  json["complete"] = is_complete(info);
  json["time"] = info.time ? range(*info.time) : Json(nullptr);
  json["fields"] = Json::array();
  for (auto const& field : info.fields)
    json["fields"].push_back({{"name", field.name},
                              {"precision", field.single_precision ? "single" : "double"},
                              {"compressed", field.compressed}});
  json["boundary"] = info.boundary;
  json["engine"] = text_or_null(info.engine);
  json["law"] = text_or_null(info.law);
  json["precision"] = text_or_null(info.precision);
  json["parameters"] = Json::object();
  for (auto const& [name, value] : info.parameters)
    json["parameters"][name] = value;
  json["energy"] = info.energy ? range(*info.energy) : Json(nullptr);
  json["observables"] = Json::object();
  for (auto const& [name, values] : info.observables)
    json["observables"][name] = range(values);
  json["command_line"] = text_or_null(info.command_line);
  json["provenance"] = text_or_null(info.provenance);
  return text_of(json);
}

std::string as_json(std::string const& file, SavedRun const& run)
{
  Json json;
  json["file"] = file;
  json["version"] = run.version;
  json["discs"] = run.engine.discs.size();
  json["step"] = run.step();
  json["frames"] = run.frames;
  json["wall_seconds"] = run.wall_seconds;
  json["summary"] = run.summary_json.empty() ? Json(nullptr) : Json::parse(run.summary_json);
  json["identity"] = run.identity;
  return text_of(json);
}

} // namespace ricochet::driver
