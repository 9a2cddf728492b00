// Initial states: random numbers, arrangements, overlaps found and removed.
#include "generate.hpp"

#include "melt.hpp"
#include "overlaps.hpp"
#include "process.hpp"
#include "random.hpp"
#include "scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

namespace ricochet::driver {
namespace {

using test::Folder;

constexpr double pi = 3.14159265358979323846;

// The numbers were computed by another implementation, in Python.
TEST(Random, NumbersAreThoseOfTheirSeedAndStream)
{
  Random random(7, 3);
  EXPECT_EQ(random.bits(), 0x47189b95c5f452d5u);
  EXPECT_EQ(Random(7, 3).unit(), 0.2777192345292445);
}

TEST(Random, NormalNumbersHaveTheMomentsOfANormalDistribution)
{
  // Standard errors of the moments of n numbers: sqrt(var(x^k) / n) with var(x) = 1, var(x^2) = 2,
  // var(x^4) = 96, var(x^6) = 10170; 4.5 of them are exceeded once in 150,000 times.
  constexpr int n = 400000;
  double sum1 = 0, sum2 = 0, sum4 = 0, sum6 = 0;
  for (std::uint64_t stream = 0; stream < n / 4; ++stream) {
    Random random(11, stream);
    for (int k = 0; k < 4; ++k) {
      double const x = random.normal();
      sum1 += x;
      sum2 += x * x;
      sum4 += x * x * x * x;
      sum6 += x * x * x * x * x * x;
    }
  }
  EXPECT_NEAR(sum1 / n, 0, 4.5 * std::sqrt(1.0 / n));
  EXPECT_NEAR(sum2 / n, 1, 4.5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(sum4 / n, 3, 4.5 * std::sqrt(96.0 / n));
  EXPECT_NEAR(sum6 / n, 15, 4.5 * std::sqrt(10170.0 / n));
}

// The text was computed by another implementation, in Python: the hash, the placement, the normal
// numbers and the scaling.
TEST(Generate, AFileIsTheSameOnEveryMachine)
{
  Folder const folder;
  auto const scene =
      folder.write("s.toml", "[box]\nwidth = 20\nheight = 10\n[discs]\nradius = 1\n"
                             "[discs.generate]\ncount = 4\ntemperature = 2\nseed = 7\n");
  EXPECT_EQ(test::ricochet({"generate", scene}).out,
            "3.703776722916313,-0.5055710067070978,-0.5246230320588031,1.8777398389361335\n"
            "6.4597741930040335,-0.36815129549081593,0.027139805351552988,0.942063524454539\n"
            "8.563388382495159,1.372346142439623,2.8129148666901913,0.4744310852259395\n"
            "4.677949996426234,2.984011156487658,1.2905443568360184,-1.2278289292595483\n");
}

Settings settings_for(Arrangement arrangement, double packing)
{
  Settings s;
  s.scene = "s.toml";
  s.packing = packing;
  s.arrangement = arrangement;
  s.temperature = 3;
  s.zero_momentum = true;
  s.seed = 1;
  return s;
}

// The scene of these settings, with a lattice where one is to be melted.
Scene generated(Settings const& settings)
{
  Scene scene;
  scene.settings = settings;
  scene.model = model_of(settings);
  ProblemList problems;
  scene.discs = generate_discs(settings, scene.model, problems);
  EXPECT_EQ(problems.text(), "");
  return scene;
}

Scene melted(Scene scene)
{
  melt(scene);
  return scene;
}

// Overlaps by looking at all pairs and their images.
std::int64_t overlapping_pairs(Model const& model, std::vector<DiscState> const& discs)
{
  double const diameter = 2 * model.radius;
  auto const apart = [](double d, double length, Boundary boundary) {
    double const way = std::fabs(d);
    return boundary == Boundary::periodic ? std::min(way, length - way) : way;
  };
  std::int64_t pairs = 0;
  for (std::size_t i = 0; i < discs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      double const x = apart(discs[i].x - discs[j].x, model.box.width, model.box.x);
      double const y = apart(discs[i].y - discs[j].y, model.box.height, model.box.y);
      pairs += diameter - std::sqrt(x * x + y * y) > 1e-12 * diameter ? 1 : 0;
    }
  return pairs;
}

TEST(Generate, DiscsAreThereAndApartAndInside)
{
  Arrangement const arrangements[] = {Arrangement::random, Arrangement::square,
                                      Arrangement::triangular};
  Boundary const boundaries[] = {Boundary::walls, Boundary::periodic};
  for (Arrangement const arrangement : arrangements)
    for (Boundary const x : boundaries)
      for (Boundary const y : boundaries)
        for (double const packing : {0.01, 0.2, 0.5, 0.7}) {
          Settings s = settings_for(arrangement, packing);
          s.width = 130;
          s.height = 90;
          s.x = x;
          s.y = y;
          s.radius = 1.5;
          Scene const scene = melted(generated(s));
          Model const& model = scene.model;
          auto const& discs = scene.discs;
          EXPECT_EQ(discs.size(), std::floor(packing * 130 * 90 / (pi * 2.25) + 0.5));
          EXPECT_EQ(overlapping_pairs(model, discs), 0) << packing;
          double energy = 0, px = 0, py = 0;
          for (DiscState const& disc : discs) {
            double const inset = 1.5 * (1 - 1e-12);
            EXPECT_LE(std::fabs(disc.x), 65 - (x == Boundary::walls ? inset : 0));
            EXPECT_LE(std::fabs(disc.y), 45 - (y == Boundary::walls ? inset : 0));
            energy += 0.5 * (disc.vx * disc.vx + disc.vy * disc.vy);
            px += disc.vx;
            py += disc.vy;
          }
          auto const n = static_cast<double>(discs.size());
          EXPECT_NEAR(energy / n, 3, 1e-12); // n roundings at most
          EXPECT_NEAR(px / n, 0, 1e-12);
          EXPECT_NEAR(py / n, 0, 1e-12);
        }
}

TEST(Generate, RandomPlacesReachHalfOfTheBoxOfAnySize)
{
  for (double const size : {8.0, 12.0, 20.0, 50.0, 200.0})
    for (std::int64_t seed = 0; seed < 5; ++seed) {
      Settings s = settings_for(Arrangement::random, 0.5);
      s.radius = 1;
      s.width = size;
      s.height = 1.5 * size;
      s.seed = seed;
      ProblemList problems;
      auto const discs = generate_discs(s, model_of(s), problems);
      EXPECT_EQ(problems.text(), "") << size;
      EXPECT_EQ(overlapping_pairs(model_of(s), discs), 0);
    }
}

TEST(Generate, ALatticeFillsItsBoxToTheClosestPacking)
{
  // Rows of ten discs that touch, and twelve rows; walls need half a disc and the ends more.
  struct {
    Arrangement arrangement;
    Boundary boundary;
    double width, height;
  } const boxes[] = {
      {Arrangement::triangular, Boundary::periodic, 20, 12 * std::sqrt(3.0)},
      {Arrangement::triangular, Boundary::walls, 21, 11 * std::sqrt(3.0) + 2},
      {Arrangement::square, Boundary::periodic, 20, 24},
      {Arrangement::square, Boundary::walls, 20, 24},
  };
  for (auto const& box : boxes) {
    Settings s = settings_for(box.arrangement, 1);
    s.packing.reset();
    s.count = 120;
    s.radius = 1;
    s.width = box.width;
    s.height = box.height;
    s.x = s.y = box.boundary;
    ProblemList problems;
    auto const discs = generate_discs(s, model_of(s), problems);
    EXPECT_EQ(problems.text(), "");
    EXPECT_EQ(discs.size(), 120u);
    EXPECT_EQ(overlapping_pairs(model_of(s), discs), 0);
    EXPECT_EQ(find_overlaps(model_of(s), discs).outside, 0);
    s.count = 121;
    EXPECT_TRUE(generate_discs(s, model_of(s), problems).empty());
    EXPECT_EQ(problems.count(), 1u);
  }
}

// Amplitude of the wave of `waves` lengths in the box that a coordinate of the discs makes.
double amplitude(std::vector<DiscState> const& discs, double DiscState::*coordinate,
                 std::size_t waves, double length)
{
  double re = 0, im = 0;
  for (DiscState const& disc : discs) {
    double const phase = 2 * pi * static_cast<double>(waves) * disc.*coordinate / length;
    re += std::cos(phase);
    im += std::sin(phase);
  }
  return std::sqrt(re * re + im * im) / static_cast<double>(discs.size());
}

// Rows of a lattice are a wave of amplitude 1. In a fluid the square of the amplitude has the mean
// S(k)/N; the structure factor S of discs is below 6 up to freezing, and S/N is exceeded 9-fold
// once in 8,000 times.
TEST(Generate, RandomPlacesAtAnyPackingHaveNoTraceOfALattice)
{
  for (double const packing : {0.51, 0.6, 0.7})
    for (Boundary const boundary : {Boundary::walls, Boundary::periodic}) {
      Settings s = settings_for(Arrangement::random, packing);
      s.width = 260;
      s.height = 240;
      s.x = s.y = boundary;
      Scene const lattice = generated(s), fluid = melted(lattice);
      double const bound = 3 * std::sqrt(6 / static_cast<double>(fluid.discs.size()));
      for (auto const coordinate : {&DiscState::x, &DiscState::y}) {
        double const length = coordinate == &DiscState::x ? *s.width : *s.height;
        std::set<double> rows;
        for (DiscState const& disc : lattice.discs)
          rows.insert(disc.*coordinate);
        EXPECT_LT(amplitude(fluid.discs, coordinate, rows.size(), length), bound)
            << packing << " " << rows.size();
      }
      for (std::size_t i = 0; i < fluid.discs.size(); ++i) {
        EXPECT_EQ(fluid.discs[i].vx, lattice.discs[i].vx);
        EXPECT_EQ(fluid.discs[i].vy, lattice.discs[i].vy);
      }
    }
}

// Above 10,000 discs several threads are used.
TEST(Generate, AMeltedFileIsTheSameOnAnyNumberOfThreadsAndWhatARunStartsFrom)
{
  Folder const folder;
  auto const scene = folder.write("s.toml", "[discs.generate]\npacking_fraction = 0.52\n"
                                            "temperature = 2\n[run]\nengine = \"sweep\"\n");
  test::ProcessOptions threads;
  threads.environment = {"OMP_NUM_THREADS=1"};
  auto const one = test::ricochet({"generate", scene}, threads);
  threads.environment = {"OMP_NUM_THREADS=2"};
  auto const two = test::ricochet({"generate", scene}, threads);
  auto const run = test::ricochet({"run", scene, "--steps", "0", "--final", "-", "--quiet"});
  EXPECT_EQ(one.code, 0) << one.err;
  EXPECT_GT(std::count(one.out.begin(), one.out.end(), '\n'), 10000);
  EXPECT_TRUE(one.out == two.out);
  EXPECT_TRUE(one.out == run.out) << run.err;
}

TEST(Generate, DiscsWithoutRoomToMoveDoNotMelt)
{
  Folder const folder;
  auto const scene =
      folder.write("s.toml", "[box]\nwidth = 6\nheight = 60\n[discs.generate]\ncount = 8\n");
  auto const refused = test::ricochet({"generate", scene});
  EXPECT_EQ(refused.code, 65);
  EXPECT_EQ(refused.out, "");
  EXPECT_EQ(
      refused.err.find(scene + ":5:9: discs.generate.count: the discs do not melt (disc 0 and "),
      0u)
      << refused.err;
}

TEST(Generate, IdsOfALatticeSayNothingOfThePlace)
{
  Settings s = settings_for(Arrangement::square, 0.3);
  ProblemList problems;
  auto const discs = generate_discs(s, model_of(s), problems);
  // The correlation of n independent pairs has a standard error of 1/sqrt(n).
  auto const n = static_cast<double>(discs.size());
  double sum = 0, squares = 0;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    sum += (static_cast<double>(i) - 0.5 * (n - 1)) * discs[i].y;
    squares += discs[i].y * discs[i].y;
  }
  EXPECT_LT(std::fabs(sum) / std::sqrt(squares * n * (n * n - 1) / 12), 4.5 / std::sqrt(n));
}

// Discs anywhere in the box.
std::vector<DiscState> crowd(Model const& model, int count, std::uint64_t seed)
{
  Random random(seed, 0);
  std::vector<DiscState> discs;
  for (int i = 0; i < count; ++i) {
    double const x = (random.unit() - 0.5) * model.box.width;
    double const y = (random.unit() - 0.5) * model.box.height;
    discs.push_back({x, y, random.unit(), random.unit()});
  }
  return discs;
}

TEST(Overlaps, AreThoseOfAllPairs)
{
  Boundary const boundaries[] = {Boundary::walls, Boundary::periodic};
  for (double const width : {2.0, 3.9, 4.1, 7.0, 30.0})
    for (Boundary const x : boundaries)
      for (Boundary const y : boundaries)
        for (int const count : {0, 1, 2, 30, 200}) {
          Model model;
          model.radius = 1;
          model.box = {width, 25, x, y};
          auto const discs = crowd(model, count, 3);
          EXPECT_EQ(find_overlaps(model, discs).pairs, overlapping_pairs(model, discs))
              << width << " " << count;
        }
}

TEST(Overlaps, TheDeepestIsToldAndDiscsInWallsAreCounted)
{
  Model model;
  model.radius = 1;
  model.box = {20, 20, Boundary::walls, Boundary::periodic};
  Overlaps const found = find_overlaps(
      model, {{0, 0, 0, 0}, {0, 1.5, 0, 0}, {1.9, 0, 0, 0}, {9.5, 5, 0, 0}, {5, 9.9, 0, 0}});
  EXPECT_EQ(found.pairs, 2);
  EXPECT_EQ(found.deepest, 0.5);
  EXPECT_EQ(found.first, 0u);
  EXPECT_EQ(found.second, 1u);
  EXPECT_EQ(found.outside, 1);
}

TEST(Relax, SeparatesACrowdAndKeepsItInTheBox)
{
  Boundary const boundaries[] = {Boundary::walls, Boundary::periodic};
  for (Boundary const x : boundaries)
    for (Boundary const y : boundaries)
      for (double const packing : {0.1, 0.5, 0.7}) {
        Model model;
        model.radius = 1;
        model.box = {40, 30, x, y};
        auto const before = crowd(model, static_cast<int>(packing * 1200 / pi), 5);
        auto discs = before, again = before;
        Relaxation const done = relax(model, discs);
        EXPECT_EQ(done.left.pairs, 0) << packing;
        EXPECT_EQ(overlapping_pairs(model, discs), 0) << packing;
        EXPECT_EQ(find_overlaps(model, discs).outside, 0);
        relax(model, again);
        std::int64_t moved = 0;
        for (std::size_t i = 0; i < discs.size(); ++i) {
          EXPECT_EQ(discs[i].x, again[i].x);
          EXPECT_EQ(discs[i].vx, before[i].vx);
          EXPECT_EQ(discs[i].vy, before[i].vy);
          moved += discs[i].x != before[i].x || discs[i].y != before[i].y ? 1 : 0;
        }
        EXPECT_EQ(done.moved, moved);
      }
}

TEST(Relax, LeavesDiscsAloneThatAreApart)
{
  Model model;
  model.radius = 1;
  model.box = {10, 10, Boundary::walls, Boundary::walls};
  std::vector<DiscState> discs{{-4, 0, 0, 0}, {-2, 0, 0, 0}, {4, 4, 1, 1}};
  Relaxation const done = relax(model, discs);
  EXPECT_EQ(done.moved, 0);
  EXPECT_EQ(discs[1].x, -2);
}

TEST(Relax, TellsHowFarItMovedWhat)
{
  Model model;
  model.radius = 1;
  model.box = {10, 10, Boundary::walls, Boundary::walls};
  std::vector<DiscState> discs{{0, 0, 0, 0}, {4.75, 0, 0, 0}}; // 0.75 of it in the wall
  Relaxation const done = relax(model, discs);
  EXPECT_EQ(done.moved, 1);
  EXPECT_EQ(done.disc, 1u);
  EXPECT_EQ(done.farthest, 0.75);
  EXPECT_EQ(discs[1].x, 4);
}

TEST(Relax, SeparatesDiscsInOnePlace)
{
  Model model;
  model.radius = 1;
  model.box = {40, 40, Boundary::walls, Boundary::walls};
  std::vector<DiscState> discs(100, DiscState{1, 1, 0, 0});
  EXPECT_EQ(relax(model, discs).left.pairs, 0);
  EXPECT_EQ(overlapping_pairs(model, discs), 0);
}

TEST(Relax, SaysSoWhereThereIsNoRoom)
{
  Model model;
  model.radius = 1;
  model.box = {6, 6, Boundary::walls, Boundary::walls};
  auto discs = crowd(model, 12, 1); // nine fit
  EXPECT_GT(relax(model, discs).left.pairs, 0);
}

} // namespace
} // namespace ricochet::driver
