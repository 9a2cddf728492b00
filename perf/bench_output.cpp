// What a trajectory costs: how fast frames reach a file beside plain writing of as many bytes, what
// the thread that writes them takes, and what writing takes from the steps.
//
// Times are the best of several rounds in which the things compared take turns, since machines are
// shared.

#include "scenes.hpp"

#include "exit_codes.hpp"
#include "frame_writer.hpp"
#include "output_file.hpp"
#include "trajectory_file.hpp"

#include <ricochet/engine.hpp>

#include <Kokkos_Core.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fcntl.h>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using namespace ricochet;
using namespace ricochet::driver;

constexpr int rounds = 31;

/// Seconds on the wall, and of all processors together.
struct Seconds {
  double wall, processor;
};

template <class Work>
Seconds seconds(Work const& work)
{
  auto const now = [](clockid_t clock) {
    timespec time{};
    ::clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  double const wall = now(CLOCK_MONOTONIC), processor = now(CLOCK_PROCESS_CPUTIME_ID);
  work();
  return {now(CLOCK_MONOTONIC) - wall, now(CLOCK_PROCESS_CPUTIME_ID) - processor};
}

/// Times of two things that took turns.
struct Times {
  double plain = 1e300, ours = 1e300; ///< best
  std::vector<double> ratios;         ///< ours / plain, of each round

  void add(double a, double b)
  {
    plain = std::min(plain, a);
    ours = std::min(ours, b);
    ratios.insert(std::upper_bound(ratios.begin(), ratios.end(), b / a), b / a);
  }
  double median() const { return ratios[ratios.size() / 2]; }

  /// In percent.
  double extra() const { return 100 * (ours / plain - 1); }
  double median_extra() const { return 100 * (median() - 1); }
};

TrajectoryHeader header_for(perf::Gas const& gas, std::string const& path, std::int64_t frames)
{
  TrajectoryHeader header;
  header.path = path;
  header.replace = true;
  header.model = gas.model;
  header.discs = static_cast<std::int64_t>(gas.discs.size());
  header.frames = frames;
  header.version = "bench_output";
  return header;
}

void write_plainly(std::string const& path, std::uint64_t bytes)
{
  constexpr std::size_t block = 4 << 20;
  static std::vector<char> const data(block, 'x');
  int const file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  for (std::uint64_t done = 0; done < bytes;) {
    ssize_t const now = ::write(file, data.data(), std::min<std::uint64_t>(block, bytes - done));
    if (now <= 0)
      throw Failure(Exit::io_error, "cannot write " + path);
    done += static_cast<std::uint64_t>(now);
  }
  ::fsync(file);
  ::close(file);
}

void write_frames(perf::Gas const& gas, std::string const& path, std::int64_t frames)
{
  TrajectoryFile file(header_for(gas, path, frames));
  FrameWriter writer(file, static_cast<std::int64_t>(gas.discs.size()));
  for (std::int64_t k = 0; k < frames; ++k) {
    auto frame = writer.borrow();
    frame->report.steps = k;
    frame->states = gas.discs;
    writer.submit(std::move(frame));
  }
  writer.finish();
  file.close();
  file.sync();
}

void compare_bandwidth(std::string const& folder, int discs)
{
  perf::Gas const gas = perf::gas(discs, 0.2, {}, 9.81);
  std::string const path = folder + "/bench_output.h5md", plain = folder + "/bench_output.raw";
  constexpr std::uint64_t amount = 160 << 20;
  std::uint64_t const frame = gas.discs.size() * 4 * sizeof(double); // as much as there is in it
  auto const frames = static_cast<std::int64_t>(amount / frame);
  Times times;
  for (int round = 0; round < rounds; ++round) {
    Seconds const a = seconds([&] { write_plainly(plain, amount); });
    Seconds const b = seconds([&] { write_frames(gas, path, frames); });
    times.add(a.wall, b.wall);
    ::unlink(path.c_str()); // to free the memory of a file takes as long as to write it
    ::unlink(plain.c_str());
  }
  std::printf("| %d | %s | %.0f | %.0f | %.0f %% | %.0f %% |\n", discs, folder.c_str(),
              static_cast<double>(amount) / 1e6 / times.plain,
              static_cast<double>(amount) / 1e6 / times.ours, 100 * times.plain / times.ours,
              100 / times.median());
}

// What a frame costs the thread that writes it: processor time, in which others take no part.
void time_writing(std::string const& folder, int discs)
{
  perf::Gas const gas = perf::gas(discs, 0.2, {}, 9.81);
  std::string const path = folder + "/bench_output.h5md";
  constexpr int blocks = 50;
  std::vector<double> appends, flushes;
  TrajectoryFile file(header_for(gas, path, 10000));
  std::vector<std::unique_ptr<Frame>> block(static_cast<std::size_t>(file.frames_per_block()));
  for (int k = 0; k < blocks; ++k) {
    for (auto& frame : block) {
      frame = std::make_unique<Frame>();
      frame->states = gas.discs;
    }
    appends.push_back(seconds([&] { file.append(block); }).processor);
    flushes.push_back(seconds([&] { file.flush(); }).processor);
  }
  file.close();
  ::unlink(path.c_str());
  auto const median = [](std::vector<double>& times) {
    std::sort(times.begin(), times.end());
    return 1e3 * times[times.size() / 2];
  };
  std::printf("| %d | %s | %zu | %.2f | %.2f |\n", discs, folder.c_str(), block.size(),
              median(appends), median(flushes));
}

// What frames cost the steps amid a run: the frame before is still to be written when time begins
// to count, as the last one is when it ends.
void compare_stepping(std::string const& folder, EngineKind kind, double q, std::int64_t stride,
                      Placement placement)
{
  constexpr int discs = 100000;
  Contact contact;
  contact.restitution = 0.93;
  contact.friction = 0.98;
  perf::Gas const gas = perf::gas(discs, 0.2, contact, 9.81);
  Method method;
  method.engine = kind;
  method.placement = placement;
  method.dt = q * 2 * gas.model.radius / gas.thermal_speed;
  auto const engine = make_engine(gas.model, method, gas.discs);
  engine->advance(50);
  Checkpoint const start = engine->checkpoint();
  std::string const path = folder + "/bench_output.h5md";
  constexpr std::int64_t frames = 4;
  auto const time_steps = [&](auto const& write_frame) {
    return seconds([&] {
      for (std::int64_t k = 0; k < frames; ++k) {
        engine->advance(stride);
        Kokkos::fence();
        write_frame();
      }
    });
  };
  TrajectoryFile file(header_for(gas, path, rounds * (frames + 1)));
  FrameWriter writer(file, discs);
  auto const write_frame = [&] {
    auto frame = writer.borrow();
    frame->report = engine->report();
    engine->states(frame->states.data());
    writer.submit(std::move(frame));
  };
  Times wall, processor;
  for (int round = 0; round < rounds; ++round) {
    engine->restore(start); // the gas would cool and fall
    Seconds const plain = time_steps([] {});
    engine->restore(start);
    write_frame();
    Seconds const ours = time_steps(write_frame);
    writer.flush();
    wall.add(plain.wall, ours.wall);
    processor.add(plain.processor, ours.processor);
  }
  writer.finish();
  file.close();
  ::unlink(path.c_str());
  std::printf("| `%s` | %g | %lld | %s x%d | %s | %.1f | %.1f | %+.1f %% | %+.1f %% | %+.1f %% |\n",
              name(kind), q, static_cast<long long>(stride), engine->backend().c_str(),
              engine->threads(), folder.c_str(), 1e3 * wall.plain / frames,
              1e3 * wall.ours / frames, wall.extra(), wall.median_extra(),
              processor.median_extra());
}

} // namespace

