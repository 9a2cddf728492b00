// What the numbers of a report mean, against sums and searches over all discs and pairs.
#include "support/compare.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;

std::vector<Scene> scenes()
{
  std::vector<Scene> result;
  auto const add = [&](std::size_t count, double speed, double gravity, Boundary x, Boundary y) {
    Scene scene;
    scene.model = make_model(37, 33, gravity, {Law::restitution, 0.9, 0.8}, x, y);
    scene.discs = random_discs(scene.model, count, speed, Ids::shuffled, 61);
    result.push_back(scene);
  };
  add(40, 20, 0, walls, walls);
  add(350, 20, 9.81, walls, walls);
  add(200, 20, 0, periodic, periodic);
  add(100, 500, 9.81, periodic, walls);
  add(60, 4000, 0, walls, walls);
  return result;
}

class Diagnostics : public testing::TestWithParam<Way> {
 protected:
  /// Rounding of a distance of about 1 between coordinates up to 40 (or far outside, where the
  /// numbers are larger by as much as the result), in units of a diameter.
  static double tolerance() { return 64 * round_off(GetParam().precision); }
};
INSTANTIATE_TEST_SUITE_P(Ways, Diagnostics, testing::ValuesIn(all_ways()),
                         [](auto const& way) { return name(way.param); });

TEST_P(Diagnostics, MaxOverlapIsTheDeepestAtTheStartOrWhenAContactHadItsTurn)
{
  for (auto const& scene : scenes()) {
    auto const engine = start(scene, GetParam());
    double const at_start = deepest_overlap(scene.model, states(engine));
    EXPECT_NEAR(engine->report().max_overlap, at_start, tolerance()) << "at the start";
    // In single precision the run soon differs from the reference's in double.
    int const steps = GetParam().precision == Precision::double_ ? 20 : 1;
    Reference<double> reference(GetParam().engine, scene.model, scene.dt, scene.discs);
    for (int step = 1; step <= steps; ++step) {
      engine->advance(1);
      reference.advance(1);
      double const deepest = std::max(at_start, reference.books().max_overlap);
      ASSERT_NEAR(engine->report().max_overlap, deepest, tolerance()) << "step " << step;
    }
  }
}

TEST_P(Diagnostics, MaxOverlapIsRememberedWhenDiscsAreApart)
{
  Scene scene;
  scene.model = make_model(64, 32, 0, {Law::swap_scale, 1, 1});
  scene.dt = 1.0 / 64;
  scene.discs = {{0, 0, 16, 0}, {2.25, 0, -16, 0}};
  auto const engine = start(scene, GetParam());
  EXPECT_EQ(engine->report().max_overlap, 0);
  engine->advance(2);
  EXPECT_EQ(engine->report().max_overlap, 0.125);
  engine->advance(20);
  EXPECT_EQ(engine->report().max_overlap, 0.125);
  ASSERT_EQ(deepest_overlap(scene.model, states(engine)), 0);
}

TEST_P(Diagnostics, MaxOverlapOfCoincidentDiscsIsOneDiameter)
{
  Scene scene;
  scene.model = make_model(64, 32, 0, {});
  scene.discs = {{3, 3, 0, 0}, {3, 3, 0, 0}};
  EXPECT_EQ(report_after(scene, GetParam(), 0).max_overlap, 1);
}

TEST_P(Diagnostics, MaxOutsideIsTheFarthestBeyondAWallAtTheStartOrAfterAnyStep)
{
  for (auto const& scene : scenes()) {
    auto const engine = start(scene, GetParam());
    double farthest = farthest_outside(scene.model, states(engine));
    for (int step = 1; step <= 20; ++step) {
      engine->advance(1);
      farthest = std::max(farthest, farthest_outside(scene.model, states(engine)));
      ASSERT_NEAR(engine->report().max_outside, farthest, (1 + farthest) * tolerance())
          << "step " << step;
    }
  }
}

TEST_P(Diagnostics, MaxOutsideKnowsNoWallsOnPeriodicAxes)
{
  Scene scene;
  scene.model = make_model(20, 10, 0, {}, periodic, periodic);
  scene.discs = {{9.9, -4.9, 0, 0}};
  EXPECT_EQ(report_after(scene, GetParam(), 3).max_outside, 0);
  scene.model.box.y = walls;
  EXPECT_NEAR(report_after(scene, GetParam(), 0).max_outside, 0.45, tolerance());
}

