#include "run.hpp"

#include "compression.hpp"
#include "final_states.hpp"
#include "json_output.hpp"
#include "log.hpp"
#include "melt.hpp"
#include "output_file.hpp"
#include "pictures/frame_source.hpp"
#include "progress.hpp"
#include "provenance.hpp"
#include "states_h5md.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <sys/resource.h>
#include <utility>

namespace ricochet::driver {

namespace {

// Refuses options for a trajectory that is not written.
void check_frame_options(RunOptions const& options, Settings const& settings)
{
  if (settings.file)
    return;
  for (Override const& setting : options.scene.overrides)
    if (setting.key.rfind("output.", 0) == 0)
      throw Failure(Exit::usage,
                    fmt::format("{}: needs a trajectory: add --output FILE.h5md", setting.option));
}

bool is_finite(DiscState const& disc)
{
  return std::isfinite(disc.x) && std::isfinite(disc.y) && std::isfinite(disc.vx) &&
         std::isfinite(disc.vy);
}

// Does `write` with the file at `path`, and names it in `outputs`; "" means no file.
template <class Write>
void write_output(std::string const& path, bool replace, std::vector<std::string>& outputs,
                  Write const& write)
{
  if (path.empty())
    return;
  OutputFile file(path, replace);
  write(file);
  file.commit();
  if (path != "-")
    outputs.push_back(path);
}

// Seconds that `work` takes.
template <class Work>
double timed(Work const& work)
{
  auto const start = std::chrono::steady_clock::now();
  work();
  std::chrono::duration<double> const spent = std::chrono::steady_clock::now() - start;
  return spent.count();
}

} // namespace

Run::Run(RunOptions const& options, Scene scene)
  : options_(options),
    scene_(std::move(scene)),
    discs_(static_cast<std::int64_t>(scene_.discs.size()))
{
  melt(scene_);
  try {
    engine_ = make_engine(scene_.model, scene_.method, scene_.discs);
  } catch (std::invalid_argument const& error) {
    throw Failure(Exit::bad_data, error.what());
  }
  if (options_.watching != Watching::no)
    stage_ = stage_of(scene_);
  if (*scene_.settings.until == Until::rest)
    rest_.emplace(scene_);
  std::vector<DiscState>().swap(scene_.discs); // the engine has its own
  warnings_ = engine_->warnings();
  initial_hash_ = engine_->state_hash();
  identity_ = identity(scene_.settings, initial_hash_);
  checkpoint_ = checkpoint_path(options_, scene_.settings);
}

// What a log should know before the run begins.
void Run::log_start() const
{
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  std::vector<LogField> fields{{"version", version()},
                               {"git", git_state()},
                               {"command", options_.command_line},
                               {"host", host_name()},
                               {"backend", engine_->backend()},
                               {"threads", std::int64_t{engine_->threads()}},
                               {"initial_state", hash_text(initial_hash_)},
                               {"engine", std::string(name(scene_.method.engine))},
                               {"discs", discs_},
                               {"steps", scene_.steps},
                               {"memory_bytes", std::int64_t{usage.ru_maxrss} * 1024}};
  if (char const* const job = std::getenv("SLURM_JOB_ID"))
    fields.emplace_back("job", std::string(job));
  log_event("start", fields);
}

void Run::tell_result(Summary const& result) const
{
  if (options_.kokkos.quiet)
    return;
  if (log_format() == LogFormat::text)
    std::fputs(in_words(result).c_str(), stderr);
  if (Progress::style_for(false) != Progress::Style::lines)
    return;
  Report const& report = result.report;
  log_event("result", {{"steps", report.steps},
                       {"wall_seconds", result.wall_seconds},
                       {"disc_steps_per_second", result.disc_steps_per_second()},
                       {"collisions", report.collisions},
                       {"residual", report.energy.residual()},
                       {"state_hash", hash_text(result.state_hash)},
                       {"outputs", joined(result.outputs)}});
}

void Run::introduce() const
{
  if (Progress::style_for(options_.kokkos.quiet) == Progress::Style::lines)
    log_start();
  for (std::string const& note : scene_.notes)
    tell(LogLevel::info, note);
  for (std::string const& warning : warnings_)
    tell(LogLevel::warning, warning);
}

void Run::go(StopRequests& stops)
{
  auto const saved = find_saved(options_, scene_.settings, identity_);
  if (saved && !saved->summary.empty())
    return write_recorded(*saved);
  if (saved)
    go_on_from(*saved);
  else
    forget_checkpoint(options_, scene_.settings);
  if (scene_.settings.file)
    open_trajectory();
  if (options_.watching != Watching::no)
    open_window();
  try {
    step_to_the_end(stops);
  } catch (LastingContact const& contact) {
    close_trajectory();
    throw Failure(Exit::failed, contact.what());
  }
  close_trajectory();
  write_results();
  if (!broken_.empty())
    throw Failure(Exit::failed, broken_);
}

void Run::go_on_from(SavedRun const& saved)
{
  try {
    engine_->restore(saved.engine);
  } catch (std::invalid_argument const& error) {
    throw Failure(Exit::bad_data, error.what());
  }
  step_ = saved.step();
  frames_ = saved.frames;
  wall_seconds_ = saved.wall_seconds;
  if (rest_)
    rest_->restore(saved.slow_looks);
  if (!options_.kokkos.quiet)
    tell(LogLevel::info, fmt::format("going on after step {} of {}", step_, scene_.steps));
}

// The results of a run that is finished already. What is there of them stays as it is.
void Run::write_recorded(SavedRun const& saved)
{
  auto const is_missing = [](std::string const& path) {
    return !std::filesystem::is_regular_file(path);
  };
  auto& outputs = result_.outputs;
  if (is_missing(options_.final_file))
    write_output(options_.final_file, options_.force, outputs,
                 [&](OutputFile& file) { write_states(file, saved.engine.discs); });
  if (is_missing(options_.json))
    write_output(options_.json, options_.force, outputs,
                 [&](OutputFile& file) { file.write(saved.summary_json); });
  result_.json = saved.summary_json;
  if (!options_.kokkos.quiet)
    tell(LogLevel::info, "finished before:\n" + saved.summary);
}

TrajectoryHeader Run::header()
{
  Settings const& settings = scene_.settings;
  TrajectoryHeader header;
  header.path = settings.file.value_or("");
  header.replace = options_.force || !options_.resume.empty();
  header.kept = frames_;
  header.model = scene_.model;
  header.method = scene_.method;
  header.discs = discs_;
  header.steps = scene_.steps;
  header.every = scene_.every;
  header.frames = planned_frames(scene_.steps, scene_.every);
  header.velocity = *settings.velocity;
  header.float32 = *settings.float32;
  header.version = version();
  header.deflate = *settings.compression == Compression::deflate ||
                   (*settings.compression == Compression::automatic && frames_ == 0 &&
                    has_time_to_deflate(header));
  return header;
}

// Measures with steps that are taken back: the file must be there before the run's own begin.
bool Run::has_time_to_deflate(TrajectoryHeader const& header)
{
  if (!is_large(header))
    return false;
  Checkpoint const now = engine_->checkpoint();
  double const deflating = seconds_to_deflate(header, now.discs) * options_.at_once;
  constexpr double sample = 0.05; // seconds
  double spent = 0, all = 0;
  std::int64_t batch = 1;
  try {
    for (; all < sample; batch *= 2) {
      spent = timed([&] {
        engine_->advance(batch);
        fence();
      });
      all += spent;
    }
  } catch (LastingContact const&) {
    // The run itself will tell where it comes to that.
  }
  engine_->restore(now);
  double const a_step = 2 * spent / static_cast<double>(batch);
  return keeps_up(deflating, a_step * static_cast<double>(header.every));
}

void Run::open_trajectory()
{
  TrajectoryHeader header = this->header();
  header.texts = {{"scene", as_toml(scene_.settings)},
                  {"identity", identity_},
                  {"initial_state_hash", hash_text(initial_hash_)},
                  {"command_line", options_.command_line},
                  {"kokkos_configuration", kokkos_configuration()},
                  {"provenance", provenance_text()}};
  trajectory_ = std::make_unique<TrajectoryFile>(header);
  writer_ = std::make_unique<FrameWriter>(*trajectory_, discs_);
}

void Run::open_window()
{
  bool const is_animation = options_.watching == Watching::animation;
  constexpr double smooth = 1.0 / 30; // seconds
  Look look;
  look.style = is_animation ? Style::classic : Style::plain;
  View view(stage_, look);
  auto window = driver::open_window("ricochet: " + options_.scene.file, view.layout().width,
                                    view.layout().height);
  live_ = std::make_unique<LiveView>(std::move(window), std::move(view),
                                     is_animation ? scene_.method.dt : smooth);
  watch(step_);
}

void Run::watch(std::int64_t step)
{
  fetch_states();
  live_->show(static_cast<double>(step) * scene_.method.dt, states_);
}

// The state of the run; the pressure is one from its measurement on.
Report Run::report()
{
  Report report = engine_->report();
  if (report.steps < scene_.measure_from)
    report.pressure_z.reset();
  return report;
}

// The step at which the measurement begins if that is still to come, else the last.
std::int64_t Run::end_of_phase(std::int64_t step) const
{
  return step < scene_.measure_from ? scene_.measure_from : scene_.steps;
}

// Takes the steps from `step` to `until` and returns the seconds that took.
double Run::timed_steps(std::int64_t step, std::int64_t until)
{
  double const seconds = timed([&] {
    engine_->advance(until - step);
    fence();
  });
  if (until == scene_.measure_from)
    engine_->start_measuring();
  return seconds;
}

// Makes a checkpoint, of the end if there is a result.
void Run::save(Summary const* result)
{
  checkpoint_seconds_ = timed([&] {
    if (writer_) {
      writer_->flush();
      trajectory_->sync();
      frames_ = trajectory_->frames();
    }
    SavedRun run;
    run.version = version();
    run.identity = identity_;
    run.frames = frames_;
    run.wall_seconds = wall_seconds_;
    run.slow_looks = rest_ ? rest_->slow_looks() : 0;
    if (result) {
      run.summary = in_words(*result);
      run.summary_json = as_json(*result);
    }
    run.engine = engine_->checkpoint();
    write_checkpoint(checkpoint_, run);
  });
}

void Run::stop(std::string const& why, int signal)
{
  std::string const where =
      fmt::format("stopped after step {} of {} by {}", step_, scene_.steps, why);
  if (!checkpoint_.empty())
    save(nullptr);
  close_trajectory();
  if (checkpoint_.empty())
    throw Failure(static_cast<Exit>(128 + signal),
                  fmt::format("{} (--checkpoint FILE would allow it to go on)", where));
  throw Failure(Exit::stopped, fmt::format("{} (the checkpoint is '{}') --resume auto goes on",
                                           where, checkpoint_));
}

void Run::step_to_the_end(StopRequests& stops)
{
  // Long enough that looking at the clock costs nothing, short enough for a lively bar.
  constexpr double lively = 0.05; // seconds

  using Clock = std::chrono::steady_clock;
  std::chrono::duration<double> const checkpoint_interval(
      scene_.settings.every_seconds.value_or(900));

  Progress progress(Progress::style_for(options_.kokkos.quiet), discs_, scene_.steps, step_);
  if (writer_ && frames_ == 0)
    write_frame(report());
  // The first checkpoint shows that there is room for one, and how long it takes.
  if (!checkpoint_.empty() && step_ < scene_.steps)
    save(nullptr);
  auto saved = Clock::now();
  std::int64_t batch = 1;
  while (step_ < scene_.steps && broken_.empty()) {
    std::int64_t until = std::min(scene_.steps, step_ + batch);
    if (writer_)
      until = std::min(until, (step_ / scene_.every + 1) * scene_.every);
    until = std::min(until, end_of_phase(step_));
    if (rest_)
      until = std::min(until, rest_->next_look(step_));
    bool const is_animated = live_ && live_->is_open() && options_.watching == Watching::animation;
    if (is_animated)
      until = step_ + 1;
    double const spent = timed_steps(step_, until);
    wall_seconds_ += spent;
    if (spent < lively && until - step_ == batch)
      batch *= 2;
    else if (spent > 2 * lively)
      batch = std::max<std::int64_t>(1, batch / 2);
    step_ = until;
    look_for_rest();

    if (is_animated || (live_ && live_->is_due()))
      watch(step_);
    bool const is_frame = writer_ && (step_ % scene_.every == 0 || step_ == scene_.steps);
    bool const is_due = progress.is_due();
    if (is_frame || is_due) {
      Report const report = this->report();
      if (is_frame)
        write_frame(report);
      if (is_due)
        progress.update(step_, report.energy.kinetic + report.energy.potential);
      check_state(report);
    }
    if (step_ == scene_.steps || !broken_.empty())
      break;
    if (std::string const why = stops.reason(2 * checkpoint_seconds_ + spent, checkpoint_.empty());
        !why.empty()) {
      progress.clear();
      stop(why, stops.signal());
    }
    bool const asked = stops.checkpoints_asked() != checkpoints_asked_;
    if (!checkpoint_.empty() && (asked || Clock::now() - saved >= checkpoint_interval)) {
      checkpoints_asked_ = stops.checkpoints_asked();
      save(nullptr);
      saved = Clock::now();
    }
  }
}

// Ends the run where its discs rest, if it is to.
void Run::look_for_rest()
{
  if (!rest_ || !rest_->is_look(step_))
    return;
  fetch_states();
  rest_->look(states_);
  if (rest_->is_at_rest())
    scene_.steps = step_;
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
  if (rest_ && rest_->is_at_rest())
    trajectory_->set_end(step_);
  trajectory_->close();
  if (!checkpoint_.empty())
    trajectory_->sync();
  frames_ = trajectory_->frames();
  writer_.reset();
  trajectory_.reset();
  std::error_code ignored;
  auto const bytes = std::filesystem::file_size(*scene_.settings.file, ignored);
  result_.outputs.push_back(fmt::format("{} ({} frames, {:.1f} MB)", *scene_.settings.file, frames_,
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

Summary Run::summary()
{
  Summary s;
  s.engine = name(scene_.method.engine);
  s.law = name_of_law(scene_.model.contact);
  s.precision = name(scene_.method.precision);
  s.backend = engine_->backend();
  s.threads = engine_->threads();
  s.dt = scene_.method.dt;
  s.wall_seconds = wall_seconds_;
  s.packing_fraction = packing_fraction(scene_.model, static_cast<std::size_t>(discs_));
  s.state_hash = engine_->state_hash();
  s.report = report();
  s.warnings = warnings_;
  if (rest_)
    s.is_at_rest = rest_->is_at_rest();
  return s;
}

void Run::write_results()
{
  Summary result = summary();
  if (broken_.empty())
    check_state(result.report);
  if (!checkpoint_.empty() && broken_.empty())
    save(&result);

  bool const replace = options_.force || !options_.resume.empty();
  result_.json = as_json(result);
  if (broken_.empty())
    write_output(options_.final_file, replace, result_.outputs, [&](OutputFile& file) {
      fetch_states();
      write_states(file, states_);
    });
  write_output(options_.json, replace, result_.outputs,
               [&](OutputFile& file) { file.write(result_.json); });
  result.outputs = result_.outputs;
  tell_result(result);
}

Forecast Run::forecast()
{
  // The later steps of the sample stand for those to come, as a scene may change at its start.
  constexpr double sample = 1, mark = 0.05;                     // seconds
  std::vector<std::pair<std::int64_t, double>> marks{{0, 0.0}}; // steps and seconds since the start
  std::int64_t step = 0, batch = 1;
  double seconds = 0;
  while (step < scene_.steps && seconds < sample) {
    std::int64_t const until = std::min(end_of_phase(step), step + batch);
    double const spent = timed_steps(step, until);
    seconds += spent;
    step = until;
    marks.emplace_back(step, seconds);
    if (spent < mark)
      batch *= 2;
  }
  auto const half = std::find_if(marks.begin(), marks.end(),
                                 [&](auto const& m) { return m.second >= seconds / 2; });
  if (step < scene_.steps && half != marks.end() && half->first < step)
    seconds += (seconds - half->second) / static_cast<double>(step - half->first) *
               static_cast<double>(scene_.steps - step);
  else if (step > 0 && step < scene_.steps)
    seconds *= static_cast<double>(scene_.steps) / static_cast<double>(step);

  Forecast forecast;
  forecast.seconds = seconds;
  fetch_states(); // as at the end
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  forecast.memory = static_cast<double>(usage.ru_maxrss) * 1024;
  if (!scene_.settings.file)
    return forecast;

  TrajectoryHeader const planned = header();
  report(); // what it finds out serves the next step, so it is no cost of the frame
  double const a_frame = timed([&] {
    report();
    fetch_states();
  });
  forecast.frames = planned.frames;
  forecast.file = forecast_bytes(planned);
  // Frames are written beside the steps, as fast as this on a core of a server.
  double const writing = forecast.file / (planned.deflate ? 40e6 : 1e9);
  forecast.seconds = std::max(seconds + static_cast<double>(planned.frames) * a_frame, writing);
  bool const queue_is_full = writing > 0.8 * forecast.seconds;
  constexpr double hdf5_memory = 5e6; // of the library and its buffers
  forecast.memory += hdf5_memory + frames_memory(planned, queue_is_full);
  return forecast;
}

std::int64_t planned_frames(std::int64_t steps, std::int64_t every)
{
  return 1 + steps / every + (steps % every != 0);
}

std::vector<std::string> outputs_of(RunOptions const& options, Settings const& settings)
{
  return {settings.file.value_or(""), options.final_file, options.json,
          checkpoint_path(options, settings)};
}

void check_run(RunOptions const& options, Settings const& settings)
{
  check_frame_options(options, settings);
  check_outputs(
      outputs_of(options, settings),
      {options.scene.file, options.scene.config, file_of_states(settings.states.value_or(""))},
      options.force || !options.resume.empty());
}

std::vector<OutputLock> lock_outputs(std::vector<std::string> const& outputs)
{
  std::vector<OutputLock> locks;
  for (std::string const& output : outputs)
    if (is_file_output(output))
      locks.emplace_back(output);
  return locks;
}

std::string stop_file(RunOptions const& options, Settings const& settings)
{
  std::filesystem::path const checkpoint = checkpoint_path(options, settings);
  return (checkpoint.parent_path() / "STOP").string();
}

Exit run(RunOptions const& given)
{
  RunOptions options = given;
  set_log_format(options.log_format);
  Scene scene = read_scene(options.scene);
  if (options.print_scene) {
    OutputFile out("-", false);
    std::string origin = options.command_line;
    std::replace_if( // a comment is one line
        origin.begin(), origin.end(), [](char c) { return c >= 0 && c < ' '; }, ' ');
    out.write(fmt::format("# {}\n", origin));
    out.write(as_toml(scene.settings));
    out.commit();
    return Exit::done;
  }
  if (!scene.settings.file && options.final_file.empty() && options.json.empty())
    options.final_file = "-"; // nothing else would be written
  check_run(options, scene.settings);
  if (options.dry_run) {
    Outlook const expected = outlook(scene);
    std::string text = in_words(scene, expected);
    for (std::string const& warning : doubts(scene, expected))
      text += warning + "\n";
    KokkosSession const kokkos(options.kokkos);
    text += in_words(Run(options, std::move(scene)).forecast());
    OutputFile out("-", false);
    out.write(text);
    out.commit();
    return Exit::done;
  }
  auto const locks = lock_outputs(outputs_of(options, scene.settings));
  StopRequests stops(options.walltime, stop_file(options, scene.settings));
  KokkosSession const kokkos(options.kokkos);
  Run run(options, std::move(scene));
  run.introduce();
  run.go(stops);
  return Exit::done;
}

} // namespace ricochet::driver
