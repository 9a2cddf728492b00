// What `--vary` means.
#include "exit_codes.hpp"
#include "variation.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace ricochet::driver {
namespace {

using Words = std::vector<std::string>;

Override vary(std::string const& key, std::string const& values)
{
  return {"--vary " + key, key, values};
}

Words values_of(std::string const& values, std::optional<std::int64_t> members)
{
  return variations({vary("run.dt", values)}, members, 1).front().values;
}

TEST(Vary, ARangeIsEvenlySpacedAndHasBothEnds)
{
  EXPECT_EQ(values_of("0.5..1", 6), (Words{"0.5", "0.6", "0.7", "0.8", "0.9", "1"}));
  EXPECT_EQ(values_of("0.8..1", 5), (Words{"0.8", "0.85", "0.9", "0.95", "1"}));
  EXPECT_EQ(values_of("1..-1", 3), (Words{"1", "0", "-1"}));
  EXPECT_EQ(values_of("0.1..0.3", 2), (Words{"0.1", "0.3"}));
  EXPECT_EQ(values_of("0.25..9", 1), Words{"0.25"});
}

TEST(Vary, ARangeOfIntegersIsOneWhereItCanBe)
{
  EXPECT_EQ(values_of("100..400", 4), (Words{"100", "200", "300", "400"}));
  EXPECT_EQ(values_of("1000000..3000000", 3), (Words{"1000000", "2000000", "3000000"}));
  EXPECT_EQ(values_of("1..2", 3), (Words{"1", "1.5", "2"}));
  EXPECT_EQ(values_of("1..2", 4), (Words{"1", "1.33333333333333", "1.66666666666667", "2"}));
}

TEST(Vary, AListHasAValueForEachMember)
{
  EXPECT_EQ(values_of("0.1, 0.2,0.4", std::nullopt), (Words{"0.1", "0.2", "0.4"}));
  EXPECT_EQ(values_of("sweep,events", 2), (Words{"sweep", "events"}));
  EXPECT_EQ(values_of("../a.csv,../b.csv", 2), (Words{"../a.csv", "../b.csv"})) << "no range";
}

TEST(Vary, SeedsCountUpFromThatOfTheScene)
{
  auto const all = variations({vary("discs.generate.seed", "seed")}, 3, 41);
  EXPECT_EQ(all.front().values, (Words{"41", "42", "43"}));
}

TEST(Vary, MembersTakeTheValuesOfAllTogether)
{
  auto const all = variations({vary("run.dt", "1..2"), vary("run.engine", "sweep,events"),
                               vary("discs.generate.seed", "seed")},
                              std::nullopt, 1);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].values, (Words{"1", "2"})) << "as many as the list has";
  EXPECT_EQ(all[1].values, (Words{"sweep", "events"}));
  EXPECT_EQ(all[2].values, (Words{"1", "2"}));
}

TEST(Vary, MistakesAreTold)
{
  struct {
    std::vector<Override> vary;
    std::optional<std::int64_t> members;
    std::string part;
  } const cases[] = {
      {{}, 3, "nothing varies"},
      {{vary("run.dt", "1..2")}, std::nullopt, "--members"},
      {{vary("run.dt", "1,2")}, 3, "--vary run.dt: found 2 values for 3 members"},
      {{vary("run.dt", "0.5..x")}, 3, "--vary run.dt: found 1 value for 3 members"},
      {{vary("run.dt", "1,2"), vary("run.engine", "a,b,c")}, std::nullopt, "--vary run.engine"},
  };
  for (auto const& wrong : cases) {
    try {
      variations(wrong.vary, wrong.members, 1);
      ADD_FAILURE() << wrong.part;
    } catch (Failure const& failure) {
      EXPECT_EQ(failure.code(), Exit::usage);
      EXPECT_NE(std::string(failure.what()).find(wrong.part), std::string::npos) << failure.what();
    }
  }
}

} // namespace
} // namespace ricochet::driver
