// The pair step of engine `simultaneous`: the original's parallel variant.
//
// Every disc looks at the old state of all others in order of id; each overlapping partner's
// result, computed from the old states, replaces the previous one, so the last wins; only the
// disc's own velocity is kept and no overlap is removed. A partner in exactly the same state is
// skipped, and a result equal to the old velocity replaces nothing. This is not an approximation of
// anything: discs that stay overlapped swap again every step, and copies of velocities create
// energy.
#pragma once

#include "ricochet/contact_law.hpp"
#include "ricochet/contacts.hpp"

namespace ricochet {

/// Each disc takes its result from its last partner, which is the one with the highest id.
template <class Space, class Real, class LawType, bool periodic>
struct LastPartnerWins {
  PairState<Space, Real, periodic> state;
  Neighbours<Space, Real, periodic> neighbours;
  LawType law;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Books& books) const
  {
    auto const& discs = state.discs;
    auto const p = discs.position(i);
    auto const v = discs.velocity(i);
    int const id = discs.id(i);
    state.spare.set_velocity(i, v);

    int last = -1;
    PairVelocity<Real> before{v, v}, after{v, v};
    Vec2<Real> separation{0, 0};
    Real const reach2 = state.diameter * state.diameter;
    neighbours.for_each_around(state.cell(i), p, reach2, [&](int k, Vec2<Real> d) {
      if (k == i)
        return;
      Real const distance = sqrt(dot(d, d));
      double const depth = overlap(distance, state.diameter);
      books.max_overlap = depth > books.max_overlap ? depth : books.max_overlap;
      if (discs.position(k) == p && discs.velocity(k) == v)
        return; // discs in the same state ignore each other
      auto const normal = contact_normal(d, distance);
      PairVelocity<Real> const pair{v, discs.velocity(k)};
      auto const result = law(normal, pair);
      if (discs.id(k) > id) {
        ++books.collisions;
        if (dot(pair.second - pair.first, normal) >= 0)
          ++books.separating_hits;
      }
      if (discs.id(k) > last && !(result.first == v)) {
        last = discs.id(k);
        before = pair;
        after = result;
        separation = d;
      }
    });
    if (last < 0)
      return;
    state.spare.set_velocity(i, after.first);

    // This disc's half of the pair's loss is the law's; what the disc gains beyond that is the
    // method's doing, and nothing where the partner's last partner is this disc.
    double const half_loss = 0.5 * energy_lost(before, after);
    double const gain = kinetic_energy(after.first) - kinetic_energy(before.first);
    books.lost_pairs.add(half_loss, state.scales.energy);
    books.numerical.add(gain + half_loss, state.scales.energy);
    auto const kick = as<double>(after.first) - as<double>(before.first);
    books.virial.add(-0.5 * dot(kick, as<double>(separation)), state.scales.virial);
  }
};

/// Pair step of engine `simultaneous`.
template <class Space, class Real>
class SimultaneousPairs {
 public:
  SimultaneousPairs(CellGrid<Space, Real> const&, double, Execution, int)
    : books_("ricochet::pair_books")
  {
  }

  template <class LawType, bool periodic>
  void resolve(Space const& space, PairState<Space, Real, periodic> const& state,
               LawType const& law)
  {
    Kokkos::parallel_reduce(
        "ricochet::last_partner_wins", Range<Space>(space, 0, state.discs.count()),
        LastPartnerWins<Space, Real, LawType, periodic>{state, state.neighbours(), law},
        Merge<Books, Space>(books_));
    enter<Space>(space, state.books, books_);
    Kokkos::deep_copy(space, state.discs.vx, state.spare.vx);
    Kokkos::deep_copy(space, state.discs.vy, state.spare.vy);
  }

  ExecutionCounts executions() const { return {}; }
  template <class Visit>
  void visit_numbers(Visit const&)
  {
  }

 private:
  BooksView<Space> books_;
};

} // namespace ricochet
