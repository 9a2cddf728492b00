// What runs of an engine must have in common with each other and with a reference, to the bit.
#pragma once

#include "support/compare.hpp"
#include "support/runs.hpp"

#include <cstdint>
#include <string>
#include <vector>

namespace ricochet::test {

/// A run of `steps` steps, taken one at a time, with a look at the state after each.
Run start_and_look(Scene const& scene, Way const& way, int steps);

/// A run that goes on from written states is the run that went on.
void expect_same_across_restart(Scene const& scene, Way const& way, std::int64_t before,
                                std::int64_t after);

/// More than a restart: the books, the clock and the measurement go on as well, on other threads
/// too.
void expect_same_from_checkpoint(Scene const& scene, Way const& way, std::int64_t before,
                                 std::int64_t after);

/// Takes a reference and two runs of the same scene to the same steps, where all must be equal. A
/// failure is fatal.
template <class Reference>
void expect_bits_of(Reference& reference, Run const& serial, Run const& parallel,
                    std::vector<std::int64_t> const& checked_steps)
{
  std::int64_t now = 0;
  for (auto const step : checked_steps) {
    SCOPED_TRACE("step " + std::to_string(step));
    reference.advance(step - now);
    serial->advance(step - now);
    parallel->advance(step - now);
    now = step;
    auto const expected = reference.states();
    ASSERT_TRUE(same_bits(states(serial), expected)) << "on one thread";
    ASSERT_TRUE(same_bits(states(parallel), expected)) << "on the default backend";
  }
}

} // namespace ricochet::test
