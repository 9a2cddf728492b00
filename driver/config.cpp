#include "config.hpp"

#include "input_file.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string_view>
#include <utility>
#include <vector>

namespace ricochet::driver {

namespace {

// A key of CONFIG.csv and the setting that it makes.
struct ConfigKey {
  char const* name;
  char const* setting;
  bool is_integer;
  char const* allowed;
};
constexpr char const* an_integer = "an integer > 0";
constexpr ConfigKey config_keys[] = {
    {"g", "forces.gravity", false, "a decimal number"},
    {"alpha", "contact.restitution", false, "a decimal number in 0...1"},
    {"beta", "contact.friction", false, "a decimal number in 0...1"},
    {"width", "box.width", true, an_integer},
    {"height", "box.height", true, an_integer},
    {"radius", "discs.radius", true, an_integer},
    {"fps", "run.steps_per_time", true, an_integer},
    {"totTime", "run.duration", true, "an integer >= 0"}};

std::vector<std::string> const keys = [] {
  std::vector<std::string> names;
  for (ConfigKey const& key : config_keys)
    names.emplace_back(key.name);
  return names;
}();

// The largest integer not above n/2; the walls stand there.
std::int64_t half(std::int64_t n)
{
  return n >= 0 ? n / 2 : -((-(n + 1)) / 2) - 1;
}

class Parser {
 public:
  Parser(std::string const& path, ProblemList& problems) : path_(path), problems_(problems)
  {
    settings_.scene = path;
    for (ConfigKey const& key : config_keys)
      settings_.names[key.setting] = key.name;
  }

  Settings parse(std::string const& text)
  {
    std::string_view rest = text;
    if (rest.substr(0, 3) == "\xef\xbb\xbf") // byte-order mark
      rest.remove_prefix(3);
    if (trimmed(rest).empty())
      return settings_;

    skip_space(rest);
    std::size_t const end = std::min(rest.find('\n'), rest.size());
    parse_line(rest.substr(0, end));
    rest.remove_prefix(end);
    skip_space(rest);
    if (!rest.empty())
      add(place_,
          fmt::format("found a second line {} (CONFIG is one line of key=value,key=value)",
                      in_quotes(trimmed(rest.substr(0, rest.find('\n'))))),
          "join the lines with a comma");
    return settings_;
  }

 private:
  void skip_space(std::string_view& rest)
  {
    while (!rest.empty() && is_space(rest.front())) {
      place_ =
          rest.front() == '\n' ? Place{place_.line + 1, 1} : Place{place_.line, place_.column + 1};
      rest.remove_prefix(1);
    }
  }

  void parse_line(std::string_view line)
  {
    for (;;) {
      std::size_t const comma = std::min(line.find(','), line.size());
      parse_setting(line.substr(0, comma));
      if (comma == line.size())
        break;
      place_.column += static_cast<std::int64_t>(comma + 1);
      line.remove_prefix(comma + 1);
    }
  }

  // One key=value; place_ is where it starts, blanks included.
  void parse_setting(std::string_view setting)
  {
    Place key_place = place_;
    std::string_view const word = trimmed(setting);
    key_place.column += word.empty() ? 0 : word.data() - setting.data();

    std::size_t const equals = word.find('=');
    if (word.empty())
      return add(key_place, "found nothing between two commas (a setting is key=value)",
                 "remove a comma");
    if (equals == std::string_view::npos)
      return add(key_place,
                 fmt::format("found {} without '=' (a setting is key=value)", in_quotes(word)),
                 did_you_mean(trimmed(word), keys));
    parse_entry(key_place, std::string(trimmed(word.substr(0, equals))),
                trimmed(word.substr(equals + 1)));
  }

