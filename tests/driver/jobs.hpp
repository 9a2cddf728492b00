// Jobs that are stopped and go on: what they are called with, what they write.
#pragma once

#include "process.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace ricochet::test {

using Arguments = std::vector<std::string>;

Arguments operator+(Arguments a, Arguments const& b);

bool contains(std::string const& text, std::string const& part);

/// The values of a key in a JSON text, in order.
Arguments all_of(std::string const& json, std::string const& key);

/// Writes a scene of 12,000 discs, so that two threads are used where there are two; and of so many
/// steps that a signal sent early on comes before the end, however fast the machine.
std::string write_gas(Folder const& folder);
constexpr std::int64_t gas_steps = 1000, gas_every = 25;

/// A run of `scene` and the files that it writes.
struct Job {
  Folder const& folder;
  std::string name;
  Arguments scene;

  std::string trajectory() const { return folder / (name + ".h5md"); }
  std::string checkpoint() const { return folder / (name + ".chk.h5"); }
  std::string states() const { return folder / (name + ".csv"); }
  std::string json() const { return folder / (name + ".json"); }
  Arguments run() const;
  Arguments resume() const;

  /// The step of its latest checkpoint; -1 if there is none.
  std::int64_t step() const;
};

/// Waits for `condition`; fails after a minute or when the program ends.
::testing::AssertionResult eventually(Process& process, std::function<bool()> const& condition);

/// Every number of both jobs, but for those that tell of the machine.
void expect_equal_trajectories(Job const& a, Job const& b);
void expect_equal_results(Job const& a, Job const& b);

} // namespace ricochet::test
