// Words and numbers: reading them strictly, printing them exactly.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace ricochet::driver {

/// Why a word is not the number that was asked for.
enum class NumberError {
  none,
  empty,
  not_a_number,
  not_an_integer,
  hexadecimal,
  not_finite,
  range
};

/// Reads a decimal number such as -1.5 or 2e3; the whole of `word` must be one.
NumberError parse_decimal(std::string_view word, double& value);

/// Reads a decimal integer; the whole of `word` must be one.
NumberError parse_integer(std::string_view word, std::int64_t& value);

/// "is not a decimal number" and the like.
char const* explain(NumberError error);

/// `word` in quotes, shortened, with unprintable bytes as \xNN.
std::string in_quotes(std::string_view word);

/// `text` without white space at either end.
std::string_view trimmed(std::string_view text);

/// True for the characters that separate records: blank, tab and the line ends.
constexpr bool is_space(char c)
{
  return c == ' ' || (c >= '\t' && c <= '\r');
}

/// The shortest decimal form that reads back as the same double.
std::string shortest(double value);

/// Appends shortest(value) to `out`.
void append_shortest(std::string& out, double value);

/// "did you mean 'alpha'?" if one of `known` is close to `word`, else "".
std::string did_you_mean(std::string_view word, std::vector<std::string> const& known);

/// `argument` as a shell would take it back.
std::string for_shell(std::string const& argument);

/// The words of `list` with ", " between them.
std::string joined(std::vector<std::string> const& list);

} // namespace ricochet::driver
