// The scheme of engine `toi` once more: serial, every pair tested in every round, nothing clever.
//
// Written from the description in kernels/README.md, with which the engine must agree bit for bit.
// It shares the contact law with the kernels and nothing else.
#pragma once

#include "ricochet/engine.hpp"

#include <cstdint>
#include <vector>

namespace ricochet::test {

/// A run of engine `toi`, all arithmetic in `Real` (float or double).
template <class Real>
class ToiReference {
 public:
  struct Books {
    std::int64_t collisions = 0, wall_hits = 0;
    long double lost_pairs = 0, lost_walls = 0, numerical = 0;
    int longest_step = 0; ///< rounds
  };

  ToiReference(Model const& model, double dt, std::vector<DiscState> const& initial);

  void advance(std::int64_t steps);

  std::vector<DiscState> states() const;
  Books const& books() const { return books_; }

 private:
  static constexpr int nobody = -1, wall_x = -2, wall_y = -3;

  /// In the frame that falls: the line p + t w, valid from `since` on.
  struct Disc {
    Real px, py, wx, wy;
    Real since = 0;
    int met = nobody;
    int rests = 0; ///< 1, -1: on the ceiling, on the floor
  };
  struct Event {
    Real time;
    int with;
  };
  /// In the lab.
  struct Motion {
    Real x, y, vx, vy;
  };

  void step();
  int images(Real length) const;
  Event next_event(int i) const;
  Event next_wall(Disc const& disc) const;
  Real meeting(int i, int j) const;
  Real nearest_x(Real d) const;
  Real nearest_y(Real d) const;
  Motion motion(Disc const& disc, Real t) const;
  void set_line(Disc& disc, Motion const& now, Real t, int met) const;
  template <class Law>
  void collide(int i, int j, Real t, Law const& law);
  void bounce(Disc& disc, Event const& event);
  void land(Disc& disc);

  Model model_;
  Real dt_, g_, alpha_, beta_, diameter_, most_x_, most_y_, width_, height_;
  bool walls_x_, walls_y_;
  int images_x_ = 0, images_y_ = 0; ///< on either side, that two discs may meet through in a step
  std::vector<Disc> discs_;
  Books books_;
};

} // namespace ricochet::test
