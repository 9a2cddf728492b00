#include "pictures/frame_source.hpp"

#include "exit_codes.hpp"
#include "melt.hpp"
#include "run.hpp"
#include "trajectory_reader.hpp"

#include "ricochet/engine.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

double fast_speed(double kinetic, std::int64_t discs)
{
  return discs > 0 ? 2 * std::sqrt(2 * kinetic / static_cast<double>(discs)) : 0;
}

namespace {

class TrajectoryFrames final : public FrameSource {
 public:
  explicit TrajectoryFrames(std::string const& path);
  std::int64_t frames() const override { return file_.frames(); }
  double time(std::int64_t frame) const override
  {
    return times_.at(static_cast<std::size_t>(frame));
  }
  void read(std::int64_t frame, std::vector<DiscState>& discs) override
  {
    file_.read_states(frame, discs);
  }

 private:
  double length(char const* name) const;
  double largest_kinetic_energy();

  TrajectoryReader file_;
  std::vector<double> times_;
};

TrajectoryFrames::TrajectoryFrames(std::string const& path) : file_(path), times_(file_.times())
{
  if (file_.frames() == 0)
    throw Failure(Exit::bad_data, fmt::format("trajectory '{}' has no frames", path));
  if (times_.size() < file_.steps().size())
    times_.assign(file_.steps().begin(), file_.steps().end());
  stage_.box.width = length("width");
  stage_.box.height = length("height");
  stage_.radius = length("radius");
  auto const boundary = file_.boundary();
  auto const kind = [&](std::size_t axis) {
    return axis < boundary.size() && boundary[axis] == "periodic" ? Boundary::periodic
                                                                  : Boundary::walls;
  };
  stage_.box.x = kind(0);
  stage_.box.y = kind(1);
  stage_.gravity = file_.parameter("gravity").value_or(0);
  stage_.discs = file_.discs();
  stage_.has_velocities = file_.has("velocity");
  if (times_.size() > 1)
    stage_.interval = times_[1] - times_[0];
  stage_.fast = fast_speed(largest_kinetic_energy(), stage_.discs);
}

double TrajectoryFrames::length(char const* name) const
{
  auto const value = file_.parameter(name);
  if (!value || !(*value > 0) || !std::isfinite(*value))
    throw Failure(Exit::bad_data, fmt::format("cannot draw trajectory '{}': it does not tell the "
                                              "{} (attribute '{}' of /parameters)",
                                              file_.path(), name, name));
  return *value;
}

double TrajectoryFrames::largest_kinetic_energy()
{
  auto const kinetic = file_.observable("kinetic");
  if (!kinetic.empty())
    return *std::max_element(kinetic.begin(), kinetic.end());
  double largest = 0;
  std::vector<DiscState> discs;
  for (std::int64_t const frame : {std::int64_t{0}, frames() - 1}) {
    read(frame, discs);
    double sum = 0;
    for (DiscState const& d : discs)
      sum += (d.vx * d.vx + d.vy * d.vy) / 2;
    largest = std::max(largest, sum);
  }
  return largest;
}

class SimulatedFrames final : public FrameSource {
 public:
  explicit SimulatedFrames(Scene scene);
  std::int64_t frames() const override { return planned_frames(scene_.steps, scene_.every); }
  double time(std::int64_t frame) const override
  {
    return static_cast<double>(step(frame)) * scene_.method.dt;
  }
  void read(std::int64_t frame, std::vector<DiscState>& discs) override;

 private:
  std::int64_t step(std::int64_t frame) const
  {
    return std::min(frame * scene_.every, scene_.steps);
  }

  Scene scene_;
  std::unique_ptr<Engine> engine_;
  std::int64_t step_ = 0; ///< of the engine
};

SimulatedFrames::SimulatedFrames(Scene scene) : scene_(std::move(scene))
{
  melt(scene_);
  stage_ = stage_of(scene_);
}

void SimulatedFrames::read(std::int64_t frame, std::vector<DiscState>& discs)
{
  std::int64_t const wanted = step(frame);
  if (wanted == 0) {
    discs = scene_.discs;
    return;
  }
  try {
    if (!engine_ || step_ > wanted) {
      engine_ = make_engine(scene_.model, scene_.method, scene_.discs);
      step_ = 0;
    }
    engine_->advance(wanted - step_);
  } catch (std::invalid_argument const& error) {
    throw Failure(Exit::bad_data, error.what());
  } catch (LastingContact const& contact) {
    throw Failure(Exit::failed, contact.what());
  }
  step_ = wanted;
  discs.resize(scene_.discs.size());
  engine_->states(discs.data());
}

} // namespace

Stage stage_of(Scene const& scene)
{
  Stage stage;
  stage.box = scene.model.box;
  stage.radius = scene.model.radius;
  stage.gravity = scene.model.gravity;
  stage.discs = static_cast<std::int64_t>(scene.discs.size());
  stage.has_velocities = true;
  stage.interval = static_cast<double>(scene.every) * scene.method.dt;
  // No more can become kinetic than the energy at the start.
  double energy = 0;
  for (DiscState const& d : scene.discs)
    energy +=
        (d.vx * d.vx + d.vy * d.vy) / 2 + std::abs(stage.gravity) * (d.y + stage.box.height / 2);
  stage.fast = fast_speed(energy, stage.discs);
  return stage;
}

std::unique_ptr<FrameSource> open_frames(SceneOptions const& input, Purpose purpose)
{
  if (is_toml(input.file) || !is_hdf5(input.file))
    return std::make_unique<SimulatedFrames>(read_scene(input, purpose));
  if (!input.config.empty())
    throw Failure(Exit::usage, fmt::format("{}: a trajectory takes no CONFIG", input.config));
  if (!input.overrides.empty())
    throw Failure(Exit::usage, fmt::format("{}: a trajectory has no settings to override",
                                           input.overrides.front().option));
  return std::make_unique<TrajectoryFrames>(input.file);
}

} // namespace ricochet::driver
