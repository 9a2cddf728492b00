// ricochet compare: how far two results are apart.
#pragma once

#include "command_line.hpp"
#include "exit_codes.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace ricochet::driver {

struct Comparison {
  /// The largest deviation of one component of one field, and where it is.
  struct Deviation {
    std::string component; ///< "x", "vy"
    double largest = 0;
    std::int64_t step = 0;
    std::int64_t disc = 0;
    double a = 0, b = 0;
  };

  std::vector<std::string> mismatches; ///< what could not be compared, each a sentence
  std::vector<std::string> notes;      ///< what was left out on purpose
  std::int64_t frames = 0;             ///< compared
  std::int64_t discs = 0;
  bool has_steps = false;        ///< frames are known by their steps
  std::int64_t first_beyond = 0; ///< step of the first frame beyond the tolerance
  std::vector<Deviation> deviations;

  bool within(double tolerance) const;
};

/// Compares frames of the same step of two trajectories, or two states; states compare with the
/// last frame of a trajectory.
Comparison compare_files(std::string const& a, std::string const& b, double tolerance);

/// |a - b|; 0 for equal numbers, infinities and NaNs; infinity if only one is finite.
double deviation(double a, double b);

/// Runs the command.
Exit compare(CompareOptions const& options);

} // namespace ricochet::driver
