// What a trajectory costs: how fast frames reach a file beside plain writing of as many bytes, and
// what writing takes from the steps.
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
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <string>
#include <unistd.h>
#include <vector>

namespace {

using namespace ricochet;
using namespace ricochet::driver;

constexpr int rounds = 5;

template <class Work>
double seconds(Work const& work)
{
  auto const start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Two things that take turns, and the seconds of each.
struct Comparison {
  double plain = 1e300, ours = 1e300; ///< best
  std::vector<double> ratios;         ///< ours / plain, of each round

  template <class Plain, class Ours>
  Comparison(Plain const& one, Ours const& other)
  {
    for (int round = 0; round < rounds; ++round) {
      double const a = seconds(one), b = seconds(other);
      plain = std::min(plain, a);
      ours = std::min(ours, b);
      ratios.push_back(b / a);
    }
    std::sort(ratios.begin(), ratios.end());
  }
  double median() const { return ratios[ratios.size() / 2]; }
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
  constexpr std::uint64_t amount = 240 << 20;
  std::uint64_t const frame = gas.discs.size() * 6 * sizeof(double);
  auto const frames = static_cast<std::int64_t>(amount / frame);
  Comparison const times([&] { write_plainly(plain, amount); },
                         [&] { write_frames(gas, path, frames); });
  std::printf("| %d | %s | %.0f | %.0f | %.0f %% | %.0f %% |\n", discs, folder.c_str(),
              static_cast<double>(amount) / 1e6 / times.plain,
              static_cast<double>(amount) / 1e6 / times.ours, 100 * times.plain / times.ours,
              100 / times.median());
  ::unlink(path.c_str());
  ::unlink(plain.c_str());
}

void compare_stepping(std::string const& folder, int discs, std::int64_t stride)
{
  Contact contact;
  contact.restitution = 0.93;
  contact.friction = 0.98;
  perf::Gas const gas = perf::gas(discs, 0.2, contact, 9.81);
  Method method;
  method.dt = 0.1 * 2 * gas.model.radius / gas.thermal_speed;
  auto const engine = make_engine(gas.model, method, gas.discs);
  engine->advance(50);
  std::string const path = folder + "/bench_output.h5md";
  constexpr std::int64_t frames = 10;
  auto const steps = [&](auto const& write_frame) {
    for (std::int64_t k = 0; k < frames; ++k) {
      engine->advance(stride);
      Kokkos::fence();
      write_frame();
    }
  };
  Comparison const times([&] { steps([] {}); },
                         [&] {
                           TrajectoryFile file(header_for(gas, path, frames));
                           FrameWriter writer(file, discs);
                           steps([&] {
                             auto frame = writer.borrow();
                             frame->report = engine->report();
                             engine->states(frame->states.data());
                             writer.submit(std::move(frame));
                           });
                           writer.finish();
                           file.close();
                         });
  std::printf("| %d | %lld | %s x%d | %s | %.1f | %.1f | %+.1f %% | %+.1f %% |\n", discs,
              static_cast<long long>(stride), engine->backend().c_str(), engine->threads(),
              folder.c_str(), 1e3 * times.plain / frames, 1e3 * times.ours / frames,
              100 * (times.ours / times.plain - 1), 100 * (times.median() - 1));
  ::unlink(path.c_str());
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
    std::printf(
        "\n| discs | stride | backend | folder | ms between frames, not written | written | "
        "cost by the best | median |\n|---|---|---|---|---|---|---|---|\n");
    for (std::string const& folder : folders)
      compare_stepping(folder, 100000, 20);
  } catch (std::exception const& error) {
    std::fprintf(stderr, "bench_output: %s\n", error.what());
    return 1;
  }
  return 0;
}
