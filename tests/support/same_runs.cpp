#include "support/same_runs.hpp"

namespace ricochet::test {

Run start_and_look(Scene const& scene, Way const& way, int steps)
{
  auto run = start(scene, way);
  for (int step = 0; step < steps; ++step) {
    run->advance(1);
    run->report();
    run->state_hash();
  }
  return run;
}

void expect_same_across_restart(Scene const& scene, Way const& way, std::int64_t before,
                                std::int64_t after)
{
  SCOPED_TRACE(name(way));
  Scene later = scene;
  later.discs = states_after(scene, way, before);
  EXPECT_TRUE(same_bits(states_after(later, way, after), states_after(scene, way, before + after)));
}

void expect_same_from_checkpoint(Scene const& scene, Way const& way, std::int64_t before,
                                 std::int64_t after)
{
  SCOPED_TRACE(name(way));
  auto const whole = start(scene, way);
  whole->advance(before / 2);
  whole->start_measuring();
  whole->advance(before - before / 2);
  Checkpoint const checkpoint = whole->checkpoint();
  whole->advance(after);

  for (auto const placement : {Placement::serial, Placement::parallel}) {
    Way elsewhere = way;
    elsewhere.placement = placement;
    auto const resumed = start(scene, elsewhere);
    resumed->advance(1); // nothing of what it did before may be left
    resumed->restore(checkpoint);
    resumed->advance(after);
    EXPECT_TRUE(same_bits(states(resumed), states(whole)));
    EXPECT_TRUE(same_bits(resumed->report(), whole->report()));
    EXPECT_EQ(resumed->report().windows, whole->report().windows); // how long the next should be
  }
}

} // namespace ricochet::test
