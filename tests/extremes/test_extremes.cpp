// Scenes at and beyond the edges of what a fixed-step engine is made for: it must stay finite, keep
// its books, keep its bits, and refuse with a sentence what it cannot do.
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ricochet::test {
namespace {

constexpr auto periodic = Boundary::periodic;
Contact const elastic{Law::swap_scale, 1, 1}, scaling{Law::swap_scale, 0.93, 0.9},
    damping{Law::restitution, 0.9, 0.8};

Scene scene_of(Model const& model, std::vector<DiscState> const& discs, double dt = 1.0 / 64)
{
  Scene scene;
  scene.model = model;
  scene.dt = dt;
  scene.discs = discs;
  return scene;
}

template <class Real>
std::vector<DiscState> reference_after(Scene const& scene, EngineKind engine, std::int64_t steps)
{
  Reference<Real> reference(engine, scene.model, scene.dt, scene.discs);
  reference.advance(steps);
  return reference.states();
}

class Extremes : public testing::TestWithParam<Way> {
 protected:
  static bool is_double() { return GetParam().precision == Precision::double_; }

  static std::vector<DiscState> after(Scene const& scene, std::int64_t steps)
  {
    return states_after(scene, GetParam(), steps);
  }
  static Report report(Scene const& scene, std::int64_t steps)
  {
    return report_after(scene, GetParam(), steps);
  }

  /// Runs a scene; the bits must be the reference's and the numbers finite.
  static void expect_reference(Scene const& scene, std::int64_t steps)
  {
    auto const states = after(scene, steps);
    auto const engine = GetParam().engine;
    EXPECT_TRUE(all_finite(states));
    EXPECT_TRUE(same_bits(states, is_double() ? reference_after<double>(scene, engine, steps)
                                              : reference_after<float>(scene, engine, steps)));
  }

  static void expect_inside(Model const& model, std::vector<DiscState> const& states)
  {
    for (auto const& d : states) {
      EXPECT_LE(std::abs(d.x), model.box.width / 2);
      EXPECT_LE(std::abs(d.y), model.box.height / 2);
    }
  }
};
INSTANTIATE_TEST_SUITE_P(Ways, Extremes, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

class SweepExtremes : public Extremes {};
INSTANTIATE_TEST_SUITE_P(Ways, SweepExtremes, testing::ValuesIn(sweep_ways()),
                         [](auto const& way) { return name(way.param); });

// --- Few discs, no steps -----------------------------------------------------------------------

TEST_P(Extremes, NoDiscsRun)
{
  auto const scene = scene_of(make_model(10, 10, 9.81, scaling), {});
  EXPECT_TRUE(after(scene, 100).empty());
  auto const engine = start(scene, GetParam());
  auto const hash = engine->state_hash();
  engine->advance(5);
  EXPECT_EQ(engine->state_hash(), hash);
}

TEST_P(Extremes, OneDiscAndTwoRun)
{
  auto const model = make_model(10, 10, 9.81, scaling);
  expect_reference(scene_of(model, {{0, 0, 30, 20}}), 1000);
  expect_reference(scene_of(model, {{0, 0, 30, 20}, {1, 2, -30, 10}}), 1000);
}

TEST_P(Extremes, NoStepsChangeNothing)
{
  auto scene = scene_of(make_model(20, 20, 9.81, damping), {});
  scene.discs = random_discs(scene.model, 100, 10, Ids::shuffled, 1);
  if (!is_double())
    for (auto& d : scene.discs)
      d = {double{static_cast<float>(d.x)}, double{static_cast<float>(d.y)},
           double{static_cast<float>(d.vx)}, double{static_cast<float>(d.vy)}};
  auto const engine = start(scene, GetParam());
  auto const before = engine->report();
  engine->advance(0);
  EXPECT_TRUE(same_bits(states(engine), scene.discs));
  EXPECT_TRUE(same_bits(engine->report(), before));
  EXPECT_EQ(before.steps, 0);
  EXPECT_EQ(before.collisions, 0);
  EXPECT_EQ(before.energy.residual(), 0);
}

// --- Places ------------------------------------------------------------------------------------

TEST_P(Extremes, CoincidentDiscsStayFinite)
{
  auto const model = make_model(20, 20, 0, damping);
  expect_reference(scene_of(model, {{3, 3, 1, 2}, {3, 3, -1, 0}}), 20);
  expect_reference(scene_of(model, {{3, 3, 1, 2}, {3, 3, 1, 2}}), 20);
  expect_reference(scene_of(model, std::vector<DiscState>(30, {0, 0, 0, 0})), 20);
}

// A hundred discs within a hundredth of a diameter. The sweep pulls them apart along the order of
// ids and creates no kinetic energy with it; every disc stays in a box that has room for all.
TEST_P(Extremes, AClumpComesApartWithoutAnExplosion)
{
  auto scene = scene_of(make_model(600, 600, 0, damping), {});
  Random random(5);
  for (int k = 0; k < 100; ++k)
    scene.discs.push_back({random.between(-0.01, 0.01), random.between(-0.01, 0.01),
                           random.between(-1, 1), random.between(-1, 1)});
  expect_reference(scene, 50);
  if (GetParam().engine == EngineKind::sweep) {
    auto const result = report(scene, 50);
    EXPECT_LE(result.energy.kinetic, result.energy.kinetic_initial);
    expect_inside(scene.model, after(scene, 50));
  }
}

TEST_P(Extremes, DiscsExactlyADiameterApartDoNotTouch)
{
  auto const model = make_model(20, 20, 0, elastic);
  for (auto const& velocity : {0.0, 1.0, -1.0, 1e-300})
    EXPECT_EQ(report(scene_of(model, {{0, 0, velocity, 0}, {2, 0, 0, 0}}), 1).collisions, 0);
  // A lattice without a gap: nobody touches while nobody moves.
  auto lattice = scene_of(make_model(20, 20, 0, elastic), {});
  lattice.discs = lattice_discs(lattice.model, 100, 0, 1);
  EXPECT_EQ(report(lattice, 10).collisions, 0);
  EXPECT_EQ(report(lattice, 10).wall_hits, 0);
}

TEST_P(Extremes, ABoxJustAsWideAsADiscWillDoAndANarrowerOneIsRefused)
{
  expect_reference(scene_of(make_model(2, 2, 0, scaling), {{0, 0, 1, 1}}), 100);
  expect_reference(scene_of(make_model(2, 2, 9.81, scaling), {{0.5, 0, 1, 1}, {-1, 1, 5, 5}}), 100);
  expect_reference(
      scene_of(make_model(2, 2, 0, scaling, periodic, periodic), {{0, 0, 1, 1}, {1, 1, 2, 3}}),
      100);
  EXPECT_THROW(after(scene_of(make_model(std::nextafter(2.0, 0.0), 2, 0, scaling), {}), 0),
               std::invalid_argument);
}

TEST_P(Extremes, ABoxAMillionTimesLongerThanWideWillDo)
{
  auto scene = scene_of(make_model(2e6, 2, 9.81, scaling), {});
  scene.discs = random_discs(scene.model, 300, 1000, Ids::shuffled, 6);
  for (std::size_t k = 0; k < 100; ++k)
    scene.discs[k].x = -7e5 + 0.7 * static_cast<double>(k);
  expect_reference(scene, 50);
  auto tall = scene_of(make_model(2, 2e6, 0, damping, periodic, periodic), scene.discs);
  for (auto& d : tall.discs)
    d = {d.y, d.x, d.vy, d.vx};
  expect_reference(tall, 50);
}

// All discs in one cell, and all in one row: the work may grow, the result may not change.
TEST_P(Extremes, ACrowdInOneCellAndACrowdInOneRowKeepTheirBits)
{
  auto one_cell = scene_of(make_model(1000, 1000, 0, damping), {});
  Random random(7);
  for (int k = 0; k < 300; ++k)
    one_cell.discs.push_back(
        {400 + random.unit(), -300 + random.unit(), random.between(-5, 5), random.between(-5, 5)});
  expect_reference(one_cell, 5);

  auto one_row = scene_of(make_model(1000, 1000, 0, damping), {});
  for (int k = 0; k < 600; ++k)
    one_row.discs.push_back({random.between(-499, 499), 3.0, random.between(-50, 50), 0});
  expect_reference(one_row, 10);
}

// Every push moves a disc a little farther onto the next, whose turn is still to come: one push
// runs down the whole chain in one step, and the last disc ends where all overlaps were taken up.
// In double precision: single cannot hold the overlaps.
TEST_P(SweepExtremes, AChainOfThirtyThousandOverlappingDiscsIsPulledStraightInOneStep)
{
  constexpr int count = 30000;
  auto scene = scene_of(make_model(4 * count, 8, 0, elastic), {});
  for (int k = 0; k < count; ++k)
    scene.discs.push_back({(2 - 0x1p-14) * k - 1.5 * count, 0, 0, 0});
  auto const states = after(scene, 1);
  for (int k = 0; k < count; ++k)
    ASSERT_EQ(states[static_cast<std::size_t>(k)].x, 2.0 * k - 1.5 * count) << "disc " << k;
  EXPECT_EQ(report(scene, 1).collisions, count - 1);
}

// With deep overlaps the pushes add up until a disc is pushed past others, which turn back.
TEST_P(Extremes, ADeepChainWithRisingIdsKeepsItsBits)
{
  constexpr int count = 1000;
  auto scene = scene_of(make_model(4 * count, 8, 0, damping), {});
  for (int k = 0; k < count; ++k)
    scene.discs.push_back({1.875 * k - 1.5 * count, 0, 0, 0});
  expect_reference(scene, 3);
}

TEST_P(Extremes, TheSameChainWithFallingIdsKeepsItsBits)
{
  constexpr int count = 1000;
  auto scene = scene_of(make_model(4 * count, 8, 0, damping), {});
  for (int k = count; k-- > 0;)
    scene.discs.push_back({1.875 * k - 1.5 * count, 0, 0, 0});
  expect_reference(scene, 3);
}

// Denser than any packing without overlap.
TEST_P(Extremes, PackingBeyondTheDensestStaysFiniteAndInTheBooks)
{
  auto scene = scene_of(make_model(30, 30, 9.81, damping), {});
  scene.discs = random_discs(scene.model, 400, 5, Ids::row_major, 8); // packing 1.4
  expect_reference(scene, 60);
  auto const energy = report(scene, 60).energy;
  EXPECT_LE(std::abs(energy.residual()), (is_double() ? 1e-12 : 1e-4) * scale(energy));
}

// --- Numbers -----------------------------------------------------------------------------------

TEST_P(Extremes, DenormalVelocitiesAndNegativeZerosAreNumbersLikeAnyOther)
{
  double const tiny = is_double() ? 4.9e-324 : 1.4e-45;
  expect_reference(scene_of(make_model(20, 20, 0, damping),
                            {{0, 0, tiny, -tiny}, {1.5, 0, -tiny, 0}, {-0.0, -5, -0.0, -0.0}}),
                   10);
}

TEST_P(Extremes, ApproachAtADenormalSpeedIsOneCollision)
{
  double const tiny = is_double() ? 1e-300 : 1e-40;
  auto const result =
      report(scene_of(make_model(20, 20, 0, elastic), {{0, 0, tiny, 0}, {1.9375, 0, 0, 0}}), 1);
  EXPECT_EQ(result.collisions, 1);
  EXPECT_EQ(result.separating_hits, 0);
}

// The discs leave the box at once, and for good: the wall rule mirrors once a step, at most, so a
// disc that is farther away than its own step comes back only to cross the box again. Documented in
// the manual of the kernels; here it has to stay finite where the format can hold it.
TEST_P(Extremes, HugeVelocitiesStayFinite)
{
  double const huge = is_double() ? 1e150 : 1e15;
  auto const scene =
      scene_of(make_model(20, 20, 0, damping), {{0, 0, huge, 0}, {1.5, 0, -huge, 1}});
  EXPECT_TRUE(all_finite(after(scene, 20)));
  auto const result = report(scene, 20);
  EXPECT_TRUE(std::isfinite(result.max_outside));
  // The sums of the ledger span a limited range; beyond it they are NaN, never a wrong number.
  EXPECT_EQ(std::isfinite(result.energy.kinetic), !is_double()) << "1e300 and beyond";
  if (!is_double()) {
    auto const kinetic = static_cast<double>(kinetic_energy(after(scene, 20)));
    EXPECT_NEAR(result.energy.kinetic, kinetic, 1e-12 * kinetic);
  }
}

TEST_P(Extremes, NumbersThatAreNoneAreRefusedWithAMessage)
{
  double const nan = std::numeric_limits<double>::quiet_NaN();
  for (double const bad : {nan, HUGE_VAL, -HUGE_VAL})
    for (auto const field : {&DiscState::x, &DiscState::y, &DiscState::vx, &DiscState::vy}) {
      auto scene = scene_of(make_model(20, 20, 0, damping), {{0, 0, 0, 0}, {1, 1, 1, 1}});
      scene.discs[1].*field = bad;
      try {
        after(scene, 0);
        ADD_FAILURE() << "accepted " << bad;
      } catch (std::invalid_argument const& error) {
        EXPECT_NE(std::string(error.what()).find("disc 1"), std::string::npos) << error.what();
      }
    }
}

// --- Steps -------------------------------------------------------------------------------------

// Steps longer than the box. The original mirrors once and lets go, so a disc may end outside; the
// numbers stay finite and, at alpha = 1, speeds keep their size exactly.
TEST_P(Extremes, StepsLongerThanTheBoxStayFiniteAndKeepTheSpeed)
{
  for (double const lengths : {1.3, 10.0, 1e6}) {
    double const speed = lengths * 20 * 64;
    auto const scene = scene_of(make_model(20, 20, 0, elastic), {{0.3, -0.2, speed, -speed}});
    for (int const steps : {1, 2, 3, 50}) {
      auto const d = after(scene, steps)[0];
      EXPECT_TRUE(all_finite({d}));
      EXPECT_EQ(std::abs(d.vx), speed);
      EXPECT_EQ(std::abs(d.vy), speed);
    }
    expect_reference(scene, 50);
  }
}

TEST_P(Extremes, StepsLongerThanAPeriodicBoxWrapIntoIt)
{
  for (double const lengths : {1.3, 10.0, 1e6}) {
    double const speed = lengths * 20 * 64;
    auto const scene = scene_of(make_model(20, 24, 0, elastic, periodic, periodic),
                                {{0.3, -0.2, speed, -speed}, {5, 5, -speed, 1}});
    expect_reference(scene, 30);
    expect_inside(scene.model, after(scene, 30));
  }
}

// A guard does not exist for this engine; what happens is that they pass through each other.
TEST_P(Extremes, DiscsThatJumpOverEachOtherDoNotCollide)
{
  auto const scene =
      scene_of(make_model(400, 20, 0, elastic), {{-50, 0, 6400, 0}, {50, 0, -6400, 0}});
  EXPECT_EQ(report(scene, 1).collisions, 0);
  EXPECT_TRUE(same_bits(after(scene, 1), {{50, 0, 6400, 0}, {-50, 0, -6400, 0}}));
}

TEST_P(Extremes, AnExactHitOfACornerEndsInTheBox)
{
  for (double const sx : {-1.0, 1.0})
    for (double const sy : {-1.0, 1.0}) {
      auto const scene =
          scene_of(make_model(20, 20, 0, elastic), {{sx * 8.75, sy * 8.75, sx * 32, sy * 32}});
      auto const one = after(scene, 1)[0];
      EXPECT_EQ(one.x, sx * 8.75) << "the first wall after one step";
      EXPECT_EQ(one.y, sy * 9.25) << "the edge a quarter beyond the second, the centre inside";
      auto const two = after(scene, 2)[0];
      EXPECT_EQ(two.y, sy * 8.25) << "the second wall after two";
      EXPECT_EQ(two.vx, -sx * 32);
      EXPECT_EQ(two.vy, -sy * 32);
    }
}

TEST_P(Extremes, TinyStepsMoveNothingAndHugeOnesStayFinite)
{
  auto const model = make_model(20, 20, 9.81, damping);
  std::vector<DiscState> const discs = {{0.5, 1.5, 3, 4}, {-3, 0.25, 1, -2}};
  double const tiny = is_double() ? 1e-300 : 1e-30, huge = is_double() ? 1e100 : 1e10;
  EXPECT_TRUE(same_bits(after(scene_of(model, discs, tiny), 10), discs));
  EXPECT_TRUE(all_finite(after(scene_of(model, discs, huge), 5)));
}

TEST_P(Extremes, EnormousGravityPressesDiscsToTheFloorWithoutLosingThem)
{
  auto scene = scene_of(make_model(20, 20, 1e6, {Law::restitution, 0.5, 0.5}), {});
  scene.discs = lattice_discs(scene.model, 50, 1, 9);
  expect_reference(scene, 100);
}

TEST_P(Extremes, UnderNegativeGravityTheCeilingIsTheFloor)
{
  auto down = scene_of(make_model(20, 24, 9.81, damping), {});
  down.discs = random_discs(down.model, 30, 5, Ids::shuffled, 10);
  expect_reference(down, 300);
  auto up = down;
  up.model.gravity = -9.81;
  expect_reference(up, 300);
  auto const mean_height = [](std::vector<DiscState> const& states) {
    double sum = 0;
    for (auto const& d : states)
      sum += d.y;
    return sum / static_cast<double>(states.size());
  };
  EXPECT_LT(mean_height(after(down, 300)), -2);
  EXPECT_GT(mean_height(after(up, 300)), 2);
}

// --- All at once -------------------------------------------------------------------------------

TEST_P(Extremes, AWholeGridThatHitsAWallAtOnceIsCountedToTheLastDisc)
{
  constexpr int count = 3000;
  auto scene = scene_of(make_model(4 * count, 20, 0, scaling), {});
  for (int k = 0; k < count; ++k)
    scene.discs.push_back({4.0 * k - 2.0 * count + 2, 8.75, 0, 64});
  auto const result = report(scene, 1);
  EXPECT_EQ(result.wall_hits, count);
  EXPECT_EQ(result.collisions, 0);
  EXPECT_NEAR(result.energy.lost_walls, count * 64 * 64 / 2.0 * (1 - 0.93 * 0.93),
              (is_double() ? 1e-13 : 1e-6) * count * 64 * 64);
}

// A symmetric lattice of head-on pairs: every collision at the same instant.
TEST_P(Extremes, SimultaneousHeadOnCollisionsReverseEveryPair)
{
  auto scene = scene_of(make_model(400, 400, 0, elastic), {});
  for (int row = 0; row < 30; ++row)
    for (int column = 0; column < 30; ++column) {
      double const x = 12.0 * column - 180, y = 12.0 * row - 180;
      scene.discs.push_back({x, y, 16, 0});
      scene.discs.push_back({x + 2.25, y, -16, 0});
    }
  EXPECT_EQ(report(scene, 2).collisions, 900);
  auto const states = after(scene, 2);
  for (std::size_t k = 0; k < states.size(); ++k)
    ASSERT_EQ(states[k].vx, k % 2 == 0 ? -16 : 16) << "disc " << k;
}

// One disc ten thousand times as fast as the others, and cold discs everywhere.
TEST_P(Extremes, OneFastDiscAmongCoolOnesKeepsItsBits)
{
  auto scene = scene_of(make_model(40, 40, 0, damping), {});
  scene.discs = random_discs(scene.model, 150, 1e-3, Ids::shuffled, 12);
  scene.discs[40].vx = 1e4;
  scene.discs[90] = {scene.discs[90].x, scene.discs[90].y, 0, 0};
  expect_reference(scene, 100);
}

TEST_P(Extremes, DiscsThatDoNotBounceComeToRest)
{
  auto scene = scene_of(make_model(40, 40, 0, {Law::restitution, 0, 0}), {});
  scene.discs = random_discs(scene.model, 100, 20, Ids::shuffled, 13);
  expect_reference(scene, 200);
  if (GetParam().engine == EngineKind::sweep) {
    auto const energy = report(scene, long_run(GetParam(), 2000)).energy;
    EXPECT_LT(energy.kinetic, 0.02 * energy.kinetic_initial);
  }
}

} // namespace
} // namespace ricochet::test
