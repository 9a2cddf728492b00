// What engines look for in a state of discs that must not overlap.
#pragma once

#include "ricochet/contacts.hpp"
#include "ricochet/engine.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace ricochet {

/// Throws std::invalid_argument if places are too coarse for the way of a thermal disc in a step.
/// With steps of a third of the spacing of places and less, discs collide too often, and then
/// freeze.
template <class Real>
void require_fine_enough(Model const& model, Method const& method, double temperature)
{
  if (!std::is_same_v<Real, float>)
    return;
  auto const far = static_cast<Real>(std::max(model.box.width, model.box.height) / 2);
  double const spacing = static_cast<double>(std::nextafter(far, 2 * far) - far);
  double const way = std::sqrt(temperature) * method.dt;
  if (way > 0 && spacing > 0.1 * way)
    throw std::invalid_argument(
        std::string("engine ") + name(method.engine) +
        " cannot simulate this scene:\n  numbers of single precision are " +
        std::to_string(spacing / way) +
        " of a thermal disc's way in a step apart in this box; allowed: up to 0.1 (a longer step, "
        "or double precision)");
}

/// Fastest disc and farthest excursion of a state.
struct Extremes {
  double speed2 = 0;
  double outside = 0; ///< beyond a wall [diameters]

  KOKKOS_INLINE_FUNCTION void merge(Extremes const& other)
  {
    speed2 = other.speed2 > speed2 ? other.speed2 : speed2;
    outside = other.outside > outside ? other.outside : outside;
  }
};

/// Looks at whole states, and remembers the deepest overlap and the farthest excursion it has seen.
template <class Space, class Real>
class Inspection {
 public:
  explicit Inspection(Model const& model) : model_(model), extremes_("ricochet::extremes") {}

  /// Throws std::invalid_argument if the state is not one of separate discs between the walls.
  void require_separate(Space const& space, CellGrid<Space, Real>& grid, Discs<Space, Real>& discs,
                        Method const& method);

  /// Throws std::invalid_argument if a disc is not between the walls, or too fast.
  void require_inside(Space const& space, Discs<Space, Real> const& discs, Method const& method)
  {
    note(extremes(space, discs), static_cast<Real>(2 * model_.radius));
    require_none(problems(space, discs, method), method);
  }

  /// Looks at a state, which is sorted for it.
  void look(Space const& space, CellGrid<Space, Real>& grid, Discs<Space, Real>& discs)
  {
    note(extremes(space, discs), is_periodic(model_.box) ? closest_pair<true>(space, grid, discs)
                                                         : closest_pair<false>(space, grid, discs));
  }

  void note(Extremes const& extremes, Real closest)
  {
    auto const diameter = static_cast<Real>(2 * model_.radius);
    max_overlap_ = std::max(max_overlap_, overlap(closest, diameter));
    max_outside_ = std::max(max_outside_, extremes.outside);
  }

  /// Enters what was seen.
  void enter(Report& report) const
  {
    report.max_overlap = std::max(report.max_overlap, max_overlap_);
    report.max_outside = std::max(report.max_outside, max_outside_);
  }

  /// For checkpoints.
  template <class Visit>
  void visit_numbers(Visit const& visit)
  {
    visit("deepest_overlap", max_overlap_);
    visit("farthest_outside", max_outside_);
  }

 public: // nvcc takes device lambdas only from public functions
  Extremes extremes(Space const& space, Discs<Space, Real> const& discs) const;
  template <bool periodic>
  Real closest_pair(Space const& space, CellGrid<Space, Real>& grid,
                    Discs<Space, Real>& discs) const;

 private:
  std::string problems(Space const& space, Discs<Space, Real> const& discs,
                       Method const& method) const;
  static void require_none(std::string const& problems, Method const& method)
  {
    if (!problems.empty())
      throw std::invalid_argument(std::string("engine ") + name(method.engine) +
                                  " cannot simulate this scene:" + problems);
  }

  Model model_;
  Kokkos::View<Extremes, Space> extremes_;
  double max_overlap_ = 0, max_outside_ = 0;
};

template <class Space, class Real>
void Inspection<Space, Real>::require_separate(Space const& space, CellGrid<Space, Real>& grid,
                                               Discs<Space, Real>& discs, Method const& method)
{
  look(space, grid, discs);
  std::string found = problems(space, discs, method);
  if (packing_fraction(model_, static_cast<std::size_t>(discs.count())) > densest_packing)
    found += "\n  discs cover more of the box than is possible without overlaps, 90.69 %";
  require_none(found, method);
}

/// What is wrong with a state that was looked at.
template <class Space, class Real>
std::string Inspection<Space, Real>::problems(Space const& space, Discs<Space, Real> const& discs,
                                              Method const& method) const
{
  // What rounding can leave of a valid state, and no more.
  bool const is_double = method.precision == Precision::double_;
  double const tolerance = is_double ? 1e-9 : 1e-4;
  double const fastest = is_double ? 1e70 : 1e12;
  std::string found;
  if (max_overlap_ > tolerance)
    found += "\n  discs overlap, by up to " + std::to_string(max_overlap_) + " diameters";
  if (max_outside_ > tolerance)
    found +=
        "\n  discs reach beyond a wall, by up to " + std::to_string(max_outside_) + " diameters";
  if (!(extremes(space, discs).speed2 < fastest * fastest))
    found += "\n  a disc is faster than its collisions can be computed";
  return found;
}

template <class Space, class Real>
Extremes Inspection<Space, Real>::extremes(Space const& space,
                                           Discs<Space, Real> const& discs) const
{
  Outside const outside(model_);
  Kokkos::parallel_reduce(
      "ricochet::find_extremes", Range<Space>(space, 0, discs.count()),
      KOKKOS_LAMBDA(int i, Extremes& found) {
        auto const v = as<double>(discs.velocity(i));
        Extremes own{dot(v, v)};
        outside.enter(discs.position(i), own.outside);
        found.merge(own);
      },
      Merge<Extremes, Space>(extremes_));
  return value_after(space, extremes_);
}

/// Distance of the closest pair of a state if it overlaps, else a diameter or more.
template <class Space, class Real>
template <bool periodic>
Real Inspection<Space, Real>::closest_pair(Space const& space, CellGrid<Space, Real>& grid,
                                           Discs<Space, Real>& discs) const
{
  grid.sort(space, discs, Inside::by_id);
  auto const diameter = static_cast<Real>(2 * model_.radius);
  auto const cell = grid.cell();
  Neighbours<Space, Real, periodic> const neighbours(discs, grid.cells(), model_.box);
  Real closest2 = 0;
  Kokkos::parallel_reduce(
      "ricochet::find_closest_pair", Range<Space>(space, 0, discs.count()),
      KOKKOS_LAMBDA(int i, Real& least) {
        neighbours.for_each_ahead(cell(i), i, diameter * diameter, [&](int, Vec2<Real> d) {
          least = dot(d, d) < least ? dot(d, d) : least;
        });
      },
      Kokkos::Min<Real>(closest2));
  return std::sqrt(closest2);
}

} // namespace ricochet
