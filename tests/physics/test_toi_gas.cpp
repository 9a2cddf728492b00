// Engine `toi`: the pressure of its gas, and how it falls behind with the length of the step.
#include "support/runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ricochet::test {
namespace {

constexpr auto periodic = Boundary::periodic;

struct Measured {
  double error;          ///< of Z, relative
  double standard_error; ///< of that
};

/// Error of Z at steps of q = v_th dt/diameter, from `blocks` blocks of `time` diameters/v_th each,
/// from the melted lattice on. Z of long event-driven runs is `expected`.
Measured error_of_z(double packing, double q, double expected, int blocks, double time)
{
  Scene scene = thermal_gas(500, packing, 0, {Law::swap_scale, 1, 1}, periodic, periodic);
  scene.dt = q;
  auto const steps = static_cast<std::int64_t>(std::lround(time / q));
  auto const run = start(scene, {EngineKind::toi, Precision::double_, Placement::serial});
  run->advance(steps);
  double sum = 0, squares = 0;
  for (int block = 0; block < blocks; ++block) {
    run->start_measuring();
    run->advance(steps);
    double const error = *run->report().pressure_z / expected - 1;
    sum += error;
    squares += error * error;
  }
  double const mean = sum / blocks;
  return {mean, std::sqrt((squares / blocks - mean * mean) / (blocks - 1))};
}

/// What is wrong in a step is that two discs meet which a third, deflected in the same step, would
/// have met before. It takes three contacts in one step, and c = rate dt of them each, so the share
/// of wrong contacts is c^2: the error falls as dt^2, by four when the step is halved. (Contacts
/// found late, of discs that overlap, would make it fall by two.) 500 discs and some 350,000
/// contacts give a standard error of 0.1 to 0.15 %, and the finite number of discs another 0.1 %.
/// Rows of numerics: at q = 0.2 and 0.1 errors of 43 and 24 % were found for a scheme that looks
/// for contacts once a step.
TEST(GasOfToi, HasAPressureWhoseErrorFallsAsTheSquareOfTheStep)
{
  double const expected = 4.1071; // packing 0.5, 1,000 times as long (kernels/README.md)
  auto const long_step = error_of_z(0.5, 0.4, expected, 20, 10);
  auto const half = error_of_z(0.5, 0.2, expected, 20, 10);
  auto const quarter = error_of_z(0.5, 0.1, expected, 20, 10);
  for (auto const& measured : {long_step, half, quarter})
    EXPECT_LT(measured.standard_error, 0.0025);
  EXPECT_NEAR(long_step.error, -0.0575, 0.0075);
  double const noise = 4 * std::hypot(half.standard_error, long_step.standard_error / 4) + 0.001;
  EXPECT_NEAR(half.error, long_step.error / 4, noise);
  EXPECT_LT(half.error, -0.006) << "so small an error cannot show how it falls";
  EXPECT_NEAR(quarter.error, long_step.error / 16, noise);
}

/// At steps in which a disc of a dilute gas crosses most of a diameter nothing is missed: grazing
/// collisions are found as all others (an engine that looks once a step misses q^2/4 of them, 16
/// %).
TEST(GasOfToi, MissesNoGrazingCollisions)
{
  auto const measured = error_of_z(0.05, 0.8, 1.10834, 20, 200);
  EXPECT_LT(measured.standard_error, 0.0005);
  EXPECT_NEAR(measured.error, 0, 4 * measured.standard_error + 0.0002);
}

} // namespace
} // namespace ricochet::test
