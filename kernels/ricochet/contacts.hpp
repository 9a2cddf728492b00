// Looks at a state: which discs overlap, how deeply, and how far any is beyond a wall.
#pragma once

#include "ricochet/books.hpp"
#include "ricochet/contact_law.hpp"
#include "ricochet/neighbours.hpp"

namespace ricochet {

/// What kinds of partners a disc overlaps, as bits.
namespace contact {
constexpr int none = 0;
constexpr int with_lower_id = 1;
constexpr int with_higher_id = 2;
} // namespace contact

template <class Space>
using ContactFlags = Kokkos::View<int*, typename Space::memory_space>;

/// Distance beyond the walls [length]; negative inside. A periodic axis has no walls.
struct Outside {
  double high_x, high_y, radius;

  explicit Outside(Model const& model)
    : high_x(model.box.x == Boundary::walls ? model.box.width / 2
                                            : std::numeric_limits<double>::infinity()),
      high_y(model.box.y == Boundary::walls ? model.box.height / 2
                                            : std::numeric_limits<double>::infinity()),
      radius(model.radius)
  {
  }

  template <class Real>
  KOKKOS_INLINE_FUNCTION double operator()(Vec2<Real> p) const
  {
    double const beyond_x = fabs(static_cast<double>(p.x)) + radius - high_x;
    double const beyond_y = fabs(static_cast<double>(p.y)) + radius - high_y;
    return beyond_x > beyond_y ? beyond_x : beyond_y;
  }
};

/// Flags every disc that overlaps another, and reports the extremes of the state.
template <class Space, class Real, bool periodic>
struct FindContacts {
  Discs<Space, Real> discs;
  Neighbours<Space, Real, periodic> neighbours; ///< closer than a diameter
  Outside outside;
  Real diameter;
  ContactFlags<Space> contacts; ///< by id, all none before

  KOKKOS_INLINE_FUNCTION void operator()(int i, Books& books) const
  {
    auto const p = discs.position(i);
    int const id = discs.id(i);
    Real const reach = diameter * diameter;
    Real nearest = reach;
    // Each pair is met once, from the slot that comes first.
    neighbours.for_each_from(p, i + 1, [&](int k, Vec2<Real> d) {
      bool const k_is_higher = discs.id(k) > id;
      flag(k_is_higher ? id : discs.id(k), contact::with_higher_id);
      flag(k_is_higher ? discs.id(k) : id, contact::with_lower_id);
      Real const distance2 = dot(d, d);
      nearest = distance2 < nearest ? distance2 : nearest;
    });
    double const size = static_cast<double>(diameter);
    if (nearest < reach) {
      double const overlap = (size - sqrt(static_cast<double>(nearest))) / size;
      books.max_overlap = overlap > books.max_overlap ? overlap : books.max_overlap;
    }
    double const beyond = outside(p) / size;
    books.max_outside = beyond > books.max_outside ? beyond : books.max_outside;
  }

  /// Bits that are set in any order are the same in the end.
  KOKKOS_INLINE_FUNCTION void flag(int id, int kind) const
  {
    Kokkos::atomic_fetch_or(&contacts(id), kind);
  }
};

/// What the pair step of a fixed-step engine works on: a state sorted into cells, its overlaps
/// flagged, and the constants of the run.
template <class Space, class Real, bool periodic>
struct PairState {
  Discs<Space, Real> discs;
  Cells<Space> cells;
  Domain<Real, periodic> domain;
  Neighbours<Space, Real, periodic> neighbours; ///< closer than a diameter
  typename CellGrid<Space, Real>::Ints slot_of_id;
  ContactFlags<Space> contacts; ///< by id
  Real diameter;
  double gravity;
  Scales scales;
  BooksView<Space> books; ///< of the run
};

/// Enters what the contact law did to a pair whose centres are `separation` apart.
template <class Real>
KOKKOS_INLINE_FUNCTION void enter_collision(PairVelocity<Real> const& before,
                                            PairVelocity<Real> const& after, Vec2<Real> separation,
                                            Scales const& scales, Books& books)
{
  books.lost_pairs.add((kinetic_energy(before.first) + kinetic_energy(before.second)) -
                           (kinetic_energy(after.first) + kinetic_energy(after.second)),
                       scales.energy);
  // Half the difference of the two kicks: each of them where the law conserves momentum.
  auto const kick = (as<double>(after.second) - as<double>(before.second)) -
                    (as<double>(after.first) - as<double>(before.first));
  books.virial.add(0.5 * dot(kick, as<double>(separation)), scales.virial);
}

} // namespace ricochet
