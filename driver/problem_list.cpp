#include "problem_list.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

namespace ricochet::driver {

void ProblemList::add(std::string const& file, Place place, std::string const& problem,
                      std::string const& suggestion)
{
  add(Origin{file, place, "", ""}, problem, suggestion);
}

void ProblemList::add(Origin const& origin, std::string const& problem,
                      std::string const& suggestion)
{
  ++count_;
  if (lines_.size() >= shown)
    return;
  std::string text = origin.source;
  if (origin.place)
    text += fmt::format(":{}:{}", origin.place->line, origin.place->column);
  if (origin.place && !origin.name.empty())
    text += ": " + origin.name;
  text += ": " + problem + (suggestion.empty() ? "" : " ") + suggestion;

  // After all that come before it in its file.
  auto const at = std::find_if(lines_.begin(), lines_.end(), [&](Line const& line) {
    return origin.place && line.place && line.source == origin.source &&
           std::pair(origin.place->line, origin.place->column) <
               std::pair(line.place->line, line.place->column);
  });
  lines_.insert(at, {origin.source, origin.place, text});
}

std::string ProblemList::text() const
{
  std::string out;
  for (Line const& line : lines_)
    out += (out.empty() ? "" : "\n") + line.text;
  if (count_ > lines_.size())
    out += fmt::format("\nand {} more", count_ - lines_.size());
  return out;
}

void ProblemList::throw_if_any() const
{
  if (empty())
    return;
  if (std::any_of(lines_.begin(), lines_.end(),
                  [](Line const& line) { return line.place.has_value(); }))
    throw BadScene(text());
  throw Failure(Exit::usage, text());
}

} // namespace ricochet::driver
