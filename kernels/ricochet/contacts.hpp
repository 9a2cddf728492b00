// What a pair step works on, and what is noted about contacts.
#pragma once

#include "ricochet/books.hpp"
#include "ricochet/cell_grid.hpp"
#include "ricochet/contact_law.hpp"
#include "ricochet/neighbours.hpp"
#include "ricochet/walls.hpp"

namespace ricochet {

/// A state sorted into cells, and the constants of the run.
template <class Space, class Real, bool periodic>
struct PairState {
  using Ints = typename CellGrid<Space, Real>::Ints;

  Discs<Space, Real> discs;
  Discs<Space, Real> spare; ///< memory for as many, of no meaning yet, with the same ids
  Ints cell;                ///< where each disc is stored, by slot
  Cells<Space> cells;
  Domain<Real, periodic> domain;
  Box box;
  Real diameter;
  double gravity;
  Scales scales;
  BooksView<Space> books; ///< of the run

  /// The search among the discs, or among others in the same slots.
  Neighbours<Space, Real, periodic> neighbours() const { return {discs, cells, box}; }
  Neighbours<Space, Real, periodic> neighbours_among(Discs<Space, Real> const& others) const
  {
    return {others, cells, box};
  }
};

/// Depth of the overlap of two discs `distance` apart [diameters].
template <class Real>
KOKKOS_INLINE_FUNCTION double overlap(Real distance, Real diameter)
{
  double const size = static_cast<double>(diameter);
  return (size - static_cast<double>(distance)) / size;
}

/// What a collision adds to the virial: (change of momentum) . (separation of the centres).
/// The change is half the difference of the two kicks: each of them where the law conserves
/// momentum.
template <class Real>
KOKKOS_INLINE_FUNCTION double virial_of(PairVelocity<Real> const& before,
                                        PairVelocity<Real> const& after, Vec2<Real> separation)
{
  auto const kick = (as<double>(after.second) - as<double>(before.second)) -
                    (as<double>(after.first) - as<double>(before.first));
  return 0.5 * dot(kick, as<double>(separation));
}

/// Kinetic energy that a collision takes out of a pair.
template <class Real>
KOKKOS_INLINE_FUNCTION double energy_lost(PairVelocity<Real> const& before,
                                          PairVelocity<Real> const& after)
{
  return (kinetic_energy(before.first) + kinetic_energy(before.second)) -
         (kinetic_energy(after.first) + kinetic_energy(after.second));
}

/// Enters the deepest overlap of a sorted state in the books.
template <class Space, class Real, bool periodic>
struct EnterOverlaps {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours;

  KOKKOS_INLINE_FUNCTION void operator()(int slot, Books& books) const
  {
    Real const reach2 = state.diameter * state.diameter;
    neighbours.for_each_ahead(state.cell(slot), slot, reach2, [&](int, Vec2<Real> d) {
      double const depth = overlap(static_cast<Real>(sqrt(dot(d, d))), state.diameter);
      books.max_overlap = depth > books.max_overlap ? depth : books.max_overlap;
    });
  }
};

} // namespace ricochet
