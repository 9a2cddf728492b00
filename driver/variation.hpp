// How the members of an ensemble differ: what `--vary` says.
#pragma once

#include "settings.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// A setting with a value for each member.
struct Variation {
  std::string option; ///< that asked for it, such as "--vary run.dt"
  std::string key;
  std::vector<std::string> values;
};

/// What `vary` means, in which a value is
///   A..B     as many evenly spaced numbers as there are members, A and B among them
///   A,B,C    a value for each member
///   seed     for discs.generate.seed: counting up from `seed`, that of the scene.
/// Without `members`, lists say how many there are. All variations have the same number of values.
/// Throws Failure(Exit::usage).
std::vector<Variation> variations(std::vector<Override> const& vary,
                                  std::optional<std::int64_t> members, std::int64_t seed);

} // namespace ricochet::driver
