#include "settings.hpp"

#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <utility>

namespace ricochet::driver {

namespace {

constexpr std::int64_t most_discs = (std::int64_t{1} << 30) - 1;

/// What is wrong with a value; nothing if it is good.
struct Complaint {
  std::string found;
  std::string suggestion;
};

/// A key, and what can be done with the setting of that name.
struct Key {
  std::string name;
  std::string allowed;
  std::string rival; ///< the key, or table of keys, that says the same in another way
  std::function<std::optional<Complaint>(Settings&, Value const&)> read;
  std::function<std::string(Settings const&)> print; ///< its value in TOML, "" if it is not set
  std::function<void(Settings&)> clear;
};

// TOML tells real numbers from integers, whose range is smaller, by their look.
std::string as_real(double value)
{
  std::string const digits = shortest(value);
  return digits.find_first_of(".ein") == std::string::npos ? digits + ".0" : digits;
}

std::string in_words(Value const& value)
{
  struct Words {
    std::string operator()(Word const& word) const { return in_quotes(word.text); }
    std::string operator()(std::string const& text) const { return in_quotes(text); }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const { return as_real(value); }
    std::string operator()(Misfit const& misfit) const { return misfit.what; }
    std::string operator()(std::vector<std::string> const& list) const
    {
      return fmt::format("[{}]", joined(list));
    }
  };
  return std::visit(Words{}, value);
}

Complaint not_a(std::string const& kind, Value const& value)
{
  return {fmt::format("found {}, which is not {}", in_words(value), kind), ""};
}

// Reads a number of either kind from a word with `parse`.
template <class Number, class Parse>
std::optional<Complaint> read_word(Word const& word, Number& number, Parse const& parse)
{
  NumberError const error = parse(word.text, number);
  if (error == NumberError::none)
    return {};
  return Complaint{fmt::format("found {}, which {}", in_quotes(word.text), explain(error)), ""};
}

std::optional<Complaint> read_real(Value const& value, double& number)
{
  if (auto const* const word = std::get_if<Word>(&value))
    return read_word(*word, number, parse_decimal);
  if (auto const* const integer = std::get_if<std::int64_t>(&value))
    number = static_cast<double>(*integer);
  else if (auto const* const real = std::get_if<double>(&value))
    number = *real;
  else
    return not_a("a number", value);
  if (!std::isfinite(number))
    return Complaint{fmt::format("found {}, which is not finite", in_words(value)), ""};
  return {};
}

std::optional<Complaint> read_integer(Value const& value, std::int64_t& number)
{
  if (auto const* const word = std::get_if<Word>(&value))
    return read_word(*word, number, parse_integer);
  auto const* const integer = std::get_if<std::int64_t>(&value);
  if (!integer)
    return not_a("an integer", value);
  number = *integer;
  return {};
}

std::string const* text_in(Value const& value)
{
  auto const* const word = std::get_if<Word>(&value);
  return word ? &word->text : std::get_if<std::string>(&value);
}

std::string quoted(std::string const& text)
{
  std::string out = "\"";
  for (char const c : text) {
    auto const byte = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\')
      out += std::string("\\") + c;
    else if (byte < ' ' || byte == 0x7f)
      out += fmt::format("\\u{:04x}", byte);
    else
      out += c;
  }
  return out + "\"";
}

// What `print` makes of a setting that is set.
template <class T, class Print>
std::function<std::string(Settings const&)> printer(std::optional<T> Settings::*member, Print print)
{
  return [member, print](Settings const& s) { return s.*member ? print(*(s.*member)) : ""; };
}

template <class T>
std::function<void(Settings&)> clearer(std::optional<T> Settings::*member)
{
  return [member](Settings& s) { (s.*member).reset(); };
}

/// A key for a number that `is_good` says yes to.
Key real(char const* name, std::optional<double> Settings::*member, std::string const& allowed,
         bool (*is_good)(double), std::string const& rival = "")
{
  auto const read = [=](Settings& s, Value const& value) -> std::optional<Complaint> {
    double number = 0;
    if (auto complaint = read_real(value, number))
      return complaint;
    if (!is_good(number)) {
      auto const* const word = std::get_if<Word>(&value);
      return Complaint{fmt::format("found {}", word ? word->text : shortest(number)), ""};
    }
    s.*member = number;
    return {};
  };
  return {name, allowed, rival, read, printer(member, as_real), clearer(member)};
}

bool anything(double)
{
  return true;
}
bool above_zero(double value)
{
  return value > 0;
}
bool not_negative(double value)
{
  return value >= 0;
}
bool has_reciprocal(double value)
{
  return value > 0 && 1 / value > 0 && std::isfinite(1 / value);
}
bool is_packing(double value)
{
  return value > 0 && value <= densest_packing;
}

Key integer(char const* name, std::optional<std::int64_t> Settings::*member, std::int64_t least,
            std::int64_t most, std::string const& rival = "")
{
  auto const read = [=](Settings& s, Value const& value) -> std::optional<Complaint> {
    std::int64_t number = 0;
    if (auto complaint = read_integer(value, number))
      return complaint;
    if (number < least || number > most)
      return Complaint{fmt::format("found {}", number), ""};
    s.*member = number;
    return {};
  };
  return {name,
          fmt::format("an integer in {}...{}", least, most),
          rival,
          read,
          printer(member, [](std::int64_t value) { return std::to_string(value); }),
          clearer(member)};
}

Key boolean(char const* name, std::optional<bool> Settings::*member)
{
  auto const read = [=](Settings& s, Value const& value) -> std::optional<Complaint> {
    auto const* const word = std::get_if<Word>(&value);
    if (word && (word->text == "true" || word->text == "false"))
      s.*member = word->text == "true";
    else if (auto const* const given = std::get_if<bool>(&value))
      s.*member = *given;
    else
      return Complaint{fmt::format("found {}", in_words(value)), ""};
    return {};
  };
  return {name,
          "true, false",
          "",
          read,
          printer(member, [](bool value) { return std::string(value ? "true" : "false"); }),
          clearer(member)};
}

Key file(char const* name, std::optional<std::string> Settings::*member, char const* allowed,
         std::string const& rival = "")
{
  auto const read = [=](Settings& s, Value const& value) -> std::optional<Complaint> {
    std::string const* const text = text_in(value);
    if (!text)
      return not_a("a text", value);
    if (text->empty())
      return Complaint{"found no name", ""};
    if (*text == "-")
      return Complaint{"found '-'", ""};
    s.*member = *text;
    return {};
  };
  return {name, allowed, rival, read, printer(member, quoted), clearer(member)};
}

/// A key for one of a few names.
template <class T>
Key choice(char const* name, std::optional<T> Settings::*member,
           std::vector<std::pair<std::string, T>> const& choices)
{
  std::vector<std::string> names;
  for (auto const& [word, meaning] : choices)
    names.push_back(word);
  auto const read = [=](Settings& s, Value const& value) -> std::optional<Complaint> {
    std::string const* const text = text_in(value);
    if (!text)
      return not_a("a text", value);
    for (auto const& [word, meaning] : choices)
      if (*text == word) {
        s.*member = meaning;
        return {};
      }
    return Complaint{fmt::format("found {}", in_quotes(*text)), did_you_mean(*text, names)};
  };
  auto const print = [choices](T const& value) {
    for (auto const& [word, meaning] : choices)
      if (meaning == value)
        return quoted(word);
    return std::string();
  };
  return {name, joined(names), "", read, printer(member, print), clearer(member)};
}

template <class T>
std::vector<std::pair<std::string, T>> by_name(std::vector<T> const& list)
{
  std::vector<std::pair<std::string, T>> out;
  for (T const element : list)
    out.emplace_back(name(element), element);
  return out;
}

// The fields of a frame: positions always, velocities perhaps.
Key fields()
{
  auto const read = [](Settings& s, Value const& value) -> std::optional<Complaint> {
    std::vector<std::string> list;
    if (std::string const* const text = text_in(value)) {
      for (std::size_t start = 0; start <= text->size();) {
        std::size_t const end = std::min(text->find(',', start), text->size());
        list.emplace_back(trimmed(text->substr(start, end - start)));
        start = end + 1;
      }
    } else if (auto const* const given = std::get_if<std::vector<std::string>>(&value)) {
      list = *given;
    } else {
      return not_a("a list of texts", value);
    }
    std::vector<std::string> const known{"position", "velocity"};
    for (auto word = list.begin(); word != list.end(); ++word) {
      if (std::find(known.begin(), known.end(), *word) == known.end())
        return Complaint{"found " + in_quotes(*word), did_you_mean(*word, known)};
      if (std::find(list.begin(), word, *word) != word)
        return Complaint{"found " + in_quotes(*word) + " twice", ""};
    }
    if (std::find(list.begin(), list.end(), "position") == list.end())
      return Complaint{"found no position", ""};
    s.velocity = list.size() == 2;
    return {};
  };
  auto const print = [](bool velocity) {
    return std::string(velocity ? R"(["position", "velocity"])" : R"(["position"])");
  };
  return {"output.fields",
          "position; position,velocity",
          "",
          read,
          printer(&Settings::velocity, print),
          clearer(&Settings::velocity)};
}

std::vector<std::pair<std::string, Boundary>> const boundaries{{"walls", Boundary::walls},
                                                               {"periodic", Boundary::periodic}};

// All keys of a scene, in the order in which it is printed.
std::vector<Key> const& keys()
{
  using S = Settings;
  static std::vector<Key> const all{
      real("box.width", &S::width, "a decimal number", anything),
      real("box.height", &S::height, "a decimal number", anything),
      choice("box.x", &S::x, boundaries),
      choice("box.y", &S::y, boundaries),
      real("discs.radius", &S::radius, "a decimal number", anything),
      boolean("discs.relax", &S::relax),
      file("discs.states", &S::states, "the name of a file", "discs.generate"),
      integer("discs.generate.count", &S::count, 0, most_discs, "discs.generate.packing_fraction"),
      real("discs.generate.packing_fraction", &S::packing, "a decimal number > 0 and <= 0.9069",
           is_packing),
      real("discs.generate.temperature", &S::temperature, "a decimal number >= 0", not_negative),
      boolean("discs.generate.zero_momentum", &S::zero_momentum),
      choice<Arrangement>("discs.generate.arrangement", &S::arrangement,
                          {{"random", Arrangement::random},
                           {"square", Arrangement::square},
                           {"triangular", Arrangement::triangular}}),
      integer("discs.generate.seed", &S::seed, 0, std::numeric_limits<std::int64_t>::max()),
      real("forces.gravity", &S::gravity, "a decimal number", anything),
      real("contact.restitution", &S::restitution, "a decimal number", anything),
      real("contact.friction", &S::friction, "a decimal number", anything),
      choice("contact.law", &S::law, by_name<Law>({Law::swap_scale, Law::restitution})),
      boolean("contact.pairs", &S::pairs),
      real("run.duration", &S::duration, "a decimal number >= 0", not_negative),
      integer("run.steps", &S::steps, 0, most_steps, "run.duration"),
      choice<Until>("run.until", &S::until, {{"duration", Until::duration}, {"rest", Until::rest}}),
      real("run.steps_per_time", &S::steps_per_time, "what has a reciprocal", has_reciprocal),
      real("run.dt", &S::dt, "a decimal number > 0", above_zero, "run.steps_per_time"),
      choice("run.engine", &S::engine, by_name(engine_kinds())),
      choice("run.precision", &S::precision,
             by_name<Precision>({Precision::double_, Precision::single_})),
      real("run.measure_from", &S::measure_from, "a decimal number >= 0", not_negative),
      file("output.file", &S::file, "a file; a trajectory cannot go to standard output"),
      integer("output.every", &S::every, 1, most_steps),
      real("output.every_time", &S::every_time, "a decimal number > 0", above_zero, "output.every"),
      fields(),
      boolean("output.float32", &S::float32),
      choice<Compression>("output.compress", &S::compression,
                          {{"auto", Compression::automatic},
                           {"none", Compression::none},
                           {"deflate", Compression::deflate}}),
      file("checkpoint.file", &S::checkpoint, "a file; a checkpoint cannot go to standard output"),
      real("checkpoint.every_seconds", &S::every_seconds, "a decimal number > 0", above_zero),
  };
  return all;
}

std::string section_of(std::string const& key)
{
  std::size_t const dot = key.rfind('.');
  return dot == std::string::npos ? "" : key.substr(0, dot);
}

std::string last_part(std::string const& key)
{
  return key.substr(key.rfind('.') + 1); // npos + 1 is 0
}

Key const* find(std::string const& name)
{
  for (Key const& key : keys())
    if (key.name == name)
      return &key;
  return nullptr;
}

// Whether the two say the same in different ways.
bool are_rivals(Key const& a, Key const& b)
{
  auto const names = [](std::string const& rival, Key const& key) {
    return !rival.empty() && (key.name == rival || section_of(key.name) == rival);
  };
  return names(a.rival, b) || names(b.rival, a);
}

// What stands at an origin, for a message about something else.
std::string place_of(Origin const& origin)
{
  return origin.place ? fmt::format("in line {}", origin.place->line) : "as " + origin.source;
}

} // namespace

std::vector<std::string> const& setting_keys()
{
  static std::vector<std::string> const all = [] {
    std::vector<std::string> names;
    for (Key const& key : keys())
      names.push_back(key.name);
    return names;
  }();
  return all;
}

std::vector<std::string> const& setting_sections()
{
  static std::vector<std::string> const all = [] {
    std::vector<std::string> names;
    for (Key const& key : keys())
      if (std::find(names.begin(), names.end(), section_of(key.name)) == names.end())
        names.push_back(section_of(key.name));
    return names;
  }();
  return all;
}

void report_unknown_key(std::string const& key, Origin const& origin, ProblemList& problems)
{
  std::string const section = section_of(key), word = last_part(key);
  std::vector<std::string> siblings;
  for (std::string const& sibling : setting_keys())
    if (section_of(sibling) == section)
      siblings.push_back(last_part(sibling));
  for (std::string const& table : setting_sections())
    if (section_of(table) == section)
      siblings.push_back(last_part(table));

  std::string hint = did_you_mean(word, siblings);
  // The right word in the wrong table.
  for (std::string const& other : setting_keys())
    if (hint.empty() && last_part(other) == word)
      hint = fmt::format("did you mean '{}'?", other);
  if (siblings.empty()) {
    std::string const table = section.substr(0, section.find('.'));
    return report_unknown_key(table, origin, problems);
  }
  problems.add(origin,
               fmt::format("unknown key {} (allowed{}{}: {})", in_quotes(word),
                           section.empty() ? "" : " in ", section, joined(siblings)),
               hint);
}

bool any_wrong(Settings const& settings, std::vector<std::string> const& beginnings)
{
  return std::any_of(settings.wrong.begin(), settings.wrong.end(), [&](std::string const& key) {
    return std::any_of(beginnings.begin(), beginnings.end(),
                       [&](std::string const& beginning) { return key.rfind(beginning, 0) == 0; });
  });
}

void assign(Settings& settings, std::string const& name, Value const& value, Origin origin,
            ProblemList& problems)
{
  Key const* const key = find(name);
  if (!key) {
    settings.is_partial = true;
    return report_unknown_key(name, origin, problems);
  }

  auto const earlier = settings.origins.find(name);
  if (earlier != settings.origins.end() &&
      earlier->second.place.has_value() == origin.place.has_value())
    return problems.add(origin,
                        fmt::format("found a second time (first {})", place_of(earlier->second)),
                        "keep one of them");

  for (auto const& [other, its_origin] : settings.origins)
    if (are_rivals(*key, *find(other)) && its_origin.place.has_value() == origin.place.has_value())
      return problems.add(origin,
                          fmt::format("found beside {} {} (only one of them can hold)", other,
                                      place_of(its_origin)),
                          "keep one of them");

  if (auto const complaint = key->read(settings, value)) {
    problems.add(origin, fmt::format("{} (allowed: {})", complaint->found, key->allowed),
                 complaint->suggestion);
    settings.wrong.insert(name);
  } else {
    for (Key const& other : keys())
      if (are_rivals(*key, other)) {
        other.clear(settings);
        settings.origins.erase(other.name);
      }
  }
  settings.origins[name] = std::move(origin);
}

std::string as_toml(Settings settings)
{
  if (settings.states) // the same file, wherever this is read
    settings.states = std::filesystem::absolute(*settings.states).lexically_normal().string();
  std::string text, section;
  for (Key const& key : keys()) {
    std::string const value = key.print(settings);
    if (value.empty())
      continue;
    if (section_of(key.name) != section) {
      section = section_of(key.name);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", section);
    }
    text += fmt::format("{} = {}\n", last_part(key.name), value);
  }
  return text;
}

void apply(std::vector<Override> const& overrides, Settings& settings, ProblemList& problems)
{
  for (Override const& setting : overrides)
    assign(settings, setting.key, Word{setting.value},
           {setting.option, std::nullopt, setting.key, setting.value}, problems);
}

std::string shown_name(Settings const& settings, std::string const& key)
{
  auto const name = settings.names.find(key);
  return name == settings.names.end() ? key : name->second;
}

Origin blame(Settings const& settings, std::string const& key,
             std::vector<std::string> const& causes)
{
  auto const own = settings.origins.find(key);
  if (own != settings.origins.end())
    return own->second;
  for (std::string const& cause : causes) {
    auto const origin = settings.origins.find(cause);
    if (origin == settings.origins.end())
      continue;
    Origin at = origin->second;
    at.name = "";
    return at;
  }
  return {settings.scene, Place{}, "", ""};
}

} // namespace ricochet::driver
