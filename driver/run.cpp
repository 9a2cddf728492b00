#include "run.hpp"

#include "final_states.hpp"
#include "frame_writer.hpp"
#include "json_output.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "provenance.hpp"
#include "scene.hpp"
#include "summary.hpp"
#include "text.hpp"
#include "trajectory_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

namespace ricochet::driver {

namespace {

// Refuses what cannot be written, and outputs in place of inputs or of one another.
void check_outputs(RunOptions const& options)
{
  std::vector<std::string> outputs;
  for (std::string const& path : {options.output, options.final_file, options.json})
    if (!path.empty() && path != "-")
      outputs.push_back(path);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    for (std::string const& input : {options.states, options.config})
      if (!input.empty() && same_file(outputs[i], input))
        throw Failure(Exit::cannot_create,
                      fmt::format("cannot create '{}': it is an input", outputs[i]));
    for (std::size_t j = 0; j < i; ++j)
      if (same_file(outputs[i], outputs[j]))
        throw Failure(Exit::usage, fmt::format("'{}' is named for two outputs", outputs[i]));
    check_output(outputs[i], options.force);
  }
}

bool is_finite(DiscState const& disc)
{
  return std::isfinite(disc.x) && std::isfinite(disc.y) && std::isfinite(disc.vx) &&
         std::isfinite(disc.vy);
}

// A run in progress.
class Run {
 public:
  Run(RunOptions const& options, Scene scene);
  void go();

 private:
  void open_trajectory();
  void step_to_the_end();
  void write_frame(Report const& report);
  void close_trajectory();
  void check_state(Report const& report);
  void fetch_states();
  void write_results();
  Summary summary() const;

