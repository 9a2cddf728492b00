#include "problem_list.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

namespace ricochet::driver {

void ProblemList::add_line(std::string const& start, std::string const& problem,
                           std::string const& suggestion)
{
  ++count_;
  if (lines_.size() < shown)
    lines_.push_back(
        fmt::format("{}: {}{}{}", start, problem, suggestion.empty() ? "" : " ", suggestion));
}

void ProblemList::add(std::string const& file, Place place, std::string const& problem,
                      std::string const& suggestion)
{
  in_a_file_ = true;
  add_line(fmt::format("{}:{}:{}", file, place.line, place.column), problem, suggestion);
}

void ProblemList::add(Origin const& origin, std::string const& problem,
                      std::string const& suggestion)
{
  if (!origin.place)
    return add_line(origin.source, problem, suggestion);
  add(origin.source, *origin.place,
      origin.name.empty() ? problem : fmt::format("{}: {}", origin.name, problem), suggestion);
}

std::string ProblemList::text() const
{
  std::string out = fmt::format("{}", fmt::join(lines_, "\n"));
  if (count_ > lines_.size())
    out += fmt::format("\nand {} more", count_ - lines_.size());
  return out;
}

void ProblemList::throw_if_any() const
{
  if (empty())
    return;
  if (in_a_file_)
    throw BadScene(text());
  throw Failure(Exit::usage, text());
}

} // namespace ricochet::driver