// The sums of a report are rounded once, and so are those of the reference, to more digits.
TEST_P(Diagnostics, TotalsAreSumsOverTheDiscs)
{
  for (auto const& scene : scenes()) {
    auto const engine = start(scene, GetParam());
    engine->advance(7);
    auto const report = engine->report();
    auto const now = states(engine);
    double const exact = 4 * round_off(Precision::double_);
    auto const n = static_cast<double>(now.size());
    auto const kinetic = static_cast<double>(kinetic_energy(now));
    EXPECT_EQ(report.discs, static_cast<std::int64_t>(now.size()));
    EXPECT_EQ(report.steps, 7);
    EXPECT_DOUBLE_EQ(report.time, 7 * scene.dt);
    EXPECT_NEAR(report.energy.kinetic, kinetic, exact * kinetic);
    EXPECT_NEAR(report.energy.potential, static_cast<double>(potential_energy(scene.model, now)),
                exact * std::abs(report.energy.potential));
    EXPECT_NEAR(report.temperature, kinetic / n, exact * kinetic / n);
    double const momentum = std::sqrt(2 * n * kinetic);
    EXPECT_NEAR(report.momentum_x, static_cast<double>(momentum_x(now)), exact * momentum);
    EXPECT_NEAR(report.momentum_y, static_cast<double>(momentum_y(now)), exact * momentum);
  }
}

template <class Real>
void expect_virial_of_reference(Way const& way, double tolerance)
{
  for (auto const& scene : scenes()) {
    Reference<Real> reference(way.engine, scene.model, scene.dt, scene.discs);
    reference.advance(20);
    auto const now = reference.states();
    auto const z = report_after(scene, way, 20).pressure_z;
    ASSERT_TRUE(z.has_value());
    // 2 N T = 2 kinetic
    auto const expected = static_cast<double>(1 + reference.books().virial /
                                                      (2 * kinetic_energy(now) * 20 * scene.dt));
    EXPECT_NEAR(*z, expected, tolerance * (1 + std::abs(expected)));
  }
}

TEST_P(Diagnostics, PressureIsTheVirialOfTheCollisions)
{
  if (GetParam().precision == Precision::double_)
    expect_virial_of_reference<double>(GetParam(), 1e-13);
  else
    expect_virial_of_reference<float>(GetParam(), 1e-6);
}

// Z of the steps since a moment, from the sums of the whole run: (Z - 1) 2 N T t is the virial.
TEST_P(Diagnostics, PressureIsThatSinceTheMeasurementBegan)
{
  for (auto const& scene : scenes()) {
    auto const virial = [](Report const& r) {
      return (*r.pressure_z - 1) * r.temperature * r.time;
    };
    Report const early = report_after(scene, GetParam(), 8);
    Report const late = report_after(scene, GetParam(), 20);
    auto const run = start(scene, GetParam());
    run->advance(8);
    run->start_measuring();
    EXPECT_FALSE(run->report().pressure_z.has_value()) << "no time";
    run->advance(12);
    double const expected =
        1 + (virial(late) - virial(early)) / (late.temperature * (late.time - early.time));
    // A few roundings of the greatest of the numbers above.
    EXPECT_NEAR(*run->report().pressure_z, expected, 1e-13 * (1 + std::abs(*late.pressure_z)));
  }
}

TEST_P(Diagnostics, PressureIsUndefinedWithoutDiscsTimeOrMotion)
{
  Scene scene;
  scene.model = make_model(20, 10, 0, {});
  EXPECT_FALSE(report_after(scene, GetParam(), 5).pressure_z.has_value()) << "no discs";
  scene.discs = {{0, 0, 0, 0}};
  EXPECT_FALSE(report_after(scene, GetParam(), 5).pressure_z.has_value()) << "no motion";
  scene.discs = {{0, 0, 1, 0}};
  EXPECT_FALSE(report_after(scene, GetParam(), 0).pressure_z.has_value()) << "no time";
  EXPECT_EQ(report_after(scene, GetParam(), 5).pressure_z.value(), 1) << "an ideal gas";
}

TEST_P(Diagnostics, OfNoDiscsAreZero)
{
  Scene scene;
  scene.model = make_model(20, 10, 9.81, {});
  auto const report = report_after(scene, GetParam(), 3);
  EXPECT_EQ(report.discs, 0);
  EXPECT_EQ(report.steps, 3);
  EXPECT_EQ(report.temperature, 0);
  EXPECT_EQ(report.energy.kinetic, 0);
  EXPECT_EQ(report.energy.numerical, 0);
  EXPECT_EQ(report.max_overlap, 0);
  EXPECT_EQ(report.max_outside, 0);
}

TEST_P(Diagnostics, NameTheBackendAndItsThreads)
{
  Scene scene;
  scene.model = make_model(20, 10, 0, {});
  auto const engine = start(scene, GetParam());
  EXPECT_FALSE(engine->backend().empty());
  EXPECT_GE(engine->threads(), 1);
  if (engine->backend() == "Serial") {
    EXPECT_EQ(engine->threads(), 1);
  }
}

} // namespace
} // namespace ricochet::test
