// The two fixed-step engines once more: serial, every pair tested, nothing clever.
//
// Written from the description of the model, not from the kernels, with which it shares the
// contact law and nothing else. It is the measure of the engines, bit for bit.
#pragma once

#include "ricochet/engine.hpp"

#include <cstdint>
#include <vector>

namespace ricochet::test {

/// What happened since the start of a run, counted and summed event by event.
struct Books {
  std::int64_t collisions = 0;
  std::int64_t separating_hits = 0;
  std::int64_t wall_hits = 0;
  double max_overlap = 0;     ///< when a contact had its turn [diameters]
  long double lost_pairs = 0; ///< `simultaneous`: half the law's loss for each disc that responds
  long double lost_walls = 0;
  long double numerical = 0;
  /// Sum over collisions of (change of momentum of j) . (x_j - x_i), averaged with the same for i
  /// where the law does not conserve momentum.
  long double virial = 0;
};

/// A run of `engine`, all arithmetic in `Real` (float or double).
template <class Real>
class Reference {
 public:
  Reference(EngineKind engine, Model const& model, double dt,
            std::vector<DiscState> const& initial);

  void advance(std::int64_t steps);

  std::vector<DiscState> states() const;
  Books const& books() const { return books_; }

 private:
  struct Disc {
    Real x, y, vx, vy;
  };

  template <class Law>
  void resolve_pairs_in_order(Law const& law);
  template <class Law>
  void resolve_pairs_simultaneously(Law const& law);
  void note_overlap(Real distance);
  void move();
  void bounce_off_walls();
  void wrap(Disc& disc) const;
  Disc separation(Disc const& from, Disc const& to) const;

  EngineKind engine_;
  Model model_;
  Real radius_, diameter_, gravity_, dt_, width_, height_, half_width_, half_height_;
  std::vector<Disc> discs_;
  Books books_;
};

/// Deepest overlap of any two discs, in diameters; 0 where none overlap. Tests every pair.
double deepest_overlap(Model const& model, std::vector<DiscState> const& discs);

/// Farthest that the edge of any disc is beyond a wall, in diameters; 0 where none is.
double farthest_outside(Model const& model, std::vector<DiscState> const& discs);

/// Sums over the discs, in extended precision.
long double kinetic_energy(std::vector<DiscState> const& discs);
long double potential_energy(Model const& model, std::vector<DiscState> const& discs);
long double momentum_x(std::vector<DiscState> const& discs);
long double momentum_y(std::vector<DiscState> const& discs);

} // namespace ricochet::test