  RunOptions const& options_;
  Scene scene_;
  std::unique_ptr<Engine> engine_;
  std::int64_t discs_;
  std::vector<std::string> warnings_;
  std::unique_ptr<TrajectoryFile> trajectory_;
  std::unique_ptr<FrameWriter> writer_;
  double wall_seconds_ = 0;
  std::vector<DiscState> states_; ///< at the end, if anyone asks
  std::string broken_;            ///< why the state is no longer one; empty while it is
  std::vector<std::string> outputs_;
};

Run::Run(RunOptions const& options, Scene scene)
  : options_(options),
    scene_(std::move(scene)),
    discs_(static_cast<std::int64_t>(scene_.discs.size()))
{
  try {
    engine_ = make_engine(scene_.model, scene_.method, scene_.discs);
  } catch (std::invalid_argument const& error) {
    throw Failure(Exit::bad_data, error.what());
  }
  std::vector<DiscState>().swap(scene_.discs); // the engine has its own
  warnings_ = engine_->warnings();
  for (std::string const& warning : warnings_)
    std::fprintf(stderr, "warning: %s\n", warning.c_str());
}

void Run::go()
{
  if (!options_.output.empty())
    open_trajectory();
  step_to_the_end();
  close_trajectory();
  write_results();
  if (!broken_.empty())
    throw Failure(Exit::failed, broken_);
}

void Run::open_trajectory()
{
  TrajectoryHeader header;
  header.path = options_.output;
  header.replace = options_.force;
  header.model = scene_.model;
  header.method = scene_.method;
  header.discs = discs_;
  header.steps = scene_.steps;
  header.every = scene_.every;
  header.frames = planned_frames(scene_.steps, scene_.every);
  header.velocity = options_.velocity;
  header.float32 = options_.float32;
  header.deflate = options_.compression == Compression::deflate ||
                   (options_.compression == Compression::automatic &&
                    worth_compressing(discs_, header.frames, scene_.every));
  header.version = version();
  header.texts = {{"scene", scene_.config.text},
                  {"states_file", options_.states},
                  {"initial_state_hash", hash_text(engine_->state_hash())},
                  {"command_line", options_.command_line},
                  {"kokkos_configuration", kokkos_configuration()},
                  {"provenance", provenance_text()}};
  trajectory_ = std::make_unique<TrajectoryFile>(header);
  writer_ = std::make_unique<FrameWriter>(*trajectory_, discs_);
}

void Run::step_to_the_end()
{
  using Clock = std::chrono::steady_clock;
  // Long enough that looking at the clock costs nothing, short enough for a lively bar.
  constexpr double lively = 0.05; // seconds

  Progress progress(Progress::style_for(options_.kokkos.quiet), discs_, scene_.steps);
  if (writer_)
    write_frame(engine_->report());
  std::int64_t batch = 1;
  for (std::int64_t step = 0; step < scene_.steps && broken_.empty();) {
    std::int64_t until = std::min(scene_.steps, step + batch);
    if (writer_)
      until = std::min(until, (step / scene_.every + 1) * scene_.every);
    auto const start = Clock::now();
    engine_->advance(until - step);
    fence();
    std::chrono::duration<double> const spent = Clock::now() - start;
    wall_seconds_ += spent.count();
    if (spent.count() < lively && until - step == batch)
      batch *= 2;
    else if (spent.count() > 2 * lively)
      batch = std::max<std::int64_t>(1, batch / 2);
    step = until;

    bool const is_frame = writer_ && (step % scene_.every == 0 || step == scene_.steps);
    bool const is_due = progress.is_due();
    if (is_frame || is_due) {
      Report const report = engine_->report();
      if (is_frame)
        write_frame(report);
      if (is_due)
        progress.update(step, report.energy.kinetic + report.energy.potential);
      check_state(report);
    }
  }
}

void Run::write_frame(Report const& report)
{
  std::unique_ptr<Frame> frame = writer_->borrow();
  frame->report = report;
  engine_->states(frame->states.data());
  writer_->submit(std::move(frame));
}

void Run::close_trajectory()
{
  if (!writer_)
    return;
  writer_->finish();
  trajectory_->close();
  std::int64_t const frames = trajectory_->frames();
  writer_.reset();
  trajectory_.reset();
  std::error_code ignored;
  auto const bytes = std::filesystem::file_size(options_.output, ignored);
  outputs_.push_back(fmt::format("{} ({} frames, {:.1f} MB)", options_.output, frames,
                                 static_cast<double>(bytes) / 1e6));
}

// A speed may be so large that its square is infinite; only the state itself tells.
void Run::check_state(Report const& report)
{
  if (std::isfinite(report.energy.kinetic) && std::isfinite(report.energy.potential))
    return;
  fetch_states();
  auto const lost = std::find_if_not(states_.begin(), states_.end(), is_finite);
  if (lost != states_.end())
    broken_ = fmt::format("disc {} is no longer finite at step {}: x={} y={} vx={} vy={} (the "
                          "numbers of this scene are too large, or its steps too long)",
                          lost - states_.begin(), report.steps, shortest(lost->x),
                          shortest(lost->y), shortest(lost->vx), shortest(lost->vy));
}

void Run::fetch_states()
{
  states_.resize(static_cast<std::size_t>(discs_));
  engine_->states(states_.data());
}

Summary Run::summary() const
{
  Summary s;
  s.engine = name(scene_.method.engine);
  s.law = name(scene_.model.contact.law);
  s.precision = name(scene_.method.precision);
  s.backend = engine_->backend();
  s.threads = engine_->threads();
  s.dt = scene_.method.dt;
  s.wall_seconds = wall_seconds_;
  s.packing_fraction = packing_fraction(scene_.model, static_cast<std::size_t>(discs_));
  s.state_hash = engine_->state_hash();
  s.report = engine_->report();
  s.warnings = warnings_;
  return s;
}

void Run::write_results()
{
  Summary result = summary();
  if (broken_.empty())
    check_state(result.report);

  bool const to_nowhere =
      options_.output.empty() && options_.final_file.empty() && options_.json.empty();
  std::string const final_file = to_nowhere ? "-" : options_.final_file;
  if (!final_file.empty() && broken_.empty()) {
    fetch_states();
    OutputFile file(final_file, options_.force);
    write_states(file, states_);
    file.commit();
    if (final_file != "-")
      outputs_.push_back(final_file);
  }
  if (!options_.json.empty()) {
    OutputFile file(options_.json, options_.force);
    file.write(as_json(result));
    file.commit();
    if (options_.json != "-")
      outputs_.push_back(options_.json);
  }
  result.outputs = outputs_;
  if (!options_.kokkos.quiet)
    std::fputs(in_words(result).c_str(), stderr);
}

} // namespace

std::int64_t planned_frames(std::int64_t steps, std::int64_t every)
{
  return 1 + steps / every + (steps % every != 0);
}

bool worth_compressing(std::int64_t discs, std::int64_t frames, std::int64_t every)
{
  constexpr double small_file = 16e6; // bytes; whatever they hold is not worth the trouble
  constexpr std::int64_t steps_that_hide_it = 100;
  double const bytes =
      static_cast<double>(discs) * static_cast<double>(frames) * sizeof(double) * 6;
  return bytes > small_file && every >= steps_that_hide_it;
}

Exit run(RunOptions const& options)
{
  check_outputs(options);
  Scene scene = read_scene(options);
  KokkosSession const kokkos(options.kokkos);
  Run(options, std::move(scene)).go();
  return Exit::done;
}

} // namespace ricochet::driver
