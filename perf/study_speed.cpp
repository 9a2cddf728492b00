// How fast `sweep` and `toi` are, on one thread and on all, and what bounds it: their speed beside
// the correctness of `toi`, the price of each term, the bytes that the kernels move beside the
// bandwidth of the memory, the kernels of `sweep`, and its loop in order beside the way that it
// chooses.
//
//   study_speed [ROUNDS [PART]]   5 rounds, in which what is compared takes turns;
//                                 PART: speeds, correctness, terms, order, bounds or kernels; all
//                                 of them if left out

#include "scenes.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace ricochet;

constexpr double packings[] = {0.05, 0.2, 0.5};
constexpr double q_sweep = 0.1, q_toi = 0.02; ///< thermal speed x dt / diameter
int rounds = 5;

Contact const elastic{Law::swap_scale, 1, 1}, dissipative{Law::swap_scale, 0.93, 0.98};
constexpr double gravity = 9.81;

double seconds()
{
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Times of the same work again and again.
struct Times {
  std::vector<double> all; ///< [s]

  double best() const { return *std::min_element(all.begin(), all.end()); }
  double median() const
  {
    auto sorted = all;
    std::sort(sorted.begin(), sorted.end());
    return sorted[sorted.size() / 2];
  }
};

/// An engine at work on the time in which a disc at the thermal speed flies its diameter, always
/// from the same state, and from the second step on: a state comes in the order of ids, and a run
/// that goes on has stored it by cell.
class Work {
 public:
  Work(perf::Gas const& gas, EngineKind engine, double q, Placement placement,
       Execution execution = Execution::automatic)
    : steps_(std::lround(1 / q))
  {
    Method method;
    method.engine = engine;
    method.dt = q * 2 * gas.model.radius / gas.thermal_speed;
    method.placement = placement;
    method.execution = execution;
    simulation_ = make_engine(gas.model, method, gas.discs);
    start_ = simulation_->checkpoint();
  }

  /// Begins with a state several times as far on: the engine knows by then how to go about it.
  void begin_later()
  {
    simulation_->advance(8 * steps_);
    start_ = simulation_->checkpoint();
  }

  void begin()
  {
    simulation_->restore(start_);
    simulation_->advance(1);
    Kokkos::fence();
  }
  void go_on()
  {
    simulation_->advance(steps_);
    Kokkos::fence();
  }

  void measure()
  {
    begin();
    double const start = seconds();
    go_on();
    times_.all.push_back(seconds() - start);
  }

  /// Throws if the energy ledger of the last round does not close.
  Report report()
  {
    auto const report = simulation_->report();
    if (!(std::fabs(report.energy.residual()) <= 1e-12 * report.energy.initial()))
      throw std::runtime_error("the energy ledger does not close");
    return report;
  }

  Times const& times() const { return times_; }
  double disc_steps() const
  {
    return static_cast<double>(steps_) * static_cast<double>(start_.discs.size());
  }
  int threads() const { return simulation_->threads(); }

 private:
  std::int64_t steps_;
  std::unique_ptr<Engine> simulation_;
  Checkpoint start_;
  Times times_;
};

/// Contacts of a disc in a step.
double contacts_of_a_step(Report const& report)
{
  return static_cast<double>(report.collisions) / static_cast<double>(report.steps * report.discs);
}

void print_speeds(int discs)
{
  for (double const packing : packings) {
    auto const gas = perf::melted_gas(discs, packing, dissipative, gravity);
    for (auto const& [engine, q] :
         {std::pair{EngineKind::sweep, q_sweep}, std::pair{EngineKind::toi, q_toi}}) {
      Work one(gas, engine, q, Placement::serial), all(gas, engine, q, Placement::parallel);
      for (int round = 0; round <= rounds; ++round) {
        one.measure();
        all.measure();
      }
      auto const rate = [&](double time) { return one.disc_steps() / time / 1e6; };
      auto const &times = one.times(), &times_all = all.times();
      auto const report = one.report();
      all.report();
      std::printf("| `%s` | %g | %d | %g | %.4f | %.0f | %.0f | %.0f | %.0f | %.2f |\n",
                  name(engine), q, discs, packing, contacts_of_a_step(report), rate(times.best()),
                  rate(times.median()), rate(times_all.best()), rate(times_all.median()),
                  times.best() / times_all.best());
      std::fflush(stdout);
    }
  }
}

/// Collisions and pressure of `toi` beside those of `events`, from the same state of an elastic
/// gas in a periodic box.
void print_correctness(int discs)
{
  for (double const packing : packings) {
    auto gas = perf::melted_gas(discs, packing, elastic, 0);
    gas.model.box.x = gas.model.box.y = Boundary::periodic;
    double const time = 20 / perf::collision_rate(gas);
    auto const run = [&](EngineKind engine, double dt) {
      Method method;
      method.engine = engine;
      method.dt = dt;
      auto const simulation = make_engine(gas.model, method, gas.discs);
      simulation->advance(std::lround(time / dt));
      return simulation->report();
    };
    double const dt = q_toi * 2 * gas.model.radius / gas.thermal_speed;
    auto const exact = run(EngineKind::events, dt * static_cast<double>(std::lround(time / dt)));
    auto const toi = run(EngineKind::toi, dt);
    std::printf(
        "| %g | %.3f M | %+.2f %% | %.4f | %+.2f %% |\n", packing,
        static_cast<double>(exact.collisions) / 1e6,
        100 * (static_cast<double>(toi.collisions) / static_cast<double>(exact.collisions) - 1),
        *exact.pressure_z, 100 * (*toi.pressure_z / *exact.pressure_z - 1));
    std::fflush(stdout);
  }
}

/// Each term by itself in time, one thread: the same gas with more and more of what a scene can
/// require.
void print_prices(int discs, double packing)
{
  struct Scene {
    char const* terms;
    bool pairs, walls;
    double gravity;
    Contact contact;
  };
  Scene const scenes[] = {{"none (discs do not meet)", false, false, 0, elastic},
                          {"contacts", true, false, 0, elastic},
                          {"contacts, walls", true, true, 0, elastic},
                          {"contacts, walls, gravity", true, true, gravity, elastic},
                          {"contacts, walls, gravity, losses", true, true, gravity, dissipative}};
  auto const start = perf::melted_gas(discs, packing, elastic, 0);
  std::vector<std::unique_ptr<Work>> works;
  for (auto const& scene : scenes)
    for (auto const& [engine, q] :
         {std::pair{EngineKind::sweep, q_sweep}, std::pair{EngineKind::toi, q_toi}}) {
      auto gas = start;
      gas.model.contact = scene.contact;
      gas.model.contact.pairs = scene.pairs;
      gas.model.gravity = scene.gravity;
      gas.model.box.x = gas.model.box.y = scene.walls ? Boundary::walls : Boundary::periodic;
      works.push_back(std::make_unique<Work>(gas, engine, q, Placement::serial));
    }
  for (int round = 0; round <= rounds; ++round)
    for (auto const& work : works)
      work->measure();
  for (auto const& work : works)
    work->report();
  for (std::size_t k = 0; k < works.size(); k += 2)
    std::printf("| %s | %.2f | %.2f |\n", scenes[k / 2].terms,
                1e9 * works[k]->times().best() / works[k]->disc_steps(),
                1e9 * works[k + 1]->times().best() / works[k + 1]->disc_steps());
  std::fflush(stdout);
}

/// The way that `sweep` chooses beside the loop in order, in an elastic gas.
void print_order(int discs)
{
  for (double const packing : {0.2, 0.4, 0.5, 0.6, 0.7}) {
    auto const gas = perf::melted_gas(discs, packing, elastic, 0);
    for (double const q : {0.2, 0.1, 0.05}) {
      Work chosen(gas, EngineKind::sweep, q, Placement::serial),
          in_order(gas, EngineKind::sweep, q, Placement::serial, Execution::in_order),
          chosen_by_all(gas, EngineKind::sweep, q, Placement::parallel);
      Work* const works[] = {&chosen, &in_order, &chosen_by_all};
      for (auto* const work : works)
        work->begin_later();
      for (int round = 0; round <= rounds; ++round)
        for (auto* const work : works)
          work->measure();
      auto const time = [](Work const& work) { return work.times().best() / work.disc_steps(); };
      auto const report = in_order.report();
      std::printf("| %d | %g | %g | %.3f | %.0f | %.2f | %.2f |\n", discs, packing, q,
                  contacts_of_a_step(report), 1e9 * time(in_order), time(chosen) / time(in_order),
                  time(chosen_by_all) / time(in_order));
      std::fflush(stdout);
    }
  }
}

// What bounds it.

/// Time and number of launches of each kernel, from the hooks that Kokkos has for tools.
struct KernelTimes {
  struct Entry {
    double time = 0;
    std::int64_t launches = 0;
  };
  std::map<std::string, Entry> entries;
  std::string running;
  double began = 0;

  static KernelTimes& instance()
  {
    static KernelTimes times;
    return times;
  }

  static void begin(char const* kernel, std::uint32_t, std::uint64_t* id)
  {
    *id = 0;
    instance().running = kernel;
    instance().began = seconds();
  }
  static void end(std::uint64_t)
  {
    auto& entry = instance().entries[instance().running];
    entry.time += seconds() - instance().began;
    ++entry.launches;
  }

  /// Of what is measured of a work, so many times.
  static std::map<std::string, Entry> const& of(Work& work, int times)
  {
    work.measure();
    auto& entries = instance().entries;
    entries.clear();
    for (int time = 0; time < times; ++time) {
      work.begin();
      listen(true);
      work.go_on();
      listen(false);
    }
    return entries;
  }

 private:
  static void listen(bool yes)
  {
    using namespace Kokkos::Tools::Experimental;
    set_begin_parallel_for_callback(yes ? begin : nullptr);
    set_end_parallel_for_callback(yes ? end : nullptr);
    set_begin_parallel_reduce_callback(yes ? begin : nullptr);
    set_end_parallel_reduce_callback(yes ? end : nullptr);
    set_begin_parallel_scan_callback(yes ? begin : nullptr);
    set_end_parallel_scan_callback(yes ? end : nullptr);
  }
};

/// a = b + s c of three arrays that no cache holds; the bytes of one pass, in which the line of a
/// is read too before it is written, over the best time [B/s].
template <class Space>
double triad()
{
  int const n = 20000000;
  Kokkos::View<double*, Space> a("a", n), b("b", n), c("c", n);
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 10; ++round) {
    double const start = seconds();
    Kokkos::parallel_for(
        "triad", Kokkos::RangePolicy<Space, Kokkos::IndexType<int>>(0, n),
        KOKKOS_LAMBDA(int i) { a(i) = b(i) + 3 * c(i); });
    Kokkos::fence();
    best = std::min(best, seconds() - start);
  }
  return 32.0 * n / best;
}

