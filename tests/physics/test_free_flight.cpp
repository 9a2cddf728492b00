// Discs that do not meet each other (contact.pairs = false): in engines `toi` and `events` each is
// taken through a step of any length exactly; in the others the step lacks its pairs.
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/runs.hpp"
#include "support/same_runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
constexpr Contact elastic{Law::swap_scale, 1, 1, false};

Contact apart(double restitution, double friction)
{
  return {Law::swap_scale, restitution, friction, false};
}

std::vector<Way> const ways{{EngineKind::toi, Precision::double_, Placement::serial},
                            {EngineKind::events, Precision::double_, Placement::parallel},
                            {EngineKind::toi, Precision::single_, Placement::parallel}};

class FreeFlight : public testing::TestWithParam<Way> {
 protected:
  static double unit() { return round_off(GetParam().precision); }
};
INSTANTIATE_TEST_SUITE_P(Ways, FreeFlight, testing::ValuesIn(ways),
                         [](auto const& way) { return name(way.param); });

Scene alone(double gravity, Contact const& contact, DiscState const& disc, double dt)
{
  return scene_of(40, 40, gravity, contact, {disc}, dt);
}

/// One disc from bounce to bounce in extended precision, with as many bounces as there are; it must
/// not come to rest. Times are those of the quadratic formula as it is taught.
class Bouncing {
 public:
  Bouncing(Model const& model, DiscState const& s)
    : g_(model.gravity),
      a_(model.contact.restitution),
      b_(model.contact.friction),
      box_(model.box),
      high_x_(model.box.width / 2 - model.radius),
      high_y_(model.box.height / 2 - model.radius),
      x_(s.x),
      y_(s.y),
      vx_(s.vx),
      vy_(s.vy)
  {
  }

  void fly(long double left)
  {
    for (;;) {
      long double const to_x = box_.x == periodic ? never
                               : vx_ > 0          ? (high_x_ - x_) / vx_
                               : vx_ < 0          ? (-high_x_ - x_) / vx_
                                                  : never;
      long double const to_y =
          box_.y == periodic ? never : std::fmin(until_at(high_y_), until_at(-high_y_));
      long double const time = std::fmin(to_x, to_y);
      if (time >= left)
        break;
      move(time);
      left -= time;
      ++hits;
      if (to_x <= to_y) {
        vx_ = -a_ * vx_;
        vy_ = b_ * vy_;
      } else {
        vx_ = b_ * vx_;
        vy_ = -a_ * vy_;
      }
    }
    move(left);
  }

  DiscState state() const
  {
    auto const wrapped = [](Boundary boundary, long double p, double length) {
      return boundary == walls ? p : p - length * std::floor(p / length + 0.5L);
    };
    return {static_cast<double>(wrapped(box_.x, x_, box_.width)),
            static_cast<double>(wrapped(box_.y, y_, box_.height)), static_cast<double>(vx_),
            static_cast<double>(vy_)};
  }

  std::int64_t hits = 0;

 private:
  static constexpr long double never = std::numeric_limits<long double>::infinity();

  /// When y is next at a height, moving away from the middle.
  long double until_at(long double height) const
  {
    auto const outward = [&](long double t) {
      return t >= 0 && (vy_ - g_ * t) * (height > 0 ? 1 : -1) > 0;
    };
    if (g_ == 0) {
      long double const t = vy_ != 0 ? (height - y_) / vy_ : never;
      return outward(t) ? t : never;
    }
    long double const square = vy_ * vy_ + 2 * g_ * (y_ - height);
    if (square < 0)
      return never;
    long double first = never;
    for (long double const root : {-std::sqrt(square), std::sqrt(square)})
      if (long double const t = (vy_ + root) / g_; outward(t))
        first = std::fmin(first, t);
    return first;
  }

  void move(long double t)
  {
    x_ += vx_ * t;
    y_ += vy_ * t - g_ * t * t / 2;
    vy_ -= g_ * t;
  }

  long double g_, a_, b_;
  Box box_;
  long double high_x_, high_y_, x_, y_, vx_, vy_;
};

