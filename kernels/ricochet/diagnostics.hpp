// Totals of a state, its fingerprint, and the way between device storage and lists in id order.
#pragma once

#include "ricochet/books.hpp"
#include "ricochet/discs.hpp"
#include "ricochet/model.hpp"

#include <cstdint>
#include <cstring>

namespace ricochet {

/// Conserved, or nearly conserved, quantities of a state; sums that are the same in any order.
struct Totals {
  ExactSum kinetic, potential, momentum_x, momentum_y;

  KOKKOS_INLINE_FUNCTION void merge(Totals const& other)
  {
    kinetic.merge(other.kinetic);
    potential.merge(other.potential);
    momentum_x.merge(other.momentum_x);
    momentum_y.merge(other.momentum_y);
  }
};

/// Adds up kinetic energy, potential energy g (y + H/2) and momentum, of a block of discs at a
/// time.
template <class Space, class Real>
struct AddUp {
  static constexpr int block = block_on_host<Space, 256>;
  static_assert(block <= ExactSum::few, "their sums must not need to carry");

  Discs<Space, Real> discs;
  double gravity, floor_y;
  Scales scales;

  KOKKOS_INLINE_FUNCTION void operator()(int b, Totals& totals) const
  {
    Totals own;
    for_each_in_block(b, block, discs.count(), [&](int i) {
      auto const v = as<double>(discs.velocity(i));
      auto const p = as<double>(discs.position(i));
      own.kinetic.add_one_of_few(kinetic_energy(v), scales.energy);
      own.potential.add_one_of_few(gravity * (p.y - floor_y), scales.energy);
      own.momentum_x.add_one_of_few(v.x, scales.momentum);
      own.momentum_y.add_one_of_few(v.y, scales.momentum);
    });
    totals.merge(own);
  }
};

/// Totals of the present state.
template <class Space, class Real>
Totals totals(Space const& space, Discs<Space, Real> const& discs, Model const& model,
              Scales const& scales)
{
  Kokkos::View<Totals, Space> result("ricochet::totals");
  using Add = AddUp<Space, Real>;
  Kokkos::parallel_reduce(
      "ricochet::add_up", Range<Space>(space, 0, blocks_of(Add::block, discs.count())),
      Add{discs, model.gravity, -model.box.height / 2, scales}, Merge<Totals, Space>(result));
  return value_after(space, result);
}

/// A bijection of 64-bit words that spreads every input bit over the whole word.
/// Source: the finaliser of SplitMix64 (Steele, Lea, Flood 2014, doi 10.1145/2714064.2660195).
KOKKOS_INLINE_FUNCTION std::uint64_t mix(std::uint64_t word)
{
  word = (word ^ (word >> 30)) * 0xbf58476d1ce4e5b9u;
  word = (word ^ (word >> 27)) * 0x94d049bb133111ebu;
  return word ^ (word >> 31);
}

/// Fingerprint of one disc: its id and the bits of its state as binary64.
template <class Space, class Real>
struct Fingerprint {
  Discs<Space, Real> discs;

  KOKKOS_INLINE_FUNCTION void operator()(int i, std::uint64_t& sum) const
  {
    double const state[] = {static_cast<double>(discs.x(i)), static_cast<double>(discs.y(i)),
                            static_cast<double>(discs.vx(i)), static_cast<double>(discs.vy(i))};
    std::uint64_t word = mix(static_cast<std::uint64_t>(discs.id(i)) + 0x9e3779b97f4a7c15u);
    for (double const number : state) {
      std::uint64_t bits;
      memcpy(&bits, &number, sizeof bits);
      word = mix(word ^ bits);
    }
    sum += word;
  }
};

/// Sum of the discs' fingerprints modulo 2^64: the same in any order of storage.
template <class Space, class Real>
std::uint64_t state_hash(Space const& space, Discs<Space, Real> const& discs)
{
  std::uint64_t sum = 0;
  Kokkos::parallel_reduce("ricochet::state_hash", Range<Space>(space, 0, discs.count()),
                          Fingerprint<Space, Real>{discs}, sum);
  return mix(sum + static_cast<std::uint64_t>(discs.count()));
}

/// States of discs in id order in the host's memory, owned by the caller.
template <class State>
using HostStates = Kokkos::View<State*, Kokkos::HostSpace, Kokkos::MemoryTraits<Kokkos::Unmanaged>>;

/// Reads discs from a list in id order that `Space` can access.
template <class Space, class Real, class List>
void read_states(Space const& space, List const& list, Discs<Space, Real> const& discs)
{
  Kokkos::parallel_for(
      "ricochet::read_states", Range<Space>(space, 0, discs.count()), KOKKOS_LAMBDA(int i) {
        discs.set_position(i, as<Real>(Vec2<double>{list(i).x, list(i).y}));
        discs.set_velocity(i, as<Real>(Vec2<double>{list(i).vx, list(i).vy}));
        discs.id(i) = i;
      });
}

/// Writes discs to a list in id order that `Space` can access.
template <class Space, class Real, class List>
void write_states(Space const& space, Discs<Space, Real> const& discs, List const& list)
{
  Kokkos::parallel_for(
      "ricochet::write_states", Range<Space>(space, 0, discs.count()), KOKKOS_LAMBDA(int i) {
        auto const p = as<double>(discs.position(i)), v = as<double>(discs.velocity(i));
        list(discs.id(i)) = DiscState{p.x, p.y, v.x, v.y};
      });
}

/// Discs on the device from the states at `in[0...count)`, whose index becomes the id.
template <class Space, class Real>
Discs<Space, Real> discs_from(Space const& space, DiscState const* in, int count)
{
  Discs<Space, Real> discs(count);
  HostStates<DiscState const> const host(in, count);
  if constexpr (shares_host_memory<Space>) {
    read_states(space, host, discs);
  } else {
    Kokkos::View<DiscState*, Space> const list("ricochet::states", count);
    Kokkos::deep_copy(list, host);
    read_states(space, list, discs);
  }
  space.fence();
  return discs;
}

/// Writes the states to `out[0...N)` in id order.
template <class Space, class Real>
void copy_states(Space const& space, Discs<Space, Real> const& discs, DiscState* out)
{
  HostStates<DiscState> const host(out, discs.count());
  if constexpr (shares_host_memory<Space>) {
    write_states(space, discs, host);
    space.fence();
  } else {
    Kokkos::View<DiscState*, Space> const list("ricochet::states", discs.count());
    write_states(space, discs, list);
    space.fence();
    Kokkos::deep_copy(host, list);
  }
}

} // namespace ricochet
