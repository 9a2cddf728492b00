// Arithmetic that gives the same bits on every machine.
//
// All state arithmetic is + - * / and sqrt, which IEEE 754 rounds correctly everywhere. What a
// compiler may still do is fuse a*b + c into one rounding ("contraction"), or worse under
// fast-math. The build forbids both; here is the proof that it did.
#pragma once

#include "ricochet/kokkos_compat.hpp"

#include <stdexcept>

#if defined(__FAST_MATH__)
#error "ricochet's results are defined by IEEE arithmetic: build without -ffast-math or -Ofast"
#endif

namespace ricochet {

/// Multiplies and adds, in three arrangements, numbers whose product needs rounding:
/// (1 + e)(1 - e) = 1 - e^2 rounds to 1, so that each result is 0; a fused operation leaves e^2.
/// The inputs come from memory, so that nothing is folded at compile time.
template <class Real, class Space>
struct ContractionProbe {
  Kokkos::View<Real[3], Space> in;
  Kokkos::View<Real[3], Space> out;

  KOKKOS_INLINE_FUNCTION void operator()(int) const
  {
    Real const a = in(0), b = in(1), c = in(2);
    out(0) = a * b + c;
    Real const product = a * b;
    out(1) = product + c;
    out(2) = -c - a * b;
  }
};

/// Whether this translation unit's code on `Space` fuses multiplications with additions.
template <class Real, class Space>
bool contracts(Space const& space)
{
  // The square of e must be just below half a unit in the last place of 1.
  Real const e = sizeof(Real) == 8 ? Real(1) / (1 << 27) : Real(1) / (1 << 13);
  ContractionProbe<Real, Space> probe;
  probe.in = decltype(probe.in)("ricochet::contraction_probe_in");
  probe.out = decltype(probe.out)("ricochet::contraction_probe_out");
  auto in = Kokkos::create_mirror_view(probe.in);
  in(0) = 1 + e;
  in(1) = 1 - e;
  in(2) = -1;
  Kokkos::deep_copy(probe.in, in);
  Kokkos::parallel_for("ricochet::contraction_probe", Range<Space>(space, 0, 1), probe);
  auto out = Kokkos::create_mirror_view(probe.out);
  space.fence();
  Kokkos::deep_copy(out, probe.out);
  return out(0) != 0 || out(1) != 0 || out(2) != 0;
}

/// Throws std::runtime_error if it does, in either number format.
template <class Space>
void require_no_contraction(Space const& space)
{
  if (contracts<double>(space) || contracts<float>(space))
    throw std::runtime_error(
        "this build fuses multiplications and additions (floating-point contraction), so its "
        "results would differ from other machines': build with -ffp-contract=off, or "
        "--fmad=false");
}

} // namespace ricochet
