// What the program tells on stderr: sentences for people, lines for logs, or JSON for programs.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace ricochet::driver {

enum class LogFormat {
  text,
  json ///< an object a line, whatever is told
};

/// For everything that is told from now on.
void set_log_format(LogFormat format);
LogFormat log_format();

enum class LogLevel { info, warning, error };

using LogField = std::pair<std::string, std::variant<std::string, std::int64_t, double>>;

/// Tells an event: 2026-01-02T03:04:05Z INFO event key=value ...
void log_event(std::string const& event, std::vector<LogField> const& fields);

/// Tells the event that ends a log, if there is one: with what the program exits.
void log_end(int code);

/// Tells a sentence; as text with "warning: " or "ricochet: " before it, if it is one of these.
void tell(LogLevel level, std::string const& sentence);

} // namespace ricochet::driver