int main(int argc, char** argv)
{
  Kokkos::ScopeGuard const kokkos(argc, argv);
  std::setvbuf(stdout, nullptr, _IOLBF, 0); // a row is told when it is measured
  std::vector<std::string> folders(argv + 1, argv + argc);
  if (folders.empty()) {
    std::fprintf(stderr, "usage: bench_output FOLDER...\n");
    return 64;
  }
  try {
    std::printf("| discs | folder | plain, MB/s | trajectory, MB/s | ratio of the best | median |\n"
                "|---|---|---|---|---|---|\n");
    for (std::string const& folder : folders)
      for (int const discs : {2000, 100000})
        compare_bandwidth(folder, discs);
    std::printf("\n| discs | folder | frames in a chunk | writing them, ms | a flush, ms |\n"
                "|---|---|---|---|---|\n");
    for (std::string const& folder : folders)
      for (int const discs : {2000, 100000})
        time_writing(folder, discs);
    std::printf("\n| engine | q | stride | backend | folder | ms between frames, not written | "
                "written | cost by the best | median | of processor time, median |\n"
                "|---|---|---|---|---|---|---|---|---|---|\n");
    for (std::string const& folder : folders) // one thread leaves a core to the writer
      for (Placement const placement : {Placement::serial, Placement::parallel}) {
        compare_stepping(folder, EngineKind::sweep, 0.1, 20, placement);
        compare_stepping(folder, EngineKind::toi, 0.02, 50, placement);
      }
  } catch (std::exception const& error) {
    std::fprintf(stderr, "bench_output: %s\n", error.what());
    return 1;
  }
  return 0;
}
