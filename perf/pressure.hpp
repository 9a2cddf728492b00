// The pressure of elastic hard discs: what is known of it, and means with their errors.
#pragma once

#include <ricochet/model.hpp>

#include <cmath>
#include <stdexcept>
#include <string>

namespace ricochet::perf {

/// Long runs of a serial event-driven program: 16,384 discs in a periodic box, 2,000 to 4,000
/// collisions a disc. `error` is one standard error.
struct Pressure {
  double packing, z, error;
};
constexpr Pressure pressures[] = {
    {0.05, 1.10834, 0.00002}, {0.10, 1.23615, 0.00006}, {0.20, 1.57033, 0.00017},
    {0.30, 2.0631, 0.0004},   {0.40, 2.8294, 0.0006},   {0.50, 4.1071, 0.0007},
    {0.55, 5.0869, 0.0007},   {0.60, 6.4535, 0.0009},   {0.65, 8.4121, 0.0015},
    {0.68, 9.832, 0.005},     {0.698, 10.335, 0.007},
};

inline Pressure const& pressure_at(double packing)
{
  for (auto const& pressure : pressures)
    if (pressure.packing == packing)
      return pressure;
  throw std::invalid_argument("no reference pressure at packing " + std::to_string(packing));
}

/// Collisions of a disc per time in a gas of pressure `z`: (4/sigma) (Z - 1) sqrt(T/pi). Exact in
/// equilibrium, where the closing speeds of discs that meet have the mean of Maxwell's velocities.
inline double enskog_rate(Model const& model, double z, double temperature)
{
  constexpr double pi = 3.14159265358979323846;
  return 4 / (2 * model.radius) * (z - 1) * std::sqrt(temperature / pi);
}

/// Mean of numbers that come one by one, and its standard error if they are independent.
class Mean {
 public:
  void enter(double value)
  {
    ++count_;
    double const step = value - mean_;
    mean_ += step / count_;
    squares_ += step * (value - mean_);
  }
  double value() const { return mean_; }
  double error() const { return std::sqrt(squares_ / (count_ - 1) / count_); }

 private:
  double count_ = 0, mean_ = 0, squares_ = 0;
};

} // namespace ricochet::perf