/// Bytes that a kernel of `toi` in double precision must move for each disc, or, where it looks at
/// few of them, for each contact, if nothing stays in a cache from one kernel to the next: every
/// array once, and twice where it is written and not read.
struct Traffic {
  char const* kernel;
  double per_disc, per_contact;
};
constexpr double line = 64;
constexpr Traffic traffics[] = {
    {"ricochet::fly", 32 + 24, 0},            // x y vx vy; x y vy
    {"ricochet::count_in_cells", 16 + 16, 0}, // x y; cell, rank; and cells, half as many
    {"ricochet::store_by_cell", 32 + 4 + 8 + 2 * (32 + 4 + 4), 0}, // state id cell rank; all again
    {"ricochet::list_candidates", 32 + 4 + 4, 0},                  // state, cell, first of cell
    {"ricochet::find_extremes", 32, 0},
    // The lines of both discs (x y vx vy, contacts, call), those written twice.
    {"ricochet::find_among_candidates", 0, 2 * (4 + 2 * 2) * line},
    {"ricochet::choose_next", 0, 2 * (4 + 2) * line},
    {"ricochet::resolve_contacts", 0, 2 * (2 * 4 + 2) * line},
    // Three rows of cells for both, each a line or two of every array.
    {"ricochet::find_new_contacts", 0, (3 * 4 * 1.5 + 2 * 2) * line},
    {"ricochet::settle", 0, 2 * (4 + 2 * 2) * line},
};

