// What plots show: tables of numbers made from a trajectory.
#pragma once

#include "pictures/look.hpp"

#include <string>
#include <vector>

namespace ricochet::driver {

class TrajectoryReader;

/// Columns with names; numbers that are not known are NaN.
struct Table {
  std::string name;
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
};

/// The table as CSV with a line of names.
std::string as_csv(Table const& table);

/// "time": the observables of all frames.
Table observables_table(TrajectoryReader const& file);

/// Sums over frames; all frames count alike.
class Statistics {
 public:
  /// The frames will have speeds up to about stage.fast.
  explicit Statistics(Stage const& stage);

  void add(std::vector<DiscState> const& discs);

  /// "speeds": share of the discs per speed, and Maxwell's v/T exp(-v^2/2T) for the same
  /// temperature.
  Table speeds() const;
  /// "heights": share of the area that discs cover, by y of their centres.
  Table heights() const;
  /// "pairs": g(r), the density of discs at distance r from a disc over that in the box, r in
  /// diameters. Discs so near to a wall that part of their surroundings is beyond it are left out.
  Table pairs() const;

 private:
  void add_pairs(std::vector<DiscState> const& discs);
  bool is_far_from_walls(DiscState const& disc) const;

  Stage stage_;
  double frames_ = 0, discs_ = 0, squares_ = 0;  ///< sums; squares of the speeds
  double centres_ = 0;                           ///< of the pairs
  double farthest_;                              ///< distance of pairs
  std::vector<double> speeds_, heights_, pairs_; ///< counts
};

} // namespace ricochet::driver
