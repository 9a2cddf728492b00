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
  Kokkos::View<Real*, typename Space::memory_space> new_vx, new_vy;
  LawType law;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Books& books) const
  {
    auto const& discs = state.discs;
    auto const p = discs.position(i);
    auto const v = discs.velocity(i);
    int const id = discs.id(i);
    new_vx(i) = v.x;
    new_vy(i) = v.y;
    if (state.contacts(id) == contact::none)
      return;

    int last = -1;
    PairVelocity<Real> before{v, v}, after{v, v};
    Vec2<Real> separation{0, 0};
    state.neighbours.for_each(p, [&](int k, Vec2<Real> d) {
      if (discs.position(k) == p && discs.velocity(k) == v)
        return; // among the discs in the same state is this disc itself
      auto const normal = contact_normal(d, sqrt(dot(d, d)));
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
    new_vx(i) = after.first.x;
    new_vy(i) = after.first.y;

    // This disc's half of the pair's loss is the law's; what the disc gains beyond that is the
    // method's doing, and nothing where the partner's last partner is this disc.
    double const half_loss = 0.5 * ((kinetic_energy(before.first) + kinetic_energy(before.second)) -
                                    (kinetic_energy(after.first) + kinetic_energy(after.second)));
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
  SimultaneousPairs(Cells<Space> const&, int discs)
    : new_vx_(uninitialised<Reals>("ricochet::new_vx", discs)),
      new_vy_(uninitialised<Reals>("ricochet::new_vy", discs)),
      books_("ricochet::pair_books")
  {
  }

  template <class LawType, bool periodic>
  void resolve(Space const& space, PairState<Space, Real, periodic> const& state,
               LawType const& law)
  {
    Kokkos::parallel_reduce(
        "ricochet::last_partner_wins", Kokkos::RangePolicy<Space>(space, 0, state.discs.count()),
        LastPartnerWins<Space, Real, LawType, periodic>{state, new_vx_, new_vy_, law},
        Merge<Books, Space>(books_));
    enter<Space>(space, state.books, books_);
    Kokkos::deep_copy(space, state.discs.vx, new_vx_);
    Kokkos::deep_copy(space, state.discs.vy, new_vy_);
  }

 private:
  using Reals = Kokkos::View<Real*, typename Space::memory_space>;

  Reals new_vx_, new_vy_;
  BooksView<Space> books_;
};

} // namespace ricochet
