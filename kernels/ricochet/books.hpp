// The books of a run: what happened, and where the energy went.
#pragma once

#include "ricochet/exact_sum.hpp"
#include "ricochet/vec2.hpp"

namespace ricochet {

/// Fixed-point scales of a run's sums; see exact_sum.hpp.
struct Scales {
  double energy = 1;
  double momentum = 1;
  double virial = 1;
};

/// Counts, sums and extremes over any part of a run. Merging is commutative and associative to the
/// bit, so kernels may reduce it in any order.
struct Books {
  ExactSum lost_pairs;
  ExactSum lost_walls;
  ExactSum numerical;
  ExactSum virial; ///< sum over collisions of (change of momentum . separation)
  std::int64_t collisions = 0;
  std::int64_t separating_hits = 0;
  std::int64_t wall_hits = 0;
  double max_overlap = 0; ///< [diameters]
  double max_outside = 0; ///< [diameters]

  KOKKOS_INLINE_FUNCTION void merge(Books const& other)
  {
    lost_pairs.merge(other.lost_pairs);
    lost_walls.merge(other.lost_walls);
    numerical.merge(other.numerical);
    virial.merge(other.virial);
    collisions += other.collisions;
    separating_hits += other.separating_hits;
    wall_hits += other.wall_hits;
    max_overlap = max_overlap < other.max_overlap ? other.max_overlap : max_overlap;
    max_outside = max_outside < other.max_outside ? other.max_outside : max_outside;
  }
};

/// Calls visit(name, number) for every number of `books`.
template <class Visit>
void visit_numbers(Books& books, Visit const& visit)
{
  books.lost_pairs.visit_numbers("lost_pairs", visit);
  books.lost_walls.visit_numbers("lost_walls", visit);
  books.numerical.visit_numbers("numerical", visit);
  books.virial.visit_numbers("virial", visit);
  visit("collisions", books.collisions);
  visit("separating_hits", books.separating_hits);
  visit("wall_hits", books.wall_hits);
  visit("max_overlap", books.max_overlap);
  visit("max_outside", books.max_outside);
}

/// Kinetic energy of a disc of unit mass.
template <class Real>
KOKKOS_INLINE_FUNCTION double kinetic_energy(Vec2<Real> velocity)
{
  auto const v = as<double>(velocity);
  return 0.5 * dot(v, v);
}

template <class Space>
using BooksView = Kokkos::View<Books, Space>;

/// Adds what one kernel reported to the books of the run.
template <class Space>
void enter(Space const& space, BooksView<Space> const& run, BooksView<Space> const& part)
{
  Kokkos::parallel_for(
      "ricochet::enter_in_books", Range<Space>(space, 0, 1),
      KOKKOS_LAMBDA(int) { run().merge(part()); });
}

} // namespace ricochet
