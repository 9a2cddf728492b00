#include "log.hpp"

#include "progress.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdio>

namespace ricochet::driver {

namespace {

using Json = nlohmann::ordered_json;

LogFormat format = LogFormat::text;
bool is_begun = false; // the log, by an event

void put(std::string const& text)
{
  std::fputs(text.c_str(), stderr);
  std::fflush(stderr);
}

Json object(char const* level)
{
  return Json{{"time", utc_now()}, {"level", level}};
}

void put(Json const& json)
{
  // Paths may hold any bytes.
  put(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

// Quoted if it is not one word.
std::string as_word(std::string const& text)
{
  bool const is_word = !text.empty() && text.find_first_of(" \t\n\"=") == std::string::npos;
  return is_word ? text : Json(text).dump(-1, ' ', false, Json::error_handler_t::replace);
}

} // namespace

void set_log_format(LogFormat wanted)
{
  format = wanted;
}

LogFormat log_format()
{
  return format;
}

void log_event(std::string const& event, std::vector<LogField> const& fields)
{
  is_begun = true;
  if (format == LogFormat::json) {
    Json json = object("info");
    json["event"] = event;
    for (auto const& [key, value] : fields)
      std::visit([&, name = key](auto const& v) { json[name] = v; }, value);
    return put(json);
  }
  std::string line = fmt::format("{} INFO {}", utc_now(), event);
  for (auto const& [key, value] : fields) {
    line += " " + key + "=";
    if (auto const* const text = std::get_if<std::string>(&value))
      line += as_word(*text);
    else if (auto const* const real = std::get_if<double>(&value))
      line += fmt::format("{:.7g}", *real);
    else
      line += std::to_string(std::get<std::int64_t>(value));
  }
  put(line + "\n");
}

void log_end(int code)
{
  if (is_begun || format == LogFormat::json)
    log_event("end", {{"code", std::int64_t{code}}});
}

void tell(LogLevel level, std::string const& sentence)
{
  if (format == LogFormat::json) {
    Json json = object(level == LogLevel::error     ? "error"
                       : level == LogLevel::warning ? "warning"
                                                    : "info");
    json["message"] = sentence;
    return put(json);
  }
  put((level == LogLevel::error     ? "ricochet: "
       : level == LogLevel::warning ? "warning: "
                                    : "") +
      sentence + "\n");
}

} // namespace ricochet::driver
