// CONFIG.csv: what is accepted, and what every mistake is told as.
#include "config.hpp"

#include "exit_codes.hpp"
#include "scene.hpp"

#include <gtest/gtest.h>

namespace ricochet::driver {
namespace {

// What is wrong with a CONFIG of this text, as the program prints it.
std::string problems_of(std::string const& text)
{
  ProblemList problems;
  Settings const settings = parse_config("c.csv", text, problems);
  if (problems.empty())
    check_model(settings, model_of(settings), problems);
  return problems.text();
}

Settings good(std::string const& text)
{
  EXPECT_EQ(problems_of(text), "");
  ProblemList problems;
  return parse_config("c.csv", text, problems);
}

TEST(Config, AnEmptyFileMeansTheOriginalsDefaults)
{
  for (char const* text : {"", "\n", "  \r\n", "\xef\xbb\xbf"}) {
    Settings const config = good(text);
    EXPECT_EQ(config.gravity, 9.81);
    EXPECT_EQ(config.restitution, 0.93);
    EXPECT_EQ(config.friction, 0.93);
    EXPECT_EQ(config.width, 740);
    EXPECT_EQ(config.height, 740);
    EXPECT_EQ(config.radius, 3);
    EXPECT_EQ(config.steps_per_time, 45);
    EXPECT_EQ(config.duration, 60);
  }
}

TEST(Config, EveryKeyIsReadWithBlanksAroundIt)
{
  Settings const config = good("\xef\xbb\xbf g = -1.5,\talpha=.5 ,beta= 1,width =100,height=90,"
                               "radius=4,fps=10,totTime=0\r\n");
  EXPECT_EQ(config.gravity, -1.5);
  EXPECT_EQ(config.restitution, 0.5);
  EXPECT_EQ(config.friction, 1);
  EXPECT_EQ(config.width, 100);
  EXPECT_EQ(config.height, 90);
  EXPECT_EQ(config.radius, 4);
  EXPECT_EQ(config.steps_per_time, 10);
  EXPECT_EQ(config.duration, 0);
}

TEST(Config, WallsStandAtTheIntegerHalfOfWidthAndHeight)
{
  Settings const config = good("width=741,height=7");
  EXPECT_EQ(model_of(config).box.width, 740);
  EXPECT_EQ(model_of(config).box.height, 6);
}

TEST(Config, SettingsAreWrittenInTheFormThatReadsAsTheSame)
{
  char const* const text =
      "g=-1.5,alpha=0.5,beta=1,width=100,height=90,radius=4,fps=10,totTime=7\n";
  ProblemList problems;
  EXPECT_EQ(as_config(good(text), problems), text);
  EXPECT_EQ(problems.text(), "");
}

TEST(Config, WhatTheOriginalCannotHaveIsNotWritten)
{
  Settings settings = good("g=1");
  settings.radius = 2.5;
  settings.width = 75;
  settings.x = Boundary::periodic;
  settings.law = Law::restitution;
  settings.pairs = false;
  settings.dt = 0.3;
  ProblemList problems;
  as_config(settings, problems);
  EXPECT_EQ(problems.text(),
            "c.csv:1:1: box.width is 75 (CONFIG.csv allows: an even integer)\n"
            "c.csv:1:1: discs.radius is 2.5 (CONFIG.csv allows: an integer)\n"
            "c.csv:1:1: run.dt is 0.3 (CONFIG.csv allows: the reciprocal of an integer)\n"
            "c.csv:1:1: contact.law is restitution (CONFIG.csv knows the original's alone, "
            "swap_scale)\n"
            "c.csv:1:1: contact.pairs is false (in CONFIG.csv discs always meet)\n"
            "c.csv:1:1: box.x is periodic (CONFIG.csv knows walls alone)");
}

struct BadConfig {
  char const* text;
  char const* message;
};

class BadConfigs : public testing::TestWithParam<BadConfig> {};

TEST_P(BadConfigs, AreToldWithPlaceFindingAndWhatIsAllowed)
{
  EXPECT_EQ(problems_of(GetParam().text), GetParam().message);
}

#define KEYS "(allowed: g, alpha, beta, width, height, radius, fps, totTime)"

INSTANTIATE_TEST_SUITE_P(
    Table, BadConfigs,
    testing::Values(
        BadConfig{"gravity=9.81", "c.csv:1:1: unknown key 'gravity' " KEYS},
        BadConfig{"g=9.81,apha=1", "c.csv:1:8: unknown key 'apha' " KEYS " did you mean 'alpha'?"},
        BadConfig{"Alpha=1", "c.csv:1:1: unknown key 'Alpha' " KEYS " did you mean 'alpha'?"},
        BadConfig{"tottime=1", "c.csv:1:1: unknown key 'tottime' " KEYS " did you mean 'totTime'?"},
        BadConfig{"=1", "c.csv:1:1: unknown key '' " KEYS},
        BadConfig{"g=1,g=2",
                  "c.csv:1:5: g: found a second time (first in column 1) keep one of them"},
        BadConfig{"g",
                  "c.csv:1:1: found 'g' without '=' (a setting is key=value) did you mean 'g'?"},
        BadConfig{"g 9.81", "c.csv:1:1: found 'g 9.81' without '=' (a setting is key=value)"},
        BadConfig{
            "g=1,",
            "c.csv:1:5: found nothing between two commas (a setting is key=value) remove a comma"},
        BadConfig{
            "g=1,,alpha=1",
            "c.csv:1:5: found nothing between two commas (a setting is key=value) remove a comma"},
        BadConfig{"g=1\nalpha=1", "c.csv:2:1: found a second line 'alpha=1' (CONFIG is one line of "
                                  "key=value,key=value) join the lines with a comma"},
        BadConfig{"g=", "c.csv:1:1: g: found '', which is missing (allowed: a decimal number)"},
        BadConfig{"g=heavy", "c.csv:1:1: g: found 'heavy', which is not a decimal number (allowed: "
                             "a decimal number)"},
        BadConfig{"g=nan",
                  "c.csv:1:1: g: found 'nan', which is not finite (allowed: a decimal number)"},
        BadConfig{"g=-inf",
                  "c.csv:1:1: g: found '-inf', which is not finite (allowed: a decimal number)"},
        BadConfig{"g=0x10",
                  "c.csv:1:1: g: found '0x10', which is hexadecimal (allowed: a decimal number)"},
        BadConfig{"g=1e999", "c.csv:1:1: g: found '1e999', which is out of the range of numbers "
                             "(allowed: a decimal number)"},
        BadConfig{
            "g=1=2",
            "c.csv:1:1: g: found '1=2', which is not a decimal number (allowed: a decimal number)"},
        BadConfig{
            "radius=2.5",
            "c.csv:1:1: radius: found '2.5', which is not an integer (allowed: an integer > 0)"},
        BadConfig{
            "width=740.0",
            "c.csv:1:1: width: found '740.0', which is not an integer (allowed: an integer > 0)"},
        BadConfig{
            "height=1e3",
            "c.csv:1:1: height: found '1e3', which is not an integer (allowed: an integer > 0)"},
        BadConfig{"fps=0", "c.csv:1:1: fps: found 0 (allowed: an integer > 0)"},
        BadConfig{"fps=-45", "c.csv:1:1: fps: found -45 (allowed: an integer > 0)"},
        BadConfig{"fps=99999999999999999999",
                  "c.csv:1:1: fps: found '99999999999999999999', which is out of the range of "
                  "numbers (allowed: an integer > 0)"},
        BadConfig{"totTime=-1", "c.csv:1:1: totTime: found -1 (allowed: an integer >= 0)"},
        BadConfig{
            "totTime=1.5",
            "c.csv:1:1: totTime: found '1.5', which is not an integer (allowed: an integer >= 0)"},
        BadConfig{" \n  fps=0", "c.csv:2:3: fps: found 0 (allowed: an integer > 0)"},
        BadConfig{"fps=0, totTime=-1", "c.csv:1:1: fps: found 0 (allowed: an integer > 0)\n"
                                       "c.csv:1:8: totTime: found -1 (allowed: an integer >= 0)"}));

// The ranges of the model are the kernels' business; here they must be told of the right key.
TEST(Config, WhatTheModelRefusesIsToldOfItsKey)
{
  auto const begins = [](std::string const& text, std::string const& start) {
    std::string const message = problems_of(text);
    EXPECT_EQ(message.substr(0, start.size()), start) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  };
  begins("g=1,alpha=1.5", "c.csv:1:5: alpha: found 1.5 (allowed: ");
  begins("beta=-0.1", "c.csv:1:1: beta: found -0.1 (allowed: ");
  begins("radius=0", "c.csv:1:1: radius: found 0 (allowed: ");
  begins("radius=-3", "c.csv:1:1: radius: found -3 (allowed: ");
  begins("fps=45,width=5", "c.csv:1:8: width: found 5 (allowed: ");
  begins("radius=4,height=-7", "c.csv:1:10: height: found -7 (allowed: ");
  begins("width=0", "c.csv:1:1: width: found 0 (allowed: ");
}

TEST(Config, ADefaultThatDoesNotFitIsToldWhereTheCauseStands)
{
  std::string const text = problems_of("g=1,radius=400");
  EXPECT_EQ(text.rfind("c.csv:1:5: width: found 7", 0), 0u) << text;
  EXPECT_NE(text.find(" by default (allowed: "), std::string::npos) << text;
}

TEST(Config, AMissingFileIsMissingInput)
{
  ProblemList problems;
  try {
    read_config("/nonexistent/c.csv", problems);
    FAIL();
  } catch (Failure const& failure) {
    EXPECT_EQ(failure.code(), Exit::no_input);
    EXPECT_STREQ(failure.what(), "cannot read '/nonexistent/c.csv': No such file or directory");
  }
}

} // namespace
} // namespace ricochet::driver