  void parse_entry(Place place, std::string const& name, std::string_view value)
  {
    auto const key = std::find_if(std::begin(config_keys), std::end(config_keys),
                                  [&](ConfigKey const& known) { return name == known.name; });
    if (key == std::end(config_keys))
      return add(place, fmt::format("unknown key {} (allowed: {})", in_quotes(name), joined(keys)),
                 did_you_mean(name, keys));

    auto const [first, is_new] = columns_.try_emplace(name, place.column);
    if (!is_new)
      return add(place,
                 fmt::format("{}: found a second time (first in column {})", name, first->second),
                 "keep one of them");

    double real = 0;
    std::int64_t integer = 0;
    NumberError const error =
        key->is_integer ? parse_integer(value, integer) : parse_decimal(value, real);
    bool const too_small = (name == "fps" && integer <= 0) || (name == "totTime" && integer < 0);
    if (error != NumberError::none || too_small) {
      settings_.wrong.insert(key->setting);
      std::string const why = error == NumberError::none
                                  ? std::string(value)
                                  : in_quotes(value) + ", which " + explain(error);
      return add(place, fmt::format("{}: found {} (allowed: {})", name, why, key->allowed));
    }

    bool const of_box = name == "width" || name == "height";
    double const number =
        key->is_integer ? static_cast<double>(of_box ? 2 * half(integer) : integer) : real;
    assign(settings_, key->setting, number, {path_, place, name, std::string(value)}, problems_);
  }

  void add(Place place, std::string const& problem, std::string const& suggestion = "")
  {
    problems_.add(path_, place, problem, suggestion);
  }

  Settings settings_;
  std::map<std::string, std::int64_t> columns_; ///< in which the keys stand
  Place place_;
  std::string path_;
  ProblemList& problems_;
};

} // namespace

Settings parse_config(std::string const& path, std::string const& text, ProblemList& problems)
{
  return Parser(path, problems).parse(text);
}

Settings read_config(std::string const& path, ProblemList& problems)
{
  constexpr std::size_t longest = 1 << 16; // a line of eight settings is far shorter
  auto const text = read_text(path, longest);
  if (text)
    return parse_config(path, *text, problems);
  problems.add(path, {},
               fmt::format("found more than {} bytes (CONFIG is one line of key=value)", longest),
               "is this the STATES file?");
  return {};
}

std::string as_config(Settings const& s, ProblemList& problems)
{
  std::string text;
  auto const write = [&](char const* name, char const* setting, double value, bool is_possible,
                         char const* allowed) {
    if (!is_possible)
      problems.add(blame(s, setting), fmt::format("{} is {} (CONFIG.csv allows: {})", setting,
                                                  shortest(value), allowed));
    text += fmt::format("{}{}={}", text.empty() ? "" : ",", name, shortest(value));
  };
  auto const is_integer = [](double value) {
    return value == std::round(value) && std::abs(value) < 1e15;
  };
  auto const write_integer = [&](char const* name, char const* setting, double value) {
    write(name, setting, value, is_integer(value), "an integer");
  };
  auto const write_length = [&](char const* name, char const* setting, double value) {
    write(name, setting, value, is_integer(value / 2), "an even integer");
  };
  // A dt that is the reciprocal of an integer is as good as that.
  double const per_time = s.dt ? std::round(1 / *s.dt) : *s.steps_per_time;
  double const dt = 1 / per_time;
  write("g", "forces.gravity", *s.gravity, true, "");
  write("alpha", "contact.restitution", *s.restitution, true, "");
  write("beta", "contact.friction", *s.friction, true, "");
  write_length("width", "box.width", *s.width);
  write_length("height", "box.height", *s.height);
  write_integer("radius", "discs.radius", *s.radius);
  if (s.dt)
    write("fps", "run.dt", *s.dt == dt ? per_time : *s.dt, *s.dt == dt,
          "the reciprocal of an integer");
  else
    write_integer("fps", "run.steps_per_time", per_time);
  write_integer("totTime", s.steps ? "run.steps" : "run.duration",
                s.steps ? static_cast<double>(*s.steps) * dt : *s.duration);
  if (*s.law != Law::swap_scale)
    problems.add(blame(s, "contact.law"),
                 "contact.law is restitution (CONFIG.csv knows the original's alone, swap_scale)");
  if (!*s.pairs)
    problems.add(blame(s, "contact.pairs"),
                 "contact.pairs is false (in CONFIG.csv discs always meet)");
  for (auto const& [setting, boundary] : {std::pair("box.x", *s.x), std::pair("box.y", *s.y)})
    if (boundary != Boundary::walls)
      problems.add(blame(s, setting),
                   fmt::format("{} is periodic (CONFIG.csv knows walls alone)", setting));
  return text + "\n";
}

} // namespace ricochet::driver
