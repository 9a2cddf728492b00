// Energy and momentum: what is conserved, and that the books of what is not balance.
#include "support/compare.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

Scene gas(Contact const& contact, Boundary x, Boundary y)
{
  Scene scene;
  scene.model = make_model(45, 40, 0, contact, x, y);
  scene.discs = lattice_discs(scene.model, 180, 10, 41);
  return scene;
}

std::string name_of(testing::TestParamInfo<Way> const& info)
{
  return name(info.param);
}

class Conservation : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Ways, Conservation, testing::ValuesIn(sweep_ways()), name_of);

// One collision rounds each of the four velocity components of a pair a few times, so it changes
// the energy of the pair by at most 16 units of round-off of it.
TEST_P(Conservation, AnElasticWeightlessGasKeepsItsKineticEnergy)
{
  for (auto const boundary : {walls, periodic}) {
    auto const report = report_after(gas({Law::swap_scale, 1, 1}, boundary, boundary), GetParam(),
                                     long_run(GetParam(), 2000));
    ASSERT_GT(report.collisions, 1000);
    double const collisions_of_a_disc = 2.0 * static_cast<double>(report.collisions) / 180;
    EXPECT_NEAR(report.energy.kinetic / report.energy.kinetic_initial, 1,
                16 * epsilon * collisions_of_a_disc);
  }
}

// Rounding again: each collision errs by a few units of the velocities, which are below 100.
TEST_P(Conservation, MomentumIsKeptOnATorusByTheLawsThatConserveIt)
{
  for (auto const& contact : {Contact{Law::swap_scale, 1, 1}, Contact{Law::restitution, 1, 1},
                              Contact{Law::restitution, 0.9, 0.7}}) {
    auto const scene = gas(contact, periodic, periodic);
    auto const before = report_after(scene, GetParam(), 0),
               after = report_after(scene, GetParam(), long_run(GetParam(), 1000));
    ASSERT_GT(after.collisions, 300);
    double const tolerance = 8 * epsilon * 100 * static_cast<double>(after.collisions);
    EXPECT_NEAR(after.momentum_x, before.momentum_x, tolerance);
    EXPECT_NEAR(after.momentum_y, before.momentum_y, tolerance);
  }
}

TEST_P(Conservation, MomentumIsNotKeptByTheOriginalsLaw)
{
  auto scene = gas({Law::swap_scale, 0.9, 0.9}, periodic, periodic);
  for (auto& d : scene.discs)
    d.vx += 20;
  auto const before = report_after(scene, GetParam(), 0),
             after = report_after(scene, GetParam(), 100);
  EXPECT_LT(after.momentum_x, 0.9 * before.momentum_x);
}

TEST_P(Conservation, WithDampingEnergyOnlyFalls)
{
  for (auto const law : {Law::swap_scale, Law::restitution}) {
    auto const engine = start(gas({law, 0.9, 0.9}, walls, walls), GetParam());
    double before = engine->report().energy.kinetic;
    for (int part = 0; part < 10; ++part) {
      engine->advance(15);
      double const now = engine->report().energy.kinetic;
      EXPECT_LT(now, before);
      before = now;
    }
  }
}

/// Scenes in which every entry of the ledger is large at some time.
struct Case {
  char const* name;
  Scene scene;
  std::int64_t steps;
};

std::vector<Case> ledger_cases()
{
  std::vector<Case> cases;
  auto const add = [&](char const* name, double gravity, Contact const& contact, Boundary x,
                       Boundary y, std::size_t count, double speed, std::int64_t steps) {
    Scene scene;
    scene.model = make_model(31, 29, gravity, contact, x, y);
    scene.discs = random_discs(scene.model, count, speed, Ids::shuffled, 51);
    cases.push_back({name, scene, steps});
  };
  Contact const elastic{Law::swap_scale, 1, 1}, scaling{Law::swap_scale, 0.93, 0.9},
      damping{Law::restitution, 0.9, 0.8}, dead{Law::restitution, 0, 0};
  add("gas on a torus", 0, elastic, periodic, periodic, 60, 10, 2000);
  add("gas in a box", 0, scaling, walls, walls, 60, 10, 2000);
  add("elastic pile", 9.81, elastic, walls, walls, 150, 10, 3000);
  add("pile under the original's law", 9.81, scaling, walls, walls, 150, 10, 3000);
  add("pile under restitution", 9.81, damping, periodic, walls, 150, 10, 3000);
  add("pile without bounce", 9.81, dead, walls, walls, 150, 10, 1000);
  add("crowd", 9.81, damping, walls, walls, 300, 10, 1000);
  add("crowd on a torus", 0, scaling, periodic, periodic, 300, 10, 1000);
  add("discs that overshoot the walls", 9.81, elastic, walls, walls, 40, 3000, 200);
  add("discs that fall upwards", -9.81, damping, walls, walls, 60, 10, 2000);
  return cases;
}

class Ledger : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Ways, Ledger, testing::ValuesIn(all_ways()), name_of);

