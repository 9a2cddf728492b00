// Everything that is wrong with a scene, to be told at once.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// A place in a text file, both counted from 1; columns count bytes.
struct Place {
  std::int64_t line = 1;
  std::int64_t column = 1;
};

/// Where a setting stands, and as what.
struct Origin {
  std::string source;         ///< the file, or the option on the command line, such as "--dt"
  std::optional<Place> place; ///< in the file; none on the command line
  std::string name;           ///< how the setting is called in the file
  std::string found;          ///< its value there
};

/// Collects problems in the form FILE:LINE:COLUMN: problem (why) suggestion, or --option: problem
/// (why) suggestion; those of a file in the order of their places.
class ProblemList {
 public:
  static constexpr std::size_t shown = 20; ///< the others are only counted

  void add(std::string const& file, Place place, std::string const& problem,
           std::string const& suggestion = "");
  void add(Origin const& origin, std::string const& problem, std::string const& suggestion = "");

  bool empty() const { return count_ == 0; }
  std::size_t count() const { return count_; }

  /// One problem a line, without a line end at the end.
  std::string text() const;

  /// Throws Failure with text() unless empty: BadScene if a file has a share in it, else
  /// Exit::usage.
  void throw_if_any() const;

 private:
  struct Line {
    std::string source;
    std::optional<Place> place;
    std::string text;
  };

  std::vector<Line> lines_;
  std::size_t count_ = 0;
};

} // namespace ricochet::driver
