// The cell grid: how discs are stored, and that the search over it misses nobody.
#include "ricochet/cell_grid.hpp"
#include "ricochet/diagnostics.hpp"
#include "ricochet/neighbours.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace ricochet::test {
namespace {

using Space = Kokkos::DefaultExecutionSpace;

Model box(double width, double height, Boundary x, Boundary y)
{
  return make_model(width, height, 0, {}, x, y);
}

template <class View>
std::vector<typename View::non_const_value_type> on_host(View const& view)
{
  auto const mirror = Kokkos::create_mirror_view(view);
  Kokkos::deep_copy(mirror, view);
  std::vector<typename View::non_const_value_type> values;
  for (std::size_t k = 0; k < mirror.extent(0); ++k)
    values.push_back(mirror(k));
  return values;
}

/// Random discs, the first `heaped` of which are in one place.
std::vector<DiscState> crowd_in(Model const& model, std::size_t count, std::size_t heaped)
{
  auto discs = random_discs(model, count, 1, Ids::shuffled, 4);
  for (std::size_t k = 0; k < heaped; ++k)
    discs[k].x = discs[k].y = 1e-3 * static_cast<double>(k % 7);
  return discs;
}

/// Discs on the device, sorted by a grid of their own.
template <class Real>
struct Sorted {
  Sorted(Model const& model, std::vector<DiscState> const& states)
    : grid(model, static_cast<int>(states.size())),
      discs(discs_from<Space, Real>(Space(), states.data(), static_cast<int>(states.size())))
  {
    sort();
  }

  void sort(Inside inside = Inside::any_order)
  {
    grid.sort(Space(), discs, inside);
    Space().fence();
  }

