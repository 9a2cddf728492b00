#include "variation.hpp"

#include "exit_codes.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

constexpr char const* seed_key = "discs.generate.seed";

[[noreturn]] void wrong(std::string const& message)
{
  throw Failure(Exit::usage, message);
}

/// A..B, as it is written.
struct Range {
  std::string first, last;

  // Between the ends with 15 digits, which those decimals survive that have no more.
  std::string value(std::int64_t member, std::int64_t members) const
  {
    if (member == 0 || member == members - 1)
      return member == 0 ? first : last;
    double a = 0, b = 0;
    parse_decimal(first, a);
    parse_decimal(last, b);
    auto const k = static_cast<double>(member), n = static_cast<double>(members - 1);
    double const value = (a * (n - k) + b * k) / n;
    bool const is_integer = value == std::floor(value) && std::fabs(value) < 1e15;
    return is_integer ? fmt::format("{:.0f}", value) : fmt::format("{:.15g}", value);
  }
};

std::optional<Range> range_in(std::string const& text)
{
  std::size_t const dots = text.find("..");
  if (dots == std::string::npos)
    return std::nullopt;
  std::string const first(trimmed(text.substr(0, dots)));
  std::string const last(trimmed(text.substr(dots + 2)));
  double number = 0;
  if (parse_decimal(first, number) != NumberError::none ||
      parse_decimal(last, number) != NumberError::none)
    return std::nullopt; // a list of paths may have dots
  return Range{first, last};
}

std::vector<std::string> list_in(std::string const& text)
{
  std::vector<std::string> values;
  for (std::size_t start = 0; start <= text.size();) {
    std::size_t const end = std::min(text.find(',', start), text.size());
    values.emplace_back(trimmed(text.substr(start, end - start)));
    start = end + 1;
  }
  return values;
}

bool counts_up(Override const& setting)
{
  return setting.key == seed_key && setting.value == "seed";
}

// How many members there are, as the lists say.
std::int64_t length_of_lists(std::vector<Override> const& vary)
{
  for (Override const& setting : vary)
    if (!counts_up(setting) && !range_in(setting.value))
      return static_cast<std::int64_t>(list_in(setting.value).size());
  wrong("--members: missing (a range and seeds do not say how many members there are) add "
        "--members N");
}

} // namespace

std::vector<Variation> variations(std::vector<Override> const& vary,
                                  std::optional<std::int64_t> members, std::int64_t seed)
{
  if (vary.empty())
    wrong("nothing varies, so that all members would be the same: add --vary seed, or --vary "
          "section.key=VALUES");
  std::int64_t const count = members ? *members : length_of_lists(vary);
  std::vector<Variation> all;
  for (Override const& setting : vary) {
    Variation variation{setting.option, setting.key, {}};
    auto const range = range_in(setting.value);
    if (!counts_up(setting) && !range)
      variation.values = list_in(setting.value);
    else
      for (std::int64_t k = 0; k < count; ++k)
        variation.values.push_back(range ? range->value(k, count)
                                         : std::to_string(static_cast<std::uint64_t>(seed) +
                                                          static_cast<std::uint64_t>(k)));
    if (variation.values.size() != static_cast<std::size_t>(count))
      wrong(fmt::format("{}: found {} value{} for {} members (allowed: a value for each, A,B,C; "
                        "evenly spaced ones, A..B)",
                        setting.option, variation.values.size(),
                        variation.values.size() == 1 ? "" : "s", count));
    all.push_back(std::move(variation));
  }
  return all;
}

} // namespace ricochet::driver
