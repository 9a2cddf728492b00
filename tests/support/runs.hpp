// Short ways to run an engine on a scene, and the ways in which every engine is run.
#pragma once

#include "ricochet/engine.hpp"
#include "support/scenes.hpp"

#include <memory>
#include <string>
#include <vector>

namespace ricochet::test {

/// What every law is tested for: each engine of the original's steps, each precision, on one thread
/// and on the default backend. `events` is another model and has tests of its own.
struct Way {
  EngineKind engine;
  Precision precision;
  Placement placement;
  Execution execution = Execution::automatic;
};

std::vector<Way> const& all_ways();
/// Those of them in double precision, and in single.
std::vector<Way> const& double_ways();
std::vector<Way> const& single_ways();
/// Those of them with engine `sweep` in double precision.
std::vector<Way> const& sweep_ways();

/// Both precisions of an engine, on one thread and on the default backend.
std::vector<Way> ways_of(EngineKind engine);

/// Such as "sweep_double_serial"; also for the names of parameterised tests.
std::string name(Way const& way);

/// For failure messages.
std::ostream& operator<<(std::ostream& out, Way const& way);

/// A simulation in progress.
struct Run {
  std::unique_ptr<Engine> engine;
  std::size_t discs;

  Engine* operator->() const { return engine.get(); }
};

Run start(Scene const& scene, Way const& way);

/// The present states, in id order.
std::vector<DiscState> states(Run const& run);

/// The states after `steps` steps.
std::vector<DiscState> states_after(Scene const& scene, Way const& way, std::int64_t steps);

/// The report after `steps` steps.
Report report_after(Scene const& scene, Way const& way, std::int64_t steps);

/// Length of a long run: `steps` on one thread, a tenth of it on the default backend. Bits are the
/// same on both (regression/), so what takes long to show is shown once; many short kernels on
/// several threads take minutes where the cores are shared with other work.
std::int64_t long_run(Way const& way, std::int64_t steps);

/// Unit round-off of a precision: the largest relative error of one rounded operation.
double round_off(Precision precision);

} // namespace ricochet::test