  CellGrid<Space, Real> grid;
  Discs<Space, Real> discs;
};

/// How often `search` finds each disc (column, by id) from each disc (row, by id).
enum class Search { within, around, cells_around, ahead };

template <class Real, bool periodic>
std::vector<int> found(Model const& model, Sorted<Real> const& sorted, Search search, Real reach)
{
  auto const discs = sorted.discs;
  int const n = discs.count();
  Neighbours<Space, Real, periodic> const neighbours(discs, sorted.grid.cells(), model.box);
  Domain<Real, periodic> const domain(model.box);
  auto const cells = sorted.grid.cells();
  auto const cell = sorted.grid.cell();
  Kokkos::View<int*, Space::memory_space> const times(
      "ricochet::times_found", static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  Kokkos::parallel_for(
      "ricochet::find_all", Kokkos::RangePolicy<Space>(0, n), KOKKOS_LAMBDA(int i) {
        auto const note = [&](int k, Vec2<Real>) { ++times(discs.id(i) * n + discs.id(k)); };
        auto const p = discs.position(i);
        if (search == Search::within)
          neighbours.for_each_within(p, reach, note);
        else if (search == Search::around)
          neighbours.for_each_around(cell(i), p, reach * reach, note);
        else if (search == Search::cells_around)
          cells.template for_cells_around<periodic>(cell(i), [&](int c) {
            for (int k = cells.start(c); k < cells.start(c + 1); ++k) {
              auto const d = domain.separation(p, discs.position(k));
              if (dot(d, d) < reach * reach)
                note(k, d);
            }
          });
        else
          neighbours.for_each_ahead(cell(i), i, reach * reach, note);
      });
  Space().fence();
  return on_host(times);
}

template <class Real, bool periodic>
std::vector<int> within_reach(Model const& model, std::vector<DiscState> const& states, Real reach)
{
  Domain<Real, periodic> const domain(model.box);
  std::vector<int> result;
  auto const position = [&](DiscState const& d) { return as<Real>(Vec2<double>{d.x, d.y}); };
  for (auto const& a : states)
    for (auto const& b : states) {
      auto const d = domain.separation(position(a), position(b));
      result.push_back(dot(d, d) < reach * reach ? 1 : 0);
    }
  return result;
}

/// The pairs in a table of who finds whom, whichever of the two does.
std::vector<int> pairs(std::vector<int> const& table, std::size_t n)
{
  std::vector<int> result(n * n);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t k = 0; k < i; ++k)
      result[i * n + k] = table[i * n + k] + table[k * n + i];
  return result;
}

template <class Real, bool periodic>
void expect_nobody_missed(Model const& model, std::vector<DiscState> const& states)
{
  SCOPED_TRACE("box of " + std::to_string(model.box.width) + " x " +
               std::to_string(model.box.height));
  Sorted<Real> const sorted(model, states);
  for (Real const reach : {Real(2), Real(0.5), Real(3.7)})
    EXPECT_EQ((found<Real, periodic>(model, sorted, Search::within, reach)),
              (within_reach<Real, periodic>(model, states, reach)))
        << "reach " << reach;
  for (Real const reach : {Real(2), Real(0.5)}) {
    auto const expected = within_reach<Real, periodic>(model, states, reach);
    EXPECT_EQ((found<Real, periodic>(model, sorted, Search::around, reach)), expected);
    EXPECT_EQ((found<Real, periodic>(model, sorted, Search::cells_around, reach)), expected);
    auto once = pairs(expected, states.size());
    for (auto& times : once)
      times /= 2;
    EXPECT_EQ(pairs(found<Real, periodic>(model, sorted, Search::ahead, reach), states.size()),
              once);
  }
}

template <class Real>
class CellGridOf : public testing::Test {
};
using Reals = testing::Types<double, float>;
TYPED_TEST_SUITE(CellGridOf, Reals);

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;

// From one cell to many, with walls and across periodic edges; also discs far outside the box,
// where a fast disc may be, and where all of them are in the outermost cells.
TYPED_TEST(CellGridOf, TheSearchesFindEveryDiscWithinReachOnce)
{
  std::uint64_t seed = 1;
  for (double const width : {2.0, 3.9, 4.1, 6.5, 31.0})
    for (double const height : {2.0, 5.9, 8.2, 23.0}) {
      auto const inside = box(width, height, walls, walls);
      auto const states = random_discs(inside, 150, 1, Ids::shuffled, seed++);
      expect_nobody_missed<TypeParam, false>(inside, states);
      expect_nobody_missed<TypeParam, true>(box(width, height, periodic, periodic), states);
      expect_nobody_missed<TypeParam, true>(box(width, height, walls, periodic), states);
      expect_nobody_missed<TypeParam, true>(box(width, height, periodic, walls), states);

      auto outside = states;
      for (auto& d : outside)
        d.x *= 5;
      expect_nobody_missed<TypeParam, false>(inside, outside);
    }
}

template <class Real>
void expect_cell_order(Sorted<Real> const& sorted)
{
  auto const start = on_host(sorted.grid.cells().start);
  auto const id = on_host(sorted.discs.id);
  std::vector<int> stored(static_cast<std::size_t>(sorted.discs.count()), 0);
  auto const cell_of_slot = on_host(sorted.grid.cell());
  auto const x = on_host(sorted.discs.x), y = on_host(sorted.discs.y);
  auto const cells = sorted.grid.cells();
  ASSERT_EQ(start.front(), 0);
  ASSERT_EQ(start.back(), sorted.discs.count());
  for (int cell = 0; cell < cells.count(); ++cell)
    for (int slot = start[static_cast<std::size_t>(cell)];
         slot < start[static_cast<std::size_t>(cell) + 1]; ++slot) {
      auto const s = static_cast<std::size_t>(slot);
      EXPECT_EQ(cells.at(Vec2<Real>{x[s], y[s]}), cell);
      EXPECT_EQ(cell_of_slot[s], cell);
      ++stored.at(static_cast<std::size_t>(id[s]));
    }
  EXPECT_EQ(stored, std::vector<int>(stored.size(), 1));
}

TYPED_TEST(CellGridOf, DiscsAreStoredByCell)
{
  auto const model = box(31, 23, walls, walls);
  expect_cell_order(Sorted<TypeParam>(model, random_discs(model, 300, 1, Ids::shuffled, 3)));
  expect_cell_order(Sorted<TypeParam>(model, crowd_in(model, 300, 200)));
  expect_cell_order(Sorted<TypeParam>(model, {}));
}

// From one sort to the next discs stay in their cells, come and go; and in a crowd more stay in one
// than a work item counts.
TYPED_TEST(CellGridOf, DiscsThatMovedAreStoredByCellAgain)
{
  auto const model = box(31, 23, walls, walls);
  Sorted<TypeParam> sorted(model, crowd_in(model, 1000, 400));
  for (int time = 0; time < 6; ++time) {
    auto const discs = sorted.discs;
    Kokkos::parallel_for(
        "ricochet::move_every_third", Kokkos::RangePolicy<Space>(0, discs.count()),
        KOKKOS_LAMBDA(int i) {
          if (discs.id(i) % 3 == time % 3)
            discs.x(i) += static_cast<TypeParam>(discs.id(i) % 2 == 0 ? 1.5 : -1.5);
        });
    sorted.sort(time == 3 ? Inside::by_id : Inside::any_order);
    expect_cell_order(sorted);
  }
}

TYPED_TEST(CellGridOf, InsideACellDiscsAreStoredByIdIfAskedFor)
{
  auto const model = box(31, 23, walls, walls);
  // Also a crowd in one place, more than an insertion sort is used for.
  auto const states = crowd_in(model, 300, 200);
  Sorted<TypeParam> sorted(model, states);
  sorted.sort(Inside::by_id);
  expect_cell_order(sorted);
  auto const id = on_host(sorted.discs.id), cell = on_host(sorted.grid.cell());
  for (std::size_t s = 1; s < states.size(); ++s)
    if (cell[s] == cell[s - 1]) {
      EXPECT_LT(id[s - 1], id[s]);
    }
}

TYPED_TEST(CellGridOf, SortingMovesWholeDiscs)
{
  auto const model = box(31, 23, walls, walls);
  auto const states = random_discs(model, 500, 7, Ids::shuffled, 6);
  Sorted<TypeParam> const sorted(model, states);
  std::vector<DiscState> back(states.size());
  copy_states(Space(), sorted.discs, back.data());
  for (std::size_t k = 0; k < states.size(); ++k) {
    EXPECT_EQ(back[k].x, static_cast<double>(static_cast<TypeParam>(states[k].x)));
    EXPECT_EQ(back[k].y, static_cast<double>(static_cast<TypeParam>(states[k].y)));
    EXPECT_EQ(back[k].vx, static_cast<double>(static_cast<TypeParam>(states[k].vx)));
    EXPECT_EQ(back[k].vy, static_cast<double>(static_cast<TypeParam>(states[k].vy)));
  }
}

// A grid costs memory: never more than a few cells for each disc, whatever the shape of the box.
TEST(CellGrid, HasNoMoreCellsThanItsDiscsNeed)
{
  for (int const count : {0, 1, 10, 1000})
    for (auto const& model : {box(2e6, 2, walls, walls), box(2, 2e6, walls, walls),
                              box(1e9, 1e9, walls, walls), box(2, 2, walls, walls)})
      EXPECT_LE((CellGrid<Space, double>(model, count).cells().count()), 4 * count + 10);
}

} // namespace
} // namespace ricochet::test
