// A finished run in numbers and in words.
#pragma once

#include "ricochet/engine.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

struct Summary {
  std::string engine, law, precision, backend;
  int threads = 1;
  double dt = 0;
  double wall_seconds = 0; ///< of stepping alone
  double packing_fraction = 0;
  std::optional<bool> is_at_rest; ///< of a run until rest
  std::uint64_t state_hash = 0;
  Report report;
  std::vector<std::string> warnings;
  std::vector<std::string> outputs; ///< a phrase for every file written

  double disc_steps_per_second() const;
  double collisions_per_second() const;
};

/// A few lines for people.
std::string in_words(Summary const& summary);

/// 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

} // namespace ricochet::driver
