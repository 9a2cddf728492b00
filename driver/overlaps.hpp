// Which discs of a list overlap, and moving them until none does. All of it is done by one thread
// of the host, in an order that depends on nothing but the list.
#pragma once

#include "ricochet/model.hpp"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace ricochet::driver {

/// A vector in the plane.
struct Vector {
  double x, y;
};

/// Finds discs near a place, among discs that may be added and moved.
class DiscFinder {
 public:
  /// For up to about `count` discs of `model`.
  DiscFinder(Model const& model, std::size_t count);

  /// Adds the next disc, whose number is the count of those before it.
  void add(Vector position);
  void move(std::size_t disc, Vector position);
  Vector position(std::size_t disc) const { return positions_[disc]; }

  /// From `a` to the nearest image of `b`.
  Vector separation(Vector a, Vector b) const;

  /// The numbers of the discs whose centre is closer to `p` than a diameter, in place of `found`.
  void find_near(Vector p, std::vector<std::size_t>& found) const;

 private:
  struct Axis {
    double length;
    std::int64_t cells;
    bool periodic;
    std::int64_t at(double x) const;
  };

  std::size_t cell(Vector p) const;
  void link(std::size_t disc, std::size_t cell);
  void unlink(std::size_t disc);

  double diameter_;
  Axis x_, y_;
  std::vector<Vector> positions_;
  // The discs of each cell as a list in both directions; -1 ends it.
  std::vector<std::int32_t> first_, next_, previous_;
  std::vector<std::size_t> cell_;
};

/// The overlaps of a list of discs.
struct Overlaps {
  std::int64_t pairs = 0;
  double deepest = 0;            ///< [length]
  std::size_t first = 0, second; ///< of the deepest
  std::int64_t outside = 0;      ///< discs that poke through a wall
};

/// Overlaps deeper than rounding makes those of discs that touch.
Overlaps find_overlaps(Model const& model, std::vector<DiscState> const& discs);

/// What relax() did.
struct Relaxation {
  std::int64_t moved = 0;  ///< discs
  double farthest = 0;     ///< any was moved [length]
  std::size_t disc = 0;    ///< which
  std::int64_t passes = 0; ///< over all discs
  Overlaps left;           ///< those that remain, if it did not succeed
};

/// Separates discs that overlap each other or a wall: over and over, in the order of their numbers,
/// overlapping discs are pushed apart by half of their overlap each. Velocities stay.
Relaxation relax(Model const& model, std::vector<DiscState>& discs);

} // namespace ricochet::driver
