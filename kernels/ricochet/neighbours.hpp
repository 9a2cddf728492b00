// Who is near: the one search of all engines.
#pragma once

#include "ricochet/cell_grid.hpp"
#include "ricochet/domain.hpp"

#include <limits>

namespace ricochet {

/// Finds discs closer than a given distance among discs that are sorted into cells.
template <class Space, class Real, bool periodic>
class Neighbours {
 public:
  Neighbours(Discs<Space, Real> const& discs, Cells<Space> const& cells, Box const& box, Real reach)
    : discs_(discs), cells_(cells), domain_(box), reach2_(reach * reach)
  {
    // Rounding moves a computed separation by a few units in the last place of the coordinates; the
    // search must not be narrower than the test.
    search_ = static_cast<double>(reach) * (1 + 1e-6) +
              8 * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
                  (box.width > box.height ? box.width : box.height);
  }

  /// Calls visit(slot, separation) for every disc stored in a cell near `p` whose centre is closer
  /// to `p` than the reach; a disc at `p` is one of them.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each(Vec2<Real> p, Visit const& visit) const
  {
    for_each_from(p, 0, visit);
  }

  /// for_each() among the slots from `from` on.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_from(Vec2<Real> p, int from, Visit const& visit) const
  {
    for_blocks_near(p, [&](int first, int last) {
      int const begin = cells_.start(first);
      for_each_slot(p, begin < from ? from : begin, cells_.start(last + 1), visit);
    });
  }

  /// Calls visit(first, last) for blocks of cells that hold all discs that can be within reach.
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_blocks_near(Vec2<Real> p, Visit const& visit) const
  {
    cells_.template for_blocks_near<periodic>(p, search_, visit);
  }

 private:
  template <class Visit>
  KOKKOS_INLINE_FUNCTION void for_each_slot(Vec2<Real> p, int begin, int end,
                                            Visit const& visit) const
  {
    // Four tests without a branch between them, then one branch: hits are rare, and it is
    // mispredicted branches that cost. The arrays are padded, so that four can always be read.
    constexpr int width = Discs<Space, Real>::padding;
    for (int k = begin; k < end; k += width) {
      Real distance2[width];
      for (int lane = 0; lane < width; ++lane) {
        auto const d = domain_.separation(p, discs_.position(k + lane));
        distance2[lane] = dot(d, d);
      }
      unsigned hits = 0;
      for (int lane = 0; lane < width; ++lane)
        hits |= (distance2[lane] < reach2_ ? 1u : 0u) << lane;
      if (hits != 0)
        for (int lane = 0; lane < width && k + lane < end; ++lane)
          if ((hits >> lane & 1u) != 0)
            visit(k + lane, domain_.separation(p, discs_.position(k + lane)));
    }
  }

  Discs<Space, Real> discs_;
  Cells<Space> cells_;
  Domain<Real, periodic> domain_;
  Real reach2_;
  double search_;
};

} // namespace ricochet