/// Errors of a bounce are a few roundings of places and velocities below 40; one at which the disc
/// is much slower than in its flight makes more of them, here up to some hundred times.
TEST_P(FreeFlight, IsThatFromBounceToBounceInStepsOfAnyLength)
{
  Random random(3);
  for (auto const x : {walls, periodic})
    for (auto const y : {walls, periodic})
      for (double const gravity : {0.0, 2.0, -2.0})
        for (auto const& contact : {elastic, apart(0.95, 1), apart(1, 0.9), apart(0.9, 0.8)}) {
          if (y == periodic && gravity != 0)
            continue;
          Scene scene;
          scene.model = make_model(40, 36, gravity, contact, x, y);
          for (int k = 0; k < 20; ++k)
            scene.discs.push_back({random.between(-19, 19), random.between(-17, 17),
                                   random.between(-20, 20), random.between(-20, 20)});
          for (auto const& [dt, steps] :
               {std::pair(0.05, 40), std::pair(0.5, 4), std::pair(2., 1)}) {
            SCOPED_TRACE(std::to_string(gravity) + " " + std::to_string(dt));
            scene.dt = dt;
            std::vector<DiscState> expected;
            std::int64_t hits = 0;
            for (auto const& disc : scene.discs) {
              Bouncing bouncing(scene.model, disc);
              bouncing.fly(2);
              expected.push_back(bouncing.state());
              hits += bouncing.hits;
            }
            auto const run = start(scene, GetParam());
            run->advance(steps);
            EXPECT_TRUE(close(states(run), expected, 40 * 1e4 * unit()));
            EXPECT_EQ(run->report().wall_hits, hits);
            EXPECT_EQ(run->report().max_outside, 0);
          }
        }
}

/// Balls that reach the ceiling, and lower ones: with many flights in one step, of which each loses
/// some speed along the floor.
TEST_P(FreeFlight, IsThatFromBounceToBounceInOneLongStep)
{
  for (auto const& contact : {elastic, apart(0.98, 0.95)})
    for (double const speed : {3.0, 6.0, 9.0, 15.0}) {
      auto const scene = alone(2, contact, {1, -19, 2, speed}, 50);
      Bouncing bouncing(scene.model, scene.discs[0]);
      bouncing.fly(50);
      auto const run = start(scene, GetParam());
      run->advance(1);
      EXPECT_TRUE(close(states(run), {bouncing.state()}, 40 * 1e4 * unit())) << speed;
      EXPECT_EQ(run->report().wall_hits, bouncing.hits) << speed;
    }
}

/// Through whatever walls and gravity do, it is the path of the disc alone, to the bit.
TEST(DiscsThatDoNotMeet, PassThroughEachOther)
{
  std::vector<Way> all = all_ways();
  all.insert(all.end(), ways.begin(), ways.end());
  for (Way const& way : all) {
    SCOPED_TRACE(name(way));
    Scene crowd = alone(9.81, apart(0.9, 0.8), {}, 1.0 / 45);
    crowd.discs = random_discs(crowd.model, 300, 30, Ids::shuffled, 4); // they overlap
    for (auto& disc : crowd.discs) {
      disc.x = std::fmin(std::fmax(disc.x, -19), 19);
      disc.y = std::fmin(std::fmax(disc.y, -19), 19);
    }
    auto const run = start(crowd, way);
    run->advance(100);
    auto const report = run->report();
    EXPECT_EQ(report.collisions, 0);
    EXPECT_EQ(report.max_overlap, 0);
    EXPECT_GT(report.wall_hits, 100);
    auto const together = states(run);
    for (std::size_t const k : {0, 17, 299}) {
      Scene single = crowd;
      single.discs = {crowd.discs[k]};
      EXPECT_TRUE(same_bits(states_after(single, way, 100), {together[k]}));
    }
  }
}

/// A ball let go at the height h has bounced infinitely often after sqrt(2 h/g) (1 + a)/(1 - a),
/// and not before.
TEST_P(FreeFlight, BringsABallToRestWhenTheClosedFormSays)
{
  double const g = 10, h = 5, a = 0.9, rest = (1 + a) / (1 - a);
  for (double const friction : {1.0, 0.5}) {
    Contact const contact = apart(a, friction);
    DiscState const start_at{7, -19 + h, 0.25, 0};
    auto const bouncing = states_after(alone(g, contact, start_at, 0.999 * rest), GetParam(), 1);
    EXPECT_NE(bouncing[0].vy, 0);
    EXPECT_LT(bouncing[0].y, -18.999);
    auto const run = start(alone(g, contact, start_at, 1.001 * rest), GetParam());
    run->advance(1);
    auto const resting = states(run)[0];
    EXPECT_EQ(resting.vy, 0);
    EXPECT_EQ(resting.y, -19);
    EXPECT_EQ(resting.vx, friction < 1 ? 0 : 0.25);
    auto const hits = run->report().wall_hits;
    run->advance(1);
    EXPECT_EQ(run->report().wall_hits, hits) << "what rests hits nothing";
    EXPECT_EQ(states(run)[0].y, -19);
    auto const& energy = run->report().energy;
    EXPECT_NEAR(energy.lost_walls, energy.initial() - energy.kinetic - energy.potential,
                1000 * unit() * energy.initial());
  }
}

