// Everything that is wrong with the input files, to be told at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace ricochet::driver {

/// A place in a text file, both counted from 1; columns count bytes.
struct Place {
  std::int64_t line = 1;
  std::int64_t column = 1;
};

/// Collects problems in the form FILE:LINE:COLUMN: problem (why) suggestion.
class ProblemList {
 public:
  static constexpr std::size_t shown = 20; ///< the others are only counted

  void add(std::string const& file, Place place, std::string const& problem,
           std::string const& suggestion = "");

  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }

  /// One problem a line, without a line end at the end.
  std::string text() const;

  /// Throws BadScene with text() unless empty.
  void throw_if_any() const;

 private:
  std::vector<std::string> lines_;
  std::size_t count_ = 0;
};

} // namespace ricochet::driver
