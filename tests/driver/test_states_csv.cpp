// STATES.csv: what is accepted, and what every mistake is told as.
#include "states_csv.hpp"

#include "final_states.hpp"
#include "process.hpp"
#include "same_bits.hpp"
#include "text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace ricochet::driver {
namespace {

using test::Folder;

// What some programs put at the beginning of a text.
std::string const mark = "\xef\xbb\xbf";

struct Parsed {
  std::vector<DiscState> discs;
  std::string problems;
};

// Parses `text`, handed over in pieces of `piece` bytes, against the default box.
Parsed parse(std::string const& text, std::size_t piece = std::string::npos)
{
  ProblemList problems;
  StatesParser parser("s.csv", Model{}, problems);
  for (std::size_t at = 0; at < text.size();) {
    std::size_t const size = std::min(piece, text.size() - at);
    parser.feed(std::string_view(text).substr(at, size));
    at += size;
  }
  Parsed result;
  result.discs = parser.finish();
  result.problems = problems.text();
  return result;
}

void expect_two_discs(std::string const& text)
{
  Parsed const parsed = parse(text);
  EXPECT_EQ(parsed.problems, "") << text;
  ASSERT_EQ(parsed.discs.size(), 2u) << text;
  EXPECT_EQ(parsed.discs[0].x, 1);
  EXPECT_EQ(parsed.discs[0].vy, -4.5);
  EXPECT_EQ(parsed.discs[1].x, 5);
  EXPECT_EQ(parsed.discs[1].vy, 8);
}

TEST(StatesCsv, RecordsAreSeparatedByAnyWhiteSpace)
{
  for (std::string const& text :
       {std::string("1,2,3,-4.5\n5,6,7,8\n"), std::string("1,2,3,-4.5\r\n5,6,7,8"),
        std::string("1,2,3,-4.5 5,6,7,8"), std::string("\n\n  1,2,3,-4.5\t\t5,6,7,8 \n\n"),
        mark + "1,2,3,-4.5\n5,6,7,8", std::string("1,2,3,-4.5\r5,6,7,8\f\v"),
        std::string("+1,2,3,-45e-1 5.,6,7,.8e1")})
    expect_two_discs(text);
}

TEST(StatesCsv, AnEmptyFileIsNoDiscs)
{
  for (std::string const& text : {std::string(), std::string("\n"), std::string(" \r\n\t"), mark}) {
    EXPECT_EQ(parse(text).problems, "");
    EXPECT_TRUE(parse(text).discs.empty());
  }
}

TEST(StatesCsv, PiecesMayEndAnywhere)
{
  std::string const text = mark + " 1.25,-2e1,3,4\r\n\r\n5,6,7,8 9,10,x,12\n13,14,15\n400,0,0,0";
  Parsed const whole = parse(text);
  ASSERT_EQ(whole.discs.size(), 3u);
  for (std::size_t piece = 1; piece < text.size(); ++piece) {
    Parsed const parts = parse(text, piece);
    EXPECT_EQ(parts.problems, whole.problems) << piece;
    ASSERT_EQ(parts.discs.size(), whole.discs.size()) << piece;
    for (std::size_t i = 0; i < whole.discs.size(); ++i)
      EXPECT_TRUE(test::same_bits(parts.discs[i], whole.discs[i])) << piece;
  }
}

struct BadStates {
  std::string text;
  std::string message;
};

class BadStatesFiles : public testing::TestWithParam<BadStates> {};

TEST_P(BadStatesFiles, AreToldWithPlaceFindingAndWhatIsAllowed)
{
  EXPECT_EQ(parse(GetParam().text).problems, GetParam().message);
}

#define RECORD "(a record is the four numbers x,y,vx,vy; white space separates records)"

INSTANTIATE_TEST_SUITE_P(
    Table, BadStatesFiles,
    testing::Values(
        BadStates{"1,2,3", "s.csv:1:1: found 3 numbers in '1,2,3' " RECORD},
        BadStates{"1,2,3,4,5", "s.csv:1:1: found 5 numbers in '1,2,3,4,5' " RECORD},
        BadStates{"1;2;3;4", "s.csv:1:1: found 1 number in '1;2;3;4' " RECORD},
        BadStates{"1,2,3,4\n\n 5", "s.csv:3:2: found 1 number in '5' " RECORD},
        BadStates{"1,2,3, 4", "s.csv:1:7: vy: found '', which is missing (allowed: a decimal "
                              "number) remove the blanks around the commas\n"
                              "s.csv:1:8: found 1 number in '4' " RECORD},
        BadStates{"1, 2,3,4", "s.csv:1:1: found 2 numbers in '1,' " RECORD
                              " remove the blanks around the commas\n"
                              "s.csv:1:4: found 3 numbers in '2,3,4' " RECORD},
        BadStates{",2,3,4", "s.csv:1:1: x: found '', which is missing (allowed: a decimal number) "
                            "remove the blanks around the commas"},
        BadStates{"1,,3,4", "s.csv:1:3: y: found '', which is missing (allowed: a decimal number)"},
        BadStates{"x,y,vx,vy\n1,2,3,4", "s.csv:1:1: x: found 'x', which is not a decimal number "
                                        "(allowed: a decimal number) remove the header line\n"
                                        "s.csv:1:3: y: found 'y', which is not a decimal number "
                                        "(allowed: a decimal number) remove the header line\n"
                                        "s.csv:1:5: vx: found 'vx', which is not a decimal number "
                                        "(allowed: a decimal number) remove the header line\n"
                                        "s.csv:1:8: vy: found 'vy', which is not a decimal number "
                                        "(allowed: a decimal number) remove the header line"},
        BadStates{"1,2,nan,4",
                  "s.csv:1:5: vx: found 'nan', which is not finite (allowed: a decimal number)"},
        BadStates{"1,2,3,-inf",
                  "s.csv:1:7: vy: found '-inf', which is not finite (allowed: a decimal number)"},
        BadStates{"0x1,2,3,4",
                  "s.csv:1:1: x: found '0x1', which is hexadecimal (allowed: a decimal number)"},
        BadStates{"1,2,3,1e999", "s.csv:1:7: vy: found '1e999', which is out of the range of "
                                 "numbers (allowed: a decimal number)"},
        BadStates{
            "1,2,3,4a",
            "s.csv:1:7: vy: found '4a', which is not a decimal number (allowed: a decimal number)"},
        BadStates{"1,2,3,1.2.3", "s.csv:1:7: vy: found '1.2.3', which is not a decimal number "
                                 "(allowed: a decimal number)"},
        BadStates{"1,2,3,--4", "s.csv:1:7: vy: found '--4', which is not a decimal number "
                               "(allowed: a decimal number)"},
        BadStates{std::string("1,2,3,4\0", 8), "s.csv:1:7: vy: found '4\\x00', which is not a "
                                               "decimal number (allowed: a decimal number)"},
        BadStates{"\"1\",2,3,4", "s.csv:1:1: x: found '\"1\"', which is not a decimal number "
                                 "(allowed: a decimal number)"},
        BadStates{"1,2,3,4\xc2\xa0", "s.csv:1:7: vy: found '4\\xc2\\xa0', which is not a decimal "
                                     "number (allowed: a decimal number)"},
        BadStates{
            "#1,2,3,4",
            "s.csv:1:1: x: found '#1', which is not a decimal number (allowed: a decimal number)"},
        BadStates{mark.substr(0, 2) + "1,2,3,4",
                  "s.csv:1:1: x: found '\\xef\\xbb1', which is not a decimal number (allowed: a "
                  "decimal number)"},
        BadStates{
            "1,2,3,4\r\n1,b,3,d\r\n",
            "s.csv:2:3: y: found 'b', which is not a decimal number (allowed: a decimal number)\n"
            "s.csv:2:7: vy: found 'd', which is not a decimal number (allowed: a decimal number)"},
        BadStates{std::string(5000, '1'),
                  "s.csv:1:1: found a record of more than 4096 characters '" +
                      std::string(40, '1') + "...' (a record is x,y,vx,vy)"}));

TEST(StatesCsv, ADiscOutsideTheBoxIsToldInTheOrderOfTheFile)
{
  std::string const message = parse("1,2,3,4\n371,0,0,0\n1,2,3\n0,-999,0,0\n").problems;
  std::size_t const first = message.find("s.csv:2:1: x: found 371 (allowed: ");
  std::size_t const second = message.find("\ns.csv:3:1: found 3 numbers");
  std::size_t const third = message.find("\ns.csv:4:3: y: found -999 (allowed: ");
  EXPECT_EQ(first, 0u) << message;
  EXPECT_NE(second, std::string::npos) << message;
  EXPECT_NE(third, std::string::npos) << message;
  EXPECT_LT(second, third) << message;
}

TEST(StatesCsv, ManyProblemsAreCountedNotListed)
{
  std::string text;
  for (int i = 0; i < 3000; ++i)
    text += "1,2,3,?\n";
  std::string const message = parse(text).problems;
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 20);
  EXPECT_NE(message.find("\ns.csv:20:7: "), std::string::npos);
  EXPECT_NE(message.find("\nand 2980 more"), std::string::npos);
}

TEST(StatesCsv, FinalStatesReadBackToTheSameBits)
{
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> within(-370, 370), speed(-1e3, 1e3);
  std::vector<DiscState> discs(20000);
  for (DiscState& disc : discs)
    disc = {within(random), within(random), speed(random), speed(random) * 1e-300};
  discs[0] = {-0.0, 5e-324, 1.7976931348623157e308, 1e22};

  Folder const folder;
  OutputFile file(folder / "f.csv", false);
  write_states(file, discs);
  file.commit();
  ProblemList problems;
  auto const back = read_states(folder / "f.csv", Model{}, problems);
  EXPECT_EQ(problems.text(), "");
  ASSERT_EQ(back.size(), discs.size());
  for (std::size_t i = 0; i < discs.size(); ++i)
    ASSERT_TRUE(test::same_bits(back[i], discs[i])) << i;
}

} // namespace
} // namespace ricochet::driver
