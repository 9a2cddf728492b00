// The numbers behind plots: distributions that are known, and sums that must come out.
#include "pictures/plot.hpp"
#include "pictures/statistics.hpp"
#include "process.hpp"
#include "trajectory_reader.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <sys/stat.h>

namespace ricochet::driver {
namespace {

using test::Folder;
using test::Outcome;
using test::ricochet;

constexpr double pi = 3.14159265358979323846;

Stage stage_of(double side, double radius, Boundary boundary, std::int64_t discs)
{
  Stage stage;
  stage.box = {side, side, boundary, boundary};
  stage.radius = radius;
  stage.discs = discs;
  stage.has_velocities = true;
  stage.fast = 4;
  return stage;
}

double sum(Table const& table, std::size_t column)
{
  double total = 0;
  for (auto const& row : table.rows)
    total += row[column];
  return total;
}

// side x side places at distance 1, moving with speed 1, 2 or 3.
std::vector<DiscState> lattice(int side)
{
  std::vector<DiscState> discs;
  double const first = (side - 1) / -2.0;
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column)
      discs.push_back({first + column, first + row, 0, 1.0 + (row * side + column) % 3});
  return discs;
}

// Within a distance of 2.5 (five diameters of 0.5) a square lattice has four neighbours at 1, at
// sqrt 2 and at 2, and eight at sqrt 5: a share g of density times area, wherever the walls are.
TEST(Statistics, PairsOfALatticeAreCounted)
{
  for (Boundary const boundary : {Boundary::periodic, Boundary::walls}) {
    Statistics statistics(stage_of(30, 0.25, boundary, 900));
    statistics.add(lattice(30));
    Table const pairs = statistics.pairs();
    ASSERT_EQ(pairs.rows.size(), 100U);
    double const width = 2.5 / 100;
    auto const neighbours = [&](double from, double to) {
      double count = 0;
      for (auto const& row : pairs.rows) {
        double const r = row[0] * 0.5;
        if (r > from && r < to)
          count += row[1] * 2 * pi * r * width;
      }
      return count;
    };
    EXPECT_NEAR(neighbours(0, 0.9), 0, 1e-12);
    EXPECT_NEAR(neighbours(0.9, 1.1), 4, 1e-9);
    EXPECT_NEAR(neighbours(1.1, 1.6), 4, 1e-9);
    EXPECT_NEAR(neighbours(1.9, 2.1), 4, 1e-9);
    EXPECT_NEAR(neighbours(2.1, 2.5), 8, 1e-9);
  }
}

TEST(Statistics, SpeedsAreSharesOfAllDiscs)
{
  Statistics statistics(stage_of(30, 0.25, Boundary::walls, 900));
  statistics.add(lattice(30));
  statistics.add(lattice(30));
  Table const speeds = statistics.speeds();
  double const width = 8.0 / 60;
  EXPECT_NEAR(sum(speeds, 1) * width, 1, 1e-12);
  for (auto const& row : speeds.rows) {
    double const nearest = std::round(row[0]);
    bool const is_one = nearest >= 1 && nearest <= 3 && nearest >= row[0] - width / 2 &&
                        nearest < row[0] + width / 2;
    EXPECT_NEAR(row[1] * width, is_one ? 1.0 / 3 : 0, 1e-12) << row[0];
  }
  // Maxwell's distribution of T = (1 + 4 + 9) / 3 / 2: what is beyond a speed of 8 is exp(-64/2T);
  // the midpoint rule is off by width^2 / 24 f'(0) = width^2 / 24T.
  double const temperature = 14.0 / 6;
  EXPECT_NEAR(sum(speeds, 2) * width, 1 - std::exp(-32 / temperature),
              1.1 * width * width / (24 * temperature));
}

TEST(Statistics, TheProfileHoldsAllDiscs)
{
  Statistics statistics(stage_of(50, 0.25, Boundary::walls, 900));
  statistics.add(lattice(30)); // between -14.5 and 14.5
  Table const heights = statistics.heights();
  EXPECT_NEAR(sum(heights, 1) / 50, 900 * pi * 0.0625 / 2500, 1e-12);
  for (auto const& row : heights.rows) // slices of height 1
    EXPECT_NEAR(row[1], std::abs(row[0]) < 15 ? 30 * pi * 0.0625 / 50 : 0, 1e-12) << row[0];
}

TEST(Statistics, UnknownNumbersAreLeftEmptyInCsv)
{
  Table const table{"t", {"a", "b"}, {{1, std::nan("")}, {0.1, 2}}};
  EXPECT_EQ(as_csv(table), "a,b\n1,\n0.1,2\n");
}

std::string trajectory(Folder const& folder)
{
  EXPECT_EQ(ricochet({"run", test::scene("gas.toml"), "--steps", "20", "--set",
                      "run.measure_from=0", "-q", "-o", folder / "t.h5md"})
                .code,
            0);
  return folder / "t.h5md";
}

TEST(Plot, TheTableOfTimesHoldsTheObservables)
{
  Folder const folder;
  TrajectoryReader const file(trajectory(folder));
  Table const table = observables_table(file);
  ASSERT_EQ(table.rows.size(), static_cast<std::size_t>(file.frames()));
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    for (std::size_t frame = 1; frame < table.rows.size(); ++frame) // pressure is unknown at 0
      EXPECT_EQ(table.rows[frame][c], file.observable(table.columns[c])[frame]) << table.columns[c];
}

TEST(Plot, TheScaleOfSpeedsIsThatOfTheFramesCounted)
{
  // A disc loses nearly all its speed at the first wall.
  Folder const folder;
  auto const fast = folder.write("fast.csv", "0,0,1000,0\n");
  auto const box = folder.write("box.csv", "g=0,alpha=0.01,beta=1,width=100,height=100");
  ASSERT_EQ(ricochet({"run", fast, box, "--steps", "20", "-q", "-o", folder / "t.h5md"}).code, 0);
  EXPECT_EQ(ricochet({"plot", folder / "t.h5md", "--csv", folder / "p.csv"}).code, 0);
  std::string const speeds = test::text_of(folder / "p_speeds.csv");
  double const last = std::stod(speeds.substr(speeds.rfind('\n', speeds.size() - 2)));
  EXPECT_GT(last, 10);
  EXPECT_LT(last, 100);
}

TEST(Plot, WithoutGnuplotTheNumbersAreWritten)
{
  Folder const folder;
  auto const t = trajectory(folder);
  test::ProcessOptions const no_programs{{"PATH=" + folder.path()}, -1, ""};
  Outcome const outcome = ricochet({"plot", t, "-o", folder / "p.svg"}, no_programs);
  EXPECT_EQ(outcome.code, 1);
  EXPECT_NE(outcome.err.find("install the package gnuplot-nox"), std::string::npos) << outcome.err;
  EXPECT_EQ(folder.names(), (std::vector<std::string>{"p_heights.csv", "p_pairs.csv",
                                                      "p_speeds.csv", "p_time.csv", "t.h5md"}));
  EXPECT_EQ(ricochet({"plot", t, "--csv", folder / "q.csv"}, no_programs).code, 0);
  EXPECT_EQ(test::text_of(folder / "q_time.csv"), test::text_of(folder / "p_time.csv"));
  EXPECT_EQ(ricochet({"plot", t, "--csv", folder / "q.csv"}, no_programs).code, 73);
}

// A program in its stead that keeps the script, whose second line names the file.
TEST(Plot, GnuplotIsGivenTheTables)
{
  Folder const folder;
  auto const t = trajectory(folder);
  auto const gnuplot = folder.write(
      "gnuplot", "#!/bin/sh\ncat > script\nsed -n \"s/set output '\\(.*\\)'/\\1/p\" script | xargs "
                 "cp script\nrm script\n");
  ::chmod(gnuplot.c_str(), 0700);
  Outcome const outcome = ricochet({"plot", t, "-o", folder / "p.png", "--csv", folder / "p.csv"},
                                   {{"PATH=" + folder.path() + ":/bin:/usr/bin"}, -1, ""});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  std::string const script = test::text_of(folder / "p.png");
  for (std::string const table : {"time", "speeds", "heights", "pairs"})
    EXPECT_NE(script.find("$" + table + " << END\n" +
                          test::text_of(folder / ("p_" + table + ".csv")) + "END\n"),
              std::string::npos)
        << table;
}

TEST(Plot, WrongCallsAreRefused)
{
  Folder const folder;
  auto const states = folder.write("s.csv", "0,0,1,1\n");
  EXPECT_EQ(ricochet({"plot", states, "--csv", folder / "p.csv"}).code, 65);
  EXPECT_EQ(ricochet({"plot", states, "-o", folder / "p.pdf"}).code, 64);
  EXPECT_EQ(ricochet({"plot", states}).code, 64);
  EXPECT_EQ(ricochet({"plot", folder / "none", "-o", folder / "p.png"}).code, 66);
}

} // namespace
} // namespace ricochet::driver
