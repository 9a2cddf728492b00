// Statistics of a dilute gas under engine `sweep`: how fast it collides, cools and pushes.
//
// Tolerances are those of the statistics: 4 standard errors, plus what the theory itself leaves
// out. Seeds are fixed and results are reproducible, so a test that passes keeps passing.
#include "support/runs.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

constexpr double pi = 3.14159265358979323846;
constexpr std::size_t count = 10000;
constexpr double packing = 0.1;
Way const way{EngineKind::sweep, Precision::double_, Placement::serial};

/// An elastic gas at temperature 1 on a torus, made to collide five times per disc: positions start
/// on a lattice and velocity components are uniform, but by then nothing is left of that. One step
/// moves a disc by 2 % of its diameter.
Scene gas_in_equilibrium()
{
  Scene scene;
  double const side = std::sqrt(count * pi / packing);
  scene.model =
      make_model(side, side, 0, {Law::swap_scale, 1, 1}, Boundary::periodic, Boundary::periodic);
  scene.dt = 0.02 * 2;
  scene.discs = lattice_discs(scene.model, count, std::sqrt(3.0), 71);
  scene.discs = states_after(scene, way, 500);
  return scene;
}

/// ln(E/E0) / c after about two collisions per disc, c = collisions per disc.
double cooling_rate(Contact const& contact)
{
  auto scene = gas_in_equilibrium();
  scene.model.contact = contact;
  auto const report = report_after(scene, way, 220);
  double const c = 2.0 * static_cast<double>(report.collisions) / count;
  EXPECT_GT(c, 1.5);
  EXPECT_LT(c, 3);
  return std::log(report.energy.kinetic / report.energy.kinetic_initial) / c;
}

// A collision loses (1-alpha^2) T of the relative normal motion (its square is 4T on average for
// pairs that collide) and (1-beta^2) T/2 of the tangential (2T), so E/E0 = exp(-c rate) with
// rate = [(1-alpha^2) + (1-beta^2)/2]/2. Over n = 10 000 collisions, each of which loses about as
// much as the next, the standard error is about 1 % of the rate; the Gaussian estimate itself is
// off by up to 1 % here.
TEST(Cooling, UnderRestitutionFollowsHaffsLaw)
{
  for (auto const& [alpha, beta] : {std::pair{0.93, 1.0}, {1.0, 0.8}, {0.8, 0.9}}) {
    double const rate = ((1 - alpha * alpha) + (1 - beta * beta) / 2) / 2;
    EXPECT_NEAR(cooling_rate({Law::restitution, alpha, beta}), -rate, 0.05 * rate)
        << "alpha " << alpha << ", beta " << beta;
  }
}

// The original's rule damps the pair's common motion too: a loss of T [3/2 (1-alpha^2) +
// (1-beta^2)] a collision. Its velocities are less Gaussian; 3 % are allowed for that.
TEST(Cooling, UnderTheOriginalsLawIsFasterByItsCommonMotion)
{
  for (auto const& [alpha, beta] : {std::pair{0.93, 0.93}, {0.9, 1.0}, {1.0, 0.9}}) {
    double const rate = (1.5 * (1 - alpha * alpha) + (1 - beta * beta)) / 2;
    EXPECT_NEAR(cooling_rate({Law::swap_scale, alpha, beta}), -rate, 0.05 * rate)
        << "alpha " << alpha << ", beta " << beta;
  }
}

/// About ten more collisions per disc of the elastic gas.
struct Measured {
  Report report;
  std::vector<DiscState> discs;
};

Measured measured()
{
  auto const run = start(gas_in_equilibrium(), way);
  run->advance(1000);
  return {run->report(), states(run)};
}

// Event-driven truth at packing 0.1: Z = 1.23615. The scheme acts as discs of diameter
// sigma (1 - 0.7 q) with q = v dt/sigma = 0.02, which lowers Z - 1 by 2.8 % and a little; 50 000
// collisions leave a standard error of 0.5 %.
TEST(Gas, HasThePressureOfItsPacking)
{
  double const z = measured().report.pressure_z.value();
  EXPECT_NEAR(z - 1, 0.23615, 0.05 * 0.23615);
}

// Event-driven truth at packing 0.1: 0.5329 sqrt(T)/sigma collisions per disc and time. The rate of
// a gas near equilibrium fluctuates less than that of independent events, 1/sqrt(50 000) = 0.4 %.
TEST(Gas, CollidesAtTheRateOfItsPacking)
{
  auto const report = measured().report;
  double const rate = 2.0 * static_cast<double>(report.collisions) / (count * report.time);
  double const expected = 0.5329 * std::sqrt(report.temperature) / 2;
  EXPECT_NEAR(rate, expected, 0.015 * expected);
}

/// <v^4>/<v^2>^2 of numbers.
double kurtosis(std::vector<double> const& numbers)
{
  double second = 0, fourth = 0;
  for (double const v : numbers) {
    second += v * v;
    fourth += v * v * v * v;
  }
  return fourth * static_cast<double>(numbers.size()) / (second * second);
}

// Maxwell: 3 for a component, 2 for the speed. They started at 1.8 and 1.4. The standard errors are
// sqrt(24/20 000) = 0.035 and sqrt(20/10 000) = 0.045.
TEST(Gas, ForgetsItsStartAndHasMaxwellsVelocities)
{
  std::vector<double> components, speeds;
  for (auto const& d : measured().discs) {
    components.insert(components.end(), {d.vx, d.vy});
    speeds.push_back(std::hypot(d.vx, d.vy));
  }
  EXPECT_NEAR(kurtosis(components), 3, 4 * 0.035);
  EXPECT_NEAR(kurtosis(speeds), 2, 4 * 0.045);
}

} // namespace
} // namespace ricochet::test
