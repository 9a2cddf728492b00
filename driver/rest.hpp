// When a scene has come to rest.
#pragma once

#include "scene.hpp"

#include <cstdint>
#include <vector>

namespace ricochet::driver {

/// Tells from looks at a run, at fixed steps, whether its discs have come to rest: whether none, at
/// six looks in a row, was faster than a fall of a hundredth of its radius r makes it,
///   v = sqrt(2 g r/100).
/// Looks are sqrt(r/g)/2 apart. A disc in flight gains g times that in between, 3.5 v, so it is
/// not slow at two looks by being at the top of its flight at one of them. Only a disc that
/// bounces in time with the looks is taken for one at rest, and those bounces are r/25 high at
/// most: a bounce of height h takes sqrt(8 h/g), and the disc is slow for 2 v/g of that.
class RestWatch {
 public:
  /// `scene` has gravity.
  explicit RestWatch(Scene const& scene);

  /// At which steps to look, and the next of them after `step`.
  bool is_look(std::int64_t step) const { return step % every_ == 0; }
  std::int64_t next_look(std::int64_t step) const { return (step / every_ + 1) * every_; }

  /// Looks at the states after such a step.
  void look(std::vector<DiscState> const& states);

  bool is_at_rest() const { return slow_looks_ >= enough_; }

  /// How many looks in a row found all discs slow: all that a checkpoint must keep.
  std::int64_t slow_looks() const { return slow_looks_; }
  void restore(std::int64_t slow_looks) { slow_looks_ = slow_looks; }

 private:
  static constexpr std::int64_t enough_ = 6;

  std::int64_t every_;
  double slow2_; ///< square of the greatest speed at rest
  std::int64_t slow_looks_ = 0;
};

} // namespace ricochet::driver
