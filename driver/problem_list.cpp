#include "problem_list.hpp"

#include "exit_codes.hpp"

#include <fmt/format.h>

namespace ricochet::driver {

void ProblemList::add(std::string const& file, Place place, std::string const& problem,
                      std::string const& suggestion)
{
  ++count_;
  if (lines_.size() < shown)
    lines_.push_back(fmt::format("{}:{}:{}: {}{}{}", file, place.line, place.column, problem,
                                 suggestion.empty() ? "" : " ", suggestion));
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
  if (!empty())
    throw BadScene(text());
}

} // namespace ricochet::driver
