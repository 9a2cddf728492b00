// Kills runs at random moments: whatever was flushed is there, and the job goes on to its result.
//
//   kill_campaign [KILLS [SEED]]      prints what was hit; exit code 1 if anything was lost
#include "checkpoint_file.hpp"
#include "process.hpp"
#include "trajectory_reader.hpp"

#include "exit_codes.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <stdexcept>
#include <thread>

namespace ricochet::test {
namespace {

namespace fs = std::filesystem;
using driver::TrajectoryReader;

// What is run: sizes at which writing takes a good part of the time.
struct Kind {
  std::string name, count, steps, box, compress, checkpoint_every;
};
Kind const kinds[] = {
    {"many chunks", "3000", "600", "740", "none", "0.05"},
    {"compressed", "3000", "300", "740", "deflate", "0.05"},
    {"large frames", "60000", "100", "3300", "none", "0.05"},
    {"many checkpoints", "20000", "300", "1900", "none", "0.001"},
};

void require(bool holds, std::string const& what)
{
  if (!holds)
    throw std::runtime_error(what);
}

/// A job, and how it goes on.
struct Job {
  Folder folder;
  Kind kind;

  explicit Job(Kind const& what) : kind(what) {}

  std::string trajectory() const { return folder / "t.h5md"; }
  bool is_writing_checkpoint() const { return fs::exists(folder / ".t.chk.h5.tmp"); }
  std::vector<std::string> arguments() const
  {
    return {"run",
            scene("random_2000.toml"),
            "--set",
            "discs.generate.count=" + kind.count,
            "--set",
            "box.width=" + kind.box,
            "--set",
            "box.height=" + kind.box,
            "--steps",
            kind.steps,
            "--engine",
            "sweep",
            "--every",
            "1",
            "--compress",
            kind.compress,
            "-o",
            trajectory(),
            "--json",
            folder / "t.json",
            "--resume",
            "auto",
            "--checkpoint-every",
            kind.checkpoint_every,
            "-q"};
  }
  std::int64_t checkpointed_frames() const
  {
    try {
      return driver::read_checkpoint(folder / "t.chk.h5").frames;
    } catch (driver::Failure const&) {
      return 0;
    }
  }
};

/// The bits of all frames, as one number for each.
std::vector<std::size_t> fingerprints(std::string const& path)
{
  TrajectoryReader const file(path);
  std::vector<std::size_t> all;
  std::vector<double> values(static_cast<std::size_t>(file.discs()));
  auto const kinetic = file.observable("kinetic"), hits = file.observable("collisions"),
             times = file.times();
  for (std::int64_t frame = 0; frame < file.frames(); ++frame) {
    auto const at = static_cast<std::size_t>(frame);
    require(file.steps()[at] == frame, "a frame is missing, or there twice");
    std::string bits;
    auto const add = [&](void const* data, std::size_t bytes) {
      bits.append(static_cast<char const*>(data), bytes);
    };
    for (char const* field : {"position", "velocity"})
      for (int component = 0; component < 3; ++component) {
        file.read(field, component, frame, 0, file.discs(), values.data());
        add(values.data(), values.size() * sizeof(double));
      }
    for (auto const* list : {&kinetic, &hits, &times})
      add(&list->at(at), sizeof(double));
    all.push_back(std::hash<std::string>{}(bits));
  }
  return all;
}

// Whether the kill hit a flush: there is more in the file than its head knows of, or it knows of
// more than is counted.
bool is_amid_write(std::string const& path)
{
  constexpr std::streamoff end_of_file = 28; // in a superblock of version 2
  std::ifstream file(path, std::ios::binary);
  std::uint64_t known = 0;
  file.seekg(end_of_file).read(reinterpret_cast<char*>(&known), sizeof known);
  return fs::file_size(path) != known;
}

class Campaign {
 public:
  Campaign(int kills, unsigned seed) : kills_(kills), random_(seed) {}
  void run();