template <class Space>
void print_bounds(int discs, double packing, Placement placement)
{
  double const bandwidth = triad<Space>();
  auto const gas = perf::melted_gas(discs, packing, dissipative, gravity);
  Work work(gas, EngineKind::toi, q_toi, placement);
  auto const& times = KernelTimes::of(work, 1);
  auto const report = work.report();
  double const disc_steps = work.disc_steps();
  double const contacts = static_cast<double>(report.collisions + report.wall_hits) *
                          (disc_steps / static_cast<double>(report.steps * report.discs));
  std::printf("\nN = %d, packing %g, %d threads; triad %.1f GB/s. A step of a disc:\n\n"
              "| kernel | ns | bytes | GB/s | share of triad |\n|---|---|---|---|---|\n",
              discs, packing, work.threads(), bandwidth / 1e9);
  double bytes_in_all = 0, time_in_all = 0, rest = 0;
  for (auto const& [kernel, entry] : times) {
    time_in_all += entry.time;
    auto const* const traffic =
        std::find_if(std::begin(traffics), std::end(traffics),
                     [&, &name = kernel](auto const& t) { return t.kernel == name; });
    if (traffic == std::end(traffics)) {
      rest += entry.time;
      continue;
    }
    double const bytes = traffic->per_disc * discs * static_cast<double>(entry.launches) +
                         traffic->per_contact * contacts;
    bytes_in_all += bytes;
    std::printf("| %s | %.2f | %.1f | %.1f | %.0f %% |\n", kernel.c_str() + 10,
                1e9 * entry.time / disc_steps, bytes / disc_steps, bytes / entry.time / 1e9,
                100 * bytes / entry.time / bandwidth);
  }
  std::printf("| all others | %.2f | | | |\n| **together** | %.2f | %.1f | %.1f | %.0f %% |\n",
              1e9 * rest / disc_steps, 1e9 * time_in_all / disc_steps, bytes_in_all / disc_steps,
              bytes_in_all / time_in_all / 1e9, 100 * bytes_in_all / time_in_all / bandwidth);
  std::fflush(stdout);
}