// Double: 1e-12 of the largest energy that occurs, as promised. The residual is the rounding of the
// state itself; in single precision that is 5e8 times as coarse, and it adds up over the steps
// (1e-3 where a run has thousands).
TEST_P(Ledger, Balances)
{
  bool const single = GetParam().precision == Precision::single_;
  for (auto const& c : ledger_cases()) {
    SCOPED_TRACE(c.name);
    auto const engine = start(c.scene, GetParam());
    double largest = 0;
    for (int part = 0; part < 10; ++part) {
      engine->advance(long_run(GetParam(), c.steps / 10));
      auto const energy = engine->report().energy;
      largest = std::max(largest, scale(energy));
      ASSERT_TRUE(std::isfinite(energy.residual()));
      ASSERT_LE(std::abs(energy.residual()), (single ? 1e-3 : 1e-12) * largest)
          << "after " << engine->report().steps << " steps";
    }
  }
}

/// The books of the reference, which are summed in extended precision, event by event.
template <class Real>
void expect_books_of_reference(Way const& way, double tolerance)
{
  for (auto const& c : ledger_cases()) {
    SCOPED_TRACE(c.name);
    auto const steps = std::min(c.steps, long_run(way, 300));
    Reference<Real> reference(way.engine, c.scene.model, c.scene.dt, c.scene.discs);
    reference.advance(steps);
    auto const report = report_after(c.scene, way, steps);
    ASSERT_EQ(report.steps, steps);
    auto const& books = reference.books();
    EXPECT_EQ(report.collisions, books.collisions);
    EXPECT_EQ(report.separating_hits, books.separating_hits);
    EXPECT_EQ(report.wall_hits, books.wall_hits);
    auto const& energy = report.energy;
    double const off = tolerance * scale(energy);
    EXPECT_NEAR(energy.lost_pairs, static_cast<double>(books.lost_pairs), off);
    EXPECT_NEAR(energy.lost_walls, static_cast<double>(books.lost_walls), off);
    EXPECT_NEAR(energy.numerical, static_cast<double>(books.numerical), off);
    auto const now = reference.states();
    EXPECT_NEAR(energy.kinetic, static_cast<double>(kinetic_energy(now)), off);
    EXPECT_NEAR(energy.potential, static_cast<double>(potential_energy(c.scene.model, now)), off);
  }
}

// Each entry on its own, so that none is a remainder. In single precision the ledger takes gravity
// in double and the reference in single, a relative difference of 6e-8.
TEST_P(Ledger, HasTheEntriesOfTheReference)
{
  if (GetParam().precision == Precision::double_)
    expect_books_of_reference<double>(GetParam(), 1e-13);
  else
    expect_books_of_reference<float>(GetParam(), 1e-6);
}

// Nothing but flight: N (g dt)^2 / 2 a step is lost to the method, exactly.
TEST_P(Ledger, BooksTheErrorOfFlight)
{
  Scene scene;
  scene.model = make_model(4096, 4096, 8, {});
  scene.dt = 1.0 / 64;
  scene.discs = {{0, 0, 1, 2}, {10, 0, -1, 0}, {20, 5, 0, 0}};
  auto const energy = report_after(scene, GetParam(), 100).energy;
  EXPECT_EQ(energy.numerical, -100 * 3 * (0.125 * 0.125) / 2);
  EXPECT_EQ(energy.lost_pairs, 0);
  EXPECT_EQ(energy.lost_walls, 0);
  EXPECT_EQ(energy.residual(), 0) << "no operation rounds in this scene";
}

class SweepLedger : public testing::TestWithParam<Way> {};
INSTANTIATE_TEST_SUITE_P(Ways, SweepLedger, testing::ValuesIn(sweep_ways()), name_of);

// A push upwards is work against gravity that nobody did: g times the change of height.
TEST_P(SweepLedger, BooksAPushAgainstGravity)
{
  Scene scene;
  scene.model = make_model(64, 32, 8, {Law::restitution, 0.5, 0.5});
  scene.dt = 1.0 / 64;
  scene.discs = {{0, 0, 0, 4}, {0, 1.5, 0, -4}};
  auto const energy = report_after(scene, GetParam(), 1).energy;
  EXPECT_EQ(energy.numerical, 8 * 0.5 - 2 * (0.125 * 0.125) / 2);
  EXPECT_EQ(energy.lost_pairs, (16 + 16) / 2.0 * (1 - 0.25));
  EXPECT_EQ(energy.residual(), 0);
}

TEST_P(Ledger, StartsWithWhatIsThere)
{
  Scene scene;
  scene.model = make_model(64, 32, 8, {});
  scene.discs = {{0, -16, 3, 4}, {10, 2, 1, 0}};
  auto const energy = report_after(scene, GetParam(), 0).energy;
  EXPECT_EQ(energy.kinetic_initial, (25 + 1) / 2.0);
  EXPECT_EQ(energy.potential_initial, 8 * (0 + 18)) << "heights are measured from the floor";
  EXPECT_EQ(energy.kinetic, energy.kinetic_initial);
  EXPECT_EQ(energy.potential, energy.potential_initial);
  EXPECT_EQ(energy.initial(), 13 + 144);
}

} // namespace
} // namespace ricochet::test
