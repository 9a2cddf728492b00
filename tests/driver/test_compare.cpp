// `compare` finds the largest deviation and where it is.
#include "compare.hpp"
#include "process.hpp"
#include "trajectory_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ricochet::driver {
namespace {

using test::Folder;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double inf = std::numeric_limits<double>::infinity();

Comparison::Deviation of(Comparison const& result, std::string const& component)
{
  for (auto const& d : result.deviations)
    if (d.component == component)
      return d;
  ADD_FAILURE() << "no " << component;
  return {};
}

// Three discs at steps 0, 10, 20…; disc 1 of the last frame is `shift` off in vy.
std::string trajectory(Folder const& folder, std::string const& name, int frames, double shift)
{
  TrajectoryHeader header;
  header.path = folder / name;
  header.discs = 3;
  header.frames = frames;
  TrajectoryFile file(header);
  std::vector<std::unique_ptr<Frame>> all;
  for (int index = 0; index < frames; ++index) {
    all.push_back(std::make_unique<Frame>());
    all.back()->report.steps = std::int64_t{10} * index;
    for (int disc = 0; disc < 3; ++disc)
      all.back()->states.push_back({1.0 * disc, 2.0 * index, 3, 4});
  }
  all.back()->states[1].vy += shift;
  file.append(all);
  file.close();
  return header.path;
}

TEST(Compare, DeviationOfNumbers)
{
  EXPECT_EQ(deviation(1, 1.5), 0.5);
  EXPECT_EQ(deviation(nan, nan), 0);
  EXPECT_EQ(deviation(inf, inf), 0);
  EXPECT_EQ(deviation(nan, 1), inf);
  EXPECT_EQ(deviation(inf, -inf), inf);
  EXPECT_EQ(deviation(1, inf), inf);
}

TEST(Compare, StatesByFieldAndDisc)
{
  Folder const folder;
  auto const a = folder.write("a.csv", "1,2,3,4\n5,6,7,8\n");
  auto const b = folder.write("b.csv", "1,2,3,4.25 5,6.5,7,8");
  Comparison const result = compare_files(a, b, 0);
  EXPECT_FALSE(result.within(0.4));
  EXPECT_TRUE(result.within(0.5));
  EXPECT_EQ(of(result, "x").largest, 0);
  EXPECT_EQ(of(result, "y").largest, 0.5);
  EXPECT_EQ(of(result, "y").disc, 1);
  EXPECT_EQ(of(result, "vy").largest, 0.25);
  EXPECT_EQ(of(result, "vy").disc, 0);
  EXPECT_TRUE(compare_files(a, a, 0).within(0));
}

TEST(Compare, TheFirstOfEqualDeviationsIsShown)
{
  Folder const folder;
  auto const a = folder.write("a.csv", "0,0,0,0 0,0,0,0 0,0,0,0");
  auto const b = folder.write("b.csv", "0,0,0,0 0,0,1,0 0,0,1,0");
  EXPECT_EQ(of(compare_files(a, b, 0), "vx").disc, 1);
}

TEST(Compare, TrajectoriesByFieldFrameAndDisc)
{
  Folder const folder;
  auto const a = trajectory(folder, "a.h5md", 4, 0);
  auto const b = trajectory(folder, "b.h5md", 4, 1e-3);
  EXPECT_TRUE(compare_files(a, a, 0).within(0));
  Comparison const result = compare_files(a, b, 1e-6);
  EXPECT_EQ(result.frames, 4);
  EXPECT_EQ(result.first_beyond, 30);
  EXPECT_NEAR(of(result, "vy").largest, 1e-3, 1e-15);
  EXPECT_EQ(of(result, "vy").step, 30);
  EXPECT_EQ(of(result, "vy").disc, 1);
  EXPECT_EQ(of(result, "x").largest, 0);
  EXPECT_FALSE(result.within(1e-6));
  EXPECT_TRUE(result.within(2e-3));
}

TEST(Compare, AMissingFrameIsADifferenceWhateverTheTolerance)
{
  Folder const folder;
  auto const result =
      compare_files(trajectory(folder, "a.h5md", 4, 0), trajectory(folder, "b.h5md", 3, 0), 0);
  EXPECT_EQ(result.frames, 3);
  EXPECT_FALSE(result.within(1e300));
}

TEST(Compare, DifferentCountsOfDiscsAreADifference)
{
  Folder const folder;
  EXPECT_FALSE(compare_files(folder.write("a", "1,2,3,4"), folder.write("b", ""), 0).within(1e300));
}

TEST(Compare, StatesWithTheLastFrameOfATrajectory)
{
  Folder const folder;
  auto const a = trajectory(folder, "a.h5md", 3, 0.5);
  auto const last = folder.write("l.csv", "0,4,3,4 1,4,3,4.5 2,4,3,4");
  EXPECT_TRUE(compare_files(a, last, 0).within(0));
  EXPECT_TRUE(compare_files(last, a, 0).within(0));
}

} // namespace
} // namespace ricochet::driver