/// A ball that slides after it has come to rest is still turned round by the side walls.
TEST_P(FreeFlight, SlidesOnFromWallToWallWithoutFriction)
{
  auto const scene = alone(10, apart(0.5, 1), {0, -19, 38, 1e-3}, 3.25);
  auto const slid = states_after(scene, GetParam(), 1)[0];
  // 19 to the right at 38, then 38 at 19, 38 at 9.5 and so on: 0.5 + 2 s, and 0.75 s at 9.5.
  EXPECT_NEAR(slid.x, -19 + 0.75 * 9.5, 1000 * unit());
  EXPECT_NEAR(slid.vx, 9.5, 100 * unit());
  EXPECT_EQ(slid.y, -19);
}

/// Bounces of u = 1e-3 and less are too many to be executed one by one: 5e6 in the first scene. The
/// hits of the floor are counted to within the rounding of T g/2u, and below a flight of 2^-40 of
/// the step it is rest.
TEST_P(FreeFlight, TakesTheSmallestBouncesTogether)
{
  double const g = 10, T = 1000;
  for (double const u : {1e-3, 1e-8, 4e-9, 1e-30}) {
    auto const run = start(alone(g, elastic, {3, -19, 0.01, u}, T), GetParam());
    run->advance(1);
    auto const disc = states(run)[0];
    double const flights = T * g / (2 * u), expected = flights < 0x1p40 ? flights : 1;
    EXPECT_NEAR(static_cast<double>(run->report().wall_hits), expected,
                1 + 100 * unit() * expected);
    EXPECT_NEAR(disc.x, 13, 1e5 * unit());
    EXPECT_LE(std::fabs(disc.vy), u * (1 + 100 * unit()));
    EXPECT_LE(disc.y + 19, u * u / g + 100 * unit());
  }
  // Nearly elastic, on the way to a side wall and back: with many bounces at once.
  auto const run = start(alone(g, apart(1 - 1e-6, 1), {3, -19, 1, 1e-2}, 100), GetParam());
  run->advance(1);
  auto const disc = states(run)[0];
  EXPECT_NEAR(disc.x, 11, 1e-3) << "16 to the wall, 38 to the other, 38 back and 8 more, or nearly";
}

TEST_P(FreeFlight, KeepsTheEnergyOfElasticDiscs)
{
  for (double const gravity : {0.0, 10.0}) {
    Scene scene = alone(gravity, elastic, {}, 0.7);
    scene.discs = random_discs(scene.model, 100, 30, Ids::shuffled, 9);
    for (auto& disc : scene.discs)
      disc = {0.9 * disc.x, 0.9 * disc.y, disc.vx, disc.vy};
    auto const report = report_after(scene, GetParam(), 1000);
    EXPECT_GT(report.wall_hits, 50000);
    // Two roundings a bounce and disc, in the mean in no direction: the square root of 2000 of
    // them.
    EXPECT_NEAR(report.energy.kinetic + report.energy.potential, report.energy.initial(),
                500 * unit() * report.energy.initial());
    EXPECT_LE(std::fabs(report.energy.residual()), 500 * unit() * scale(report.energy));
  }
}

TEST_P(FreeFlight, IsTheSameHoweverItIsCalledAndFromACheckpoint)
{
  Scene scene = alone(9.81, apart(0.9, 0.95), {}, 0.3);
  scene.model.box.x = periodic;
  scene.discs = separate_discs(scene.model, 200, 20, 5);
  auto const at_once = states_after(scene, GetParam(), 50);
  EXPECT_TRUE(same_bits(states(start_and_look(scene, GetParam(), 50)), at_once));
  expect_same_across_restart(scene, GetParam(), 20, 30);
  expect_same_from_checkpoint(scene, GetParam(), 20, 30);
}

/// It has no velocity left there, which could tell the ceiling from the floor.
TEST_P(FreeFlight, TurnsRoundAtACeilingThatIsJustReached)
{
  auto const run = start(alone(10, elastic, {0, 14, 0, 10}, 1.5), GetParam());
  run->advance(1);
  EXPECT_TRUE(close(states(run), {{0, 19 - 10 * 0.25 / 2, 0, -5}}, 100 * unit()));
}

TEST_P(FreeFlight, RefusesDiscsBeyondAWall)
{
  EXPECT_THROW(start(alone(0, elastic, {19.5, 0, 0, 0}, 1), GetParam()), std::invalid_argument);
}

} // namespace
} // namespace ricochet::test
