// The one interface of all engines: advance the state to a given time, report.
//
// This is the door for programs that use the library: no Kokkos type appears in it. Kokkos must be
// initialised before make_engine() and finalised after the last engine is gone.
#pragma once

#include "ricochet/model.hpp"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace ricochet {

/// The rungs of the speed-accuracy ladder; kernels/README.md describes each.
enum class EngineKind {
  sweep,        ///< the original's sequential model, fixed step
  simultaneous, ///< the original's parallel variant, fixed step; gains energy
  toi,          ///< fixed step, second order: contacts at their time of impact inside the step
  events        ///< exact: every collision at its time; a step is only the distance of frames
};

/// Number format of the state and of all arithmetic on it.
enum class Precision { single_, double_ };

/// Where the kernels run.
enum class Placement {
  automatic, ///< the default backend, or one thread where more would not pay
  serial,    ///< one thread of the host, which may be another for each engine at the same time
  parallel   ///< the default backend, whatever the size
};

/// How `sweep` executes its ordered loop. The result is the same, to the bit.
enum class Execution {
  automatic, ///< by islands; where they are too large, in rounds on a device, in order on a host
  islands,   ///< always by islands, whatever their size
  crowd,     ///< all islands of a step together, by one thread
  rounds,    ///< all pairs at once that are the next of both their discs, round by round
  in_order   ///< the loop as it is written, by one thread
};

/// How a model is simulated.
struct Method {
  EngineKind engine = EngineKind::sweep;
  Precision precision = Precision::double_;
  double dt = 1.0 / 45; ///< length of a step [time], > 0, finite
  Placement placement = Placement::automatic;
  Execution execution = Execution::automatic;
};

/// How many steps of `sweep` were executed in which way: by islands only, with a crowd of large
/// islands besides, in rounds, or in order.
struct ExecutionCounts {
  std::int64_t islands = 0, crowd = 0, rounds = 0, in_order = 0;
};

/// Where the energy went. `numerical` is what the method itself created (positive) or destroyed
/// (negative), summed from its sources; it is never the remainder. In exact arithmetic
///   kinetic + potential + lost_pairs + lost_walls - numerical = kinetic_initial +
///   potential_initial.
struct EnergyLedger {
  double kinetic_initial = 0;
  double potential_initial = 0; ///< gravity times the sum of (y + height/2)
  double kinetic = 0;
  double potential = 0;
  double lost_pairs = 0; ///< taken out by the contact law between discs
  double lost_walls = 0; ///< taken out by the contact rule at the walls
  double numerical = 0;

  double initial() const { return kinetic_initial + potential_initial; }
  /// What does not add up: rounding, and nothing else.
  double residual() const
  {
    return (kinetic - kinetic_initial) + (potential - potential_initial) + lost_pairs + lost_walls -
           numerical;
  }
};

/// The state of a run in numbers. All of them are the same, bit for bit, for any number of threads.
struct Report {
  std::int64_t discs = 0;
  std::int64_t steps = 0;           ///< since the start
  std::int64_t windows = 0;         ///< of `events`: into how many windows it divided them
  double time = 0;                  ///< steps dt
  std::int64_t collisions = 0;      ///< pair contacts that were resolved
  std::int64_t separating_hits = 0; ///< those of them whose discs were not approaching
  std::int64_t wall_hits = 0;
  ExecutionCounts executions;
  /// Deepest overlap of two discs, at the start or when a contact was resolved [diameters].
  double max_overlap = 0;
  /// Farthest a disc's edge was beyond a wall, at the start or after any step [diameters].
  double max_outside = 0;
  EnergyLedger energy;
  double momentum_x = 0, momentum_y = 0;
  double temperature = 0; ///< sum of |v|^2 / 2N, lab frame
  /// Z = 1 + sum over collisions of (change of momentum . r_ij) / (2 N T t), with the present
  /// temperature, over the time t since the measurement began; empty while it is undefined (no
  /// discs, no time or no motion).
  std::optional<double> pressure_z;
};

/// With the scene, all that a run's future depends on: another engine goes on from it as the one
/// that gave it would, with the same bits in states and reports.
struct Checkpoint {
  std::vector<DiscState> discs;                 ///< in id order
  std::map<std::string, std::int64_t> integers; ///< the books and the clock, by name
  std::map<std::string, double> reals;
};

/// Thrown by an engine that cannot go on because discs stay in contact: which discs, where and
/// when.
class LastingContact : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// A simulation in progress.
class Engine {
 public:
  virtual ~Engine() = default;

  /// Takes `steps` >= 0 steps. Returns at once where the backend is asynchronous. Throws
  /// std::runtime_error if the engine cannot go on; the state is then of no use.
  virtual void advance(std::int64_t steps) = 0;

  /// Begins the measurement of Report::pressure_z anew.
  virtual void start_measuring() = 0;

  /// The state of the run after the last step.
  virtual Report report() = 0;

  /// Writes the present states, in id order (the order of the initial states), to `out[0...discs)`.
  virtual void states(DiscState* out) = 0;

  /// A 64-bit fingerprint of the states in id order, as binary64. Equal states have equal
  /// fingerprints on every machine.
  virtual std::uint64_t state_hash() = 0;

  /// What the run has come to.
  virtual Checkpoint checkpoint() = 0;

  /// Goes on from `checkpoint`, given by an engine that was made with the same model, initial
  /// states and method, apart from its placement. Throws std::invalid_argument if that cannot be.
  virtual void restore(Checkpoint const& checkpoint) = 0;

  /// What a user of this engine should know about this scene; empty if nothing.
  virtual std::vector<std::string> warnings() const = 0;

  /// Kokkos name of the backend the kernels run on, such as "OpenMP".
  virtual std::string backend() const = 0;

  /// Threads of that backend (1 for Serial).
  virtual int threads() const = 0;
};

/// Starts a simulation from `initial`, whose index becomes the disc's id.
/// Throws std::invalid_argument, naming every problem, if the model, the method or a disc is not
/// acceptable, and std::runtime_error if the build breaks the rules of reproducible arithmetic.
std::unique_ptr<Engine> make_engine(Model const& model, Method const& method,
                                    std::vector<DiscState> const& initial);

/// Name of an engine as it stands in scenes and on the command line, such as "sweep".
char const* name(EngineKind engine);
char const* name(Law law);
/// Of the law that discs follow when they meet; "none" if they do not.
char const* name_of_law(Contact const& contact);
char const* name(Precision precision);

/// All engines, in the order of the ladder.
std::vector<EngineKind> const& engine_kinds();

} // namespace ricochet