/// What the kernels of `sweep` take, in the mean of all rounds.
void print_kernels(double packing, Placement placement)
{
  constexpr std::array<int, 3> sizes{10000, 100000, 1000000};
  std::map<std::string, std::array<double, sizes.size()>> times;
  int threads = 0;
  for (std::size_t size = 0; size < sizes.size(); ++size) {
    auto const gas = perf::melted_gas(sizes[size], packing, dissipative, gravity);
    Work work(gas, EngineKind::sweep, q_sweep, placement);
    auto const& entries = KernelTimes::of(work, rounds);
    work.report();
    threads = work.threads();
    for (auto const& [kernel, entry] : entries) {
      double const time = 1e9 * entry.time / (rounds * work.disc_steps());
      times[kernel][size] += time;
      times["together"][size] += time;
    }
  }
  std::printf("\nPacking %g, %d threads. A step of a disc, ns:\n\n| kernel |", packing, threads);
  for (int const size : sizes)
    std::printf(" %d |", size);
  std::puts("\n|---|---|---|---|");
  for (auto const& [kernel, of_sizes] : times) {
    std::printf("| %s |", kernel.c_str());
    for (double const time : of_sizes)
      std::printf(" %.2f |", time);
    std::puts("");
  }
  std::fflush(stdout);
}

void run(std::string const& part)
{
  auto const wants = [&](char const* name) { return part.empty() || part == name; };
  if (wants("speeds")) {
    std::puts(
        "| engine | q | discs | packing | contacts a disc and step | one thread, best | median "
        "| all threads, best | median | gain |\n|---|---|---|---|---|---|---|---|---|---|");
    for (int const discs : {10000, 100000, 1000000})
      print_speeds(discs);
  }
  if (wants("correctness")) {
    std::puts("\n| packing | collisions | `toi` | Z | `toi` |\n|---|---|---|---|---|");
    print_correctness(100000);
  }
  if (wants("terms")) {
    std::puts("\n| terms | `sweep` | `toi` |\n|---|---|---|");
    print_prices(100000, 0.2);
  }
  if (wants("order")) {
    std::puts(
        "\n| discs | packing | q | contacts a disc and step | in order, ns | chosen, one thread "
        "| chosen, all threads |\n|---|---|---|---|---|---|---|");
    for (int const discs : {2000, 16000, 100000})
      print_order(discs);
  }
  if (wants("bounds"))
    for (int const discs : {100000, 1000000})
      for (double const packing : packings) {
        print_bounds<Kokkos::DefaultHostExecutionSpace>(discs, packing, Placement::parallel);
#if defined(KOKKOS_ENABLE_SERIAL)
        print_bounds<Kokkos::Serial>(discs, packing, Placement::serial);
#endif
      }
  if (wants("kernels"))
    for (double const packing : packings)
      for (auto const placement : {Placement::serial, Placement::parallel})
        print_kernels(packing, placement);
}

} // namespace

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  if (argc > 1)
    rounds = std::max(1, std::atoi(argv[1]));
  try {
    run(argc > 2 ? argv[2] : "");
  } catch (std::exception const& problem) {
    std::fprintf(stderr, "study_speed: %s\n", problem.what());
    return 1;
  }
  return 0;
}