 private:
  void run_job(Kind const& kind);
  void look(Job const& job, std::int64_t seen);

  /// Whether there are kills to come: too few were done, or they did not hit what they have to.
  bool goes_on() const
  {
    bool const hit = in_trajectory_ > 0 && in_checkpoint_ > 0;
    return killed_ < kills_ || (!hit && killed_ < 10 * kills_);
  }

  int kills_;
  std::mt19937 random_;
  std::map<std::string, std::vector<std::size_t>> whole_; ///< of runs that nobody killed
  int killed_ = 0, finished_ = 0, in_trajectory_ = 0, in_checkpoint_ = 0, before_any_frame_ = 0;
};

// What must hold after a kill.
void Campaign::look(Job const& job, std::int64_t seen)
{
  if (!fs::exists(job.trajectory())) {
    require(seen == 0, "the trajectory is gone");
    ++before_any_frame_;
    return;
  }
  in_trajectory_ += is_amid_write(job.trajectory());
  in_checkpoint_ += job.is_writing_checkpoint();
  auto const there = fingerprints(job.trajectory());
  auto const& whole = whole_[job.kind.name];
  require(static_cast<std::int64_t>(there.size()) >= seen, "a flushed frame is lost");
  require(there.size() <= whole.size(), "there are too many frames");
  require(std::equal(there.begin(), there.end(), whole.begin()), "a frame is torn");
}

// Waits until a checkpoint is being written, or does not come. Where disks are fast, random moments
// hardly ever hit one.
void await_checkpoint(Job const& job, Process& process)
{
  for (int tries = 0; tries < 20000 && process.is_running() && !job.is_writing_checkpoint();
       ++tries)
    std::this_thread::sleep_for(std::chrono::microseconds(50));
}

// Kills a job over and over until it ends all the same.
void Campaign::run_job(Kind const& kind)
{
  Job const job(kind);
  if (whole_[kind.name].empty()) {
    Outcome const outcome = ricochet(job.arguments());
    require(outcome.code == 0, outcome.err);
    whole_[kind.name] = fingerprints(job.trajectory());
    return;
  }
  while (goes_on()) {
    Process process(job.arguments());
    std::this_thread::sleep_for(
        std::chrono::microseconds(std::uniform_int_distribution<int>(50000, 700000)(random_)));
    if (killed_ % 2 == 1)
      await_checkpoint(job, process);
    // A frame that a checkpoint counts was flushed.
    std::int64_t const seen = job.checkpointed_frames();
    process.kill();
    Outcome const outcome = process.wait();
    require(outcome.code == 0 || outcome.code == 128 + SIGKILL, outcome.err);
    if (outcome.code == 0)
      break;
    ++killed_;
    look(job, seen);
  }
  Outcome const outcome = ricochet(job.arguments());
  require(outcome.code == 0, outcome.err);
  require(fingerprints(job.trajectory()) == whole_[kind.name], "the result is another");
  ++finished_;
}

void Campaign::run()
{
  for (Kind const& kind : kinds) // first the runs that nobody kills
    run_job(kind);
  for (std::size_t k = 0; goes_on(); ++k)
    run_job(kinds[k % std::size(kinds)]);
  std::printf("%d kills, %d jobs finished with the right result\n"
              "%d kills amid a write of the trajectory, %d of a checkpoint, %d before a file\n",
              killed_, finished_, in_trajectory_, in_checkpoint_, before_any_frame_);
  require(in_trajectory_ > 0 && in_checkpoint_ > 0, "no kill hit a write: sizes are wrong");
}

} // namespace
} // namespace ricochet::test

int main(int argc, char** argv)
{
  constexpr int short_campaign = 30;
  int const kills = argc > 1 ? std::atoi(argv[1]) : short_campaign;
  unsigned const seed = argc > 2 ? static_cast<unsigned>(std::atoi(argv[2])) : 1;
  try {
    ricochet::test::Campaign(kills, seed).run();
    return 0;
  } catch (std::exception const& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
