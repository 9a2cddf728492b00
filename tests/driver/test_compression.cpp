// When a trajectory is compressed.
#include "compression.hpp"

#include <gtest/gtest.h>

namespace ricochet::driver {
namespace {

TEST(Compression, IsNotWorthTheTroubleForASmallFile)
{
  TrajectoryHeader header;
  header.discs = 2000;
  header.frames = 100; // of 64 kB
  EXPECT_FALSE(is_large(header));
  header.frames = 300;
  EXPECT_TRUE(is_large(header));
  header.velocity = false;
  EXPECT_FALSE(is_large(header));
}

TEST(Compression, TakesATenthOfTheTimeBetweenFramesAtMost)
{
  EXPECT_TRUE(keeps_up(1, 10));
  EXPECT_FALSE(keeps_up(1, 9.9));
  EXPECT_FALSE(keeps_up(0.003, 0));
}

TEST(Compression, IsMeasuredForEverySizeOfFrame)
{
  TrajectoryHeader header;
  EXPECT_EQ(seconds_to_deflate(header, {}), 0);
  for (bool const single : {false, true})
    for (std::size_t const discs : {1, 30000}) { // more than are compressed to find out
      header.float32 = single;
      EXPECT_GT(seconds_to_deflate(header, std::vector<DiscState>(discs, {1, 2, 3, 4})), 0);
    }
}

} // namespace
} // namespace ricochet::driver
