// The frames that pictures are made of: those of a trajectory, or of a scene that is simulated on
// the way.
#pragma once

#include "pictures/look.hpp"
#include "scene.hpp"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace ricochet::driver {

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  Stage const& stage() const { return stage_; }
  virtual std::int64_t frames() const = 0;
  virtual double time(std::int64_t frame) const = 0;

  /// Writes the discs of `frame`, in id order, to `discs`. Frames are cheapest in their order.
  /// Throws Failure.
  virtual void read(std::int64_t frame, std::vector<DiscState>& discs) = 0;

 protected:
  Stage stage_;
};

/// About the speed of the fastest of `discs` discs that have this kinetic energy: twice the root
/// mean square; in a gas one disc in fifty is faster.
double fast_speed(double kinetic, std::int64_t discs);

/// What is to be seen of a scene.
Stage stage_of(Scene const& scene);

/// Opens a trajectory, or else a scene, which takes Kokkos if more than its frame 0 is read. Throws
/// Failure.
std::unique_ptr<FrameSource> open_frames(SceneOptions const& input, Purpose purpose);

} // namespace ricochet::driver
