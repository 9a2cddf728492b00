#include "config.hpp"

#include "input_file.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <string_view>
#include <vector>

namespace ricochet::driver {

namespace {

std::vector<std::string> const keys{"g",      "alpha",  "beta", "width",
                                    "height", "radius", "fps",  "totTime"};

// The key behind a quantity as the kernels call it.
std::string key_of(std::string const& quantity)
{
  static std::map<std::string, std::string> const names{
      {"forces.gravity", "g"},       {"contact.restitution", "alpha"}, {"contact.friction", "beta"},
      {"box.width", "width"},        {"box.height", "height"},         {"discs.radius", "radius"},
      {"run.steps_per_time", "fps"}, {"run.duration", "totTime"}};
  auto const found = names.find(quantity);
  return found == names.end() ? quantity : found->second;
}

// The largest integer not above n/2; the walls stand there.
std::int64_t half(std::int64_t n)
{
  return n >= 0 ? n / 2 : -((-(n + 1)) / 2) - 1;
}

class Parser {
 public:
  Parser(std::string const& path, ProblemList& problems) : problems_(problems)
  {
    config_.path = path;
  }

  Config parse(std::string const& text)
  {
    config_.text = text;
    std::string_view rest = text;
    if (rest.substr(0, 3) == "\xef\xbb\xbf") // byte-order mark
      rest.remove_prefix(3);
    if (trimmed(rest).empty())
      return config_;

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
    return config_;
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

  void parse_entry(Place place, std::string const& key, std::string_view value)
  {
    auto* const real = real_of(key);
    auto* const integer = integer_of(key);
    if (!real && !integer)
      return add(place, fmt::format("unknown key {} (allowed: {})", in_quotes(key), joined(keys)),
                 did_you_mean(key, keys));

    auto const [entry, is_new] =
        config_.entries.try_emplace(key, Config::Entry{place, std::string(value)});
    if (!is_new)
      return add(place,
                 fmt::format("{}: found a second time (first in column {})", key,
                             entry->second.place.column),
                 "keep one of them");

    NumberError const error = real ? parse_decimal(value, *real) : parse_integer(value, *integer);
    if (error != NumberError::none)
      return add(place, fmt::format("{}: found {}, which {} (allowed: {})", key, in_quotes(value),
                                    explain(error), allowed(key)));
    bool const too_small = (key == "fps" && *integer <= 0) || (key == "totTime" && *integer < 0);
    if (too_small)
      add(place, fmt::format("{}: found {} (allowed: {})", key, value, allowed(key)));
  }

  static std::string allowed(std::string const& key)
  {
    if (key == "g")
      return "a decimal number";
    if (key == "alpha" || key == "beta")
      return "a decimal number in 0...1";
    if (key == "totTime")
      return "an integer >= 0";
    return "an integer > 0";
  }

  double* real_of(std::string_view key)
  {
    return key == "g"       ? &config_.gravity
           : key == "alpha" ? &config_.alpha
           : key == "beta"  ? &config_.beta
                            : nullptr;
  }

  std::int64_t* integer_of(std::string_view key)
  {
    return key == "width"     ? &config_.width
           : key == "height"  ? &config_.height
           : key == "radius"  ? &config_.radius
           : key == "fps"     ? &config_.steps_per_time
           : key == "totTime" ? &config_.duration
                              : nullptr;
  }

  void add(Place place, std::string const& problem, std::string const& suggestion = "")
  {
    problems_.add(config_.path, place, problem, suggestion);
  }

  Config config_;
  Place place_;
  ProblemList& problems_;
};

} // namespace

Config parse_config(std::string const& path, std::string const& text, ProblemList& problems)
{
  return Parser(path, problems).parse(text);
}

Config read_config(std::string const& path, ProblemList& problems)
{
  constexpr std::size_t longest = 1 << 16; // a line of eight settings is far shorter
  std::string text(longest + 1, '\0');
  text.resize(InputFile(path).read(text.data(), text.size()));
  if (text.size() > longest) {
    problems.add(path, {},
                 fmt::format("found more than {} bytes (CONFIG is one line of key=value)", longest),
                 "is this the STATES file?");
    return {};
  }
  return parse_config(path, text, problems);
}

Model model_of(Config const& config)
{
  Model model;
  model.gravity = config.gravity;
  model.contact.restitution = config.alpha;
  model.contact.friction = config.beta;
  model.radius = static_cast<double>(config.radius);
  model.box.width = 2 * static_cast<double>(half(config.width));
  model.box.height = 2 * static_cast<double>(half(config.height));
  return model;
}

void check_model(Config const& config, Model const& model, ProblemList& problems)
{
  for (Problem const& problem : ricochet::problems(model)) {
    std::string const key = key_of(problem.quantity);
    auto const own = config.entries.find(key);
    // A default that does not fit is reported where the entry stands that it does not fit to.
    auto const place = own != config.entries.end() ? own : config.entries.find("radius");
    std::string const found =
        own != config.entries.end() ? own->second.value : problem.found + " by default";
    bool const of_box = key == "width" || key == "height";
    problems.add(config.path, place != config.entries.end() ? place->second.place : Place{},
                 fmt::format("{}: found {} (allowed: {}{})", key, found, problem.allowed,
                             of_box ? "; the walls stand at the integer half of it" : ""));
  }
}

} // namespace ricochet::driver
