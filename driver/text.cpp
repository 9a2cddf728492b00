#include "text.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace ricochet::driver {

namespace {

char lower(char c)
{
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// `word` without the sign that std::from_chars would refuse.
std::string_view without_plus(std::string_view word)
{
  bool const plus = word.size() > 1 && word[0] == '+' && word[1] != '-' && word[1] != '+';
  return plus ? word.substr(1) : word;
}

// Why std::from_chars did not read the whole of `word`.
NumberError diagnose(std::string_view word)
{
  if (word.empty())
    return NumberError::empty;
  std::string name;
  for (char const c : word)
    if (c != '+' && c != '-')
      name += lower(c);
  if (name.rfind("0x", 0) == 0)
    return NumberError::hexadecimal;
  if (name.rfind("nan", 0) == 0 || name.rfind("inf", 0) == 0)
    return NumberError::not_finite;
  return NumberError::not_a_number;
}

// Number of edits (insert, delete, replace, swap of neighbours) that turn `a` into `b`.
std::size_t edit_distance(std::string_view a, std::string_view b)
{
  std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i)
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        d[i][j] = i + j;
        continue;
      }
      bool const same = lower(a[i - 1]) == lower(b[j - 1]);
      d[i][j] = std::min({d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (same ? 0 : 1)});
      if (i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) &&
          lower(a[i - 2]) == lower(b[j - 1]))
        d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
    }
  return d[a.size()][b.size()];
}

} // namespace

NumberError parse_decimal(std::string_view word, double& value)
{
  std::string_view const digits = without_plus(word);
  char const* const end = digits.data() + digits.size();
  auto const [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end)
    return NumberError::range;
  if (error != std::errc{} || stop != end)
    return diagnose(word);
  return std::isfinite(value) ? NumberError::none : NumberError::not_finite;
}

NumberError parse_integer(std::string_view word, std::int64_t& value)
{
  std::string_view const digits = without_plus(word);
  char const* const end = digits.data() + digits.size();
  auto const [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::result_out_of_range && stop == end)
    return NumberError::range;
  if (error == std::errc{} && stop == end)
    return NumberError::none;
  double real = 0;
  NumberError const as_real = parse_decimal(word, real);
  return as_real == NumberError::none ? NumberError::not_an_integer : as_real;
}

char const* explain(NumberError error)
{
  switch (error) {
  case NumberError::none:
    return "is a number";
  case NumberError::empty:
    return "is missing";
  case NumberError::not_a_number:
    return "is not a decimal number";
  case NumberError::not_an_integer:
    return "is not an integer";
  case NumberError::hexadecimal:
    return "is hexadecimal";
  case NumberError::not_finite:
    return "is not finite";
  case NumberError::range:
    return "is out of the range of numbers";
  }
  return "";
}

std::string in_quotes(std::string_view word)
{
  constexpr std::size_t longest = 40;
  std::string out = "'";
  for (char const c : word.substr(0, longest)) {
    auto const byte = static_cast<unsigned char>(c);
    if (byte >= ' ' && byte != 0x7f && byte < 0x80) {
      out += c;
      continue;
    }
    char escaped[5];
    std::snprintf(escaped, sizeof escaped, "\\x%02x", byte);
    out += escaped;
  }
  return out + (word.size() > longest ? "...'" : "'");
}

std::string_view trimmed(std::string_view text)
{
  while (!text.empty() && is_space(text.front()))
    text.remove_prefix(1);
  while (!text.empty() && is_space(text.back()))
    text.remove_suffix(1);
  return text;
}

void append_shortest(std::string& out, double value)
{
  char digits[32];
  auto const end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out.append(digits, end);
}

std::string shortest(double value)
{
  std::string out;
  append_shortest(out, value);
  return out;
}

std::string did_you_mean(std::string_view word, std::vector<std::string> const& known)
{
  std::size_t best = word.size() / 3 + 2; // more edits than that are a different word
  std::string name;
  for (std::string const& candidate : known) {
    std::size_t const edits = edit_distance(word.substr(0, 64), candidate);
    if (edits < best && edits < candidate.size()) {
      best = edits;
      name = candidate;
    }
  }
  return name.empty() ? "" : "did you mean '" + name + "'?";
}

std::string joined(std::vector<std::string> const& list)
{
  std::string out;
  for (std::string const& word : list)
    out += (out.empty() ? "" : ", ") + word;
  return out;
}

std::string for_shell(std::string const& argument)
{
  std::string const plain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./,:@%";
  if (!argument.empty() && argument.find_first_not_of(plain) == std::string::npos)
    return argument;
  std::string out = "'";
  for (char const c : argument)
    out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return out + "'";
}

} // namespace ricochet::driver
