#include "scene_toml.hpp"

#include "input_file.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

namespace ricochet::driver {

namespace {

Place place_of(toml::source_region const& region)
{
  return {static_cast<std::int64_t>(region.begin.line),
          static_cast<std::int64_t>(region.begin.column)};
}

Value value_of(toml::node const& node)
{
  if (auto const* const value = node.as_boolean())
    return value->get();
  if (auto const* const value = node.as_integer())
    return std::int64_t{value->get()};
  if (auto const* const value = node.as_floating_point())
    return value->get();
  if (auto const* const value = node.as_string())
    return value->get();
  if (auto const* const array = node.as_array()) {
    std::vector<std::string> texts;
    for (toml::node const& element : *array)
      if (auto const* const text = element.as_string())
        texts.push_back(text->get());
    return texts.size() == array->size() ? Value(std::move(texts)) : Value(Misfit{"a list"});
  }
  return Misfit{node.is_table() ? "a table" : "a date or time"};
}

// A key with its value, or what stands in place of a table.
struct Entry {
  std::string key;
  Place key_place, value_place;
  Value value;
  bool is_section = false; ///< `key` should have been a table
};

void collect(toml::table const& table, std::string const& prefix, std::vector<Entry>& entries)
{
  auto const& sections = setting_sections();
  for (auto const& [name, node] : table) {
    std::string const key = prefix + std::string(name.str());
    bool const is_section = std::any_of(sections.begin(), sections.end(), [&](auto const& section) {
      return section == key || section.rfind(key + ".", 0) == 0;
    });
    if (is_section && node.is_table())
      collect(*node.as_table(), key + ".", entries);
    else
      entries.push_back(
          {key, place_of(name.source()), place_of(node.source()), value_of(node), is_section});
  }
}

// The text with line `line` empty.
std::string without_line(std::string text, std::int64_t line)
{
  std::size_t start = 0;
  for (; line > 1 && start != std::string::npos; --line)
    start = text.find('\n', start) + 1;
  std::size_t const end = std::min(text.find('\n', start), text.size());
  return text.replace(start, end - start, "");
}

bool is_header(std::string const& text, std::int64_t line)
{
  std::size_t start = 0;
  for (; line > 1; --line)
    start = text.find('\n', start) + 1;
  start = text.find_first_not_of(" \t", start);
  return start != std::string::npos && text[start] == '[';
}

// The table in `text`. A line that is not TOML is told of, and left out to find what else is wrong.
toml::table parse_toml(std::string const& path, std::string text, ProblemList& problems,
                       bool& is_partial)
{
  Place last{0, 0};
  for (;;) {
    try {
      return toml::parse(text, path);
    } catch (toml::parse_error const& error) {
      is_partial = true;
      Place const place = place_of(error.source());
      // What follows from the first mistake is not worth telling.
      if (place.line <= last.line)
        return {};
      std::string_view why = error.description();
      std::string_view const opening = "Error while ";
      if (why.substr(0, opening.size()) == opening)
        why.remove_prefix(opening.size());
      problems.add(path, place, fmt::format("not TOML ({})", why));
      if (is_header(text, place.line))
        return {};
      text = without_line(std::move(text), place.line);
      last = place;
    }
  }
}

} // namespace

Settings parse_scene(std::string const& path, std::string const& text, ProblemList& problems)
{
  Settings settings;
  settings.scene = path;

  std::vector<Entry> entries;
  collect(parse_toml(path, text, problems, settings.is_partial), "", entries);
  std::sort(entries.begin(), entries.end(), [](Entry const& a, Entry const& b) {
    return std::pair(a.key_place.line, a.key_place.column) <
           std::pair(b.key_place.line, b.key_place.column);
  });
  auto const& keys = setting_keys();
  for (Entry const& entry : entries) {
    Origin origin{path, entry.value_place, entry.key, ""};
    if (entry.is_section) {
      settings.is_partial = true;
      problems.add(origin, "found no table (its keys stand below [" + entry.key + "])");
    } else if (std::find(keys.begin(), keys.end(), entry.key) == keys.end()) {
      settings.is_partial = true;
      origin.place = entry.key_place;
      origin.name = "";
      report_unknown_key(entry.key, origin, problems);
    } else {
      assign(settings, entry.key, entry.value, origin, problems);
    }
  }
  if (settings.states)
    settings.states = (std::filesystem::path(path).parent_path() / *settings.states).string();
  return settings;
}

Settings read_scene_toml(std::string const& path, ProblemList& problems)
{
  constexpr std::size_t longest = 1 << 20; // a scene is a page
  auto const text = read_text(path, longest);
  if (text)
    return parse_scene(path, *text, problems);
  problems.add(path, {}, fmt::format("found more than {} bytes (a scene is a page)", longest),
               "put discs into a STATES.csv and name it in discs.states");
  return {};
}

} // namespace ricochet::driver
