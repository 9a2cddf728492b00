// Engine `events`: the same events as a serial event-driven program that was written without sight
// of it, closed forms, and conservation laws.
//
// Its result differs from exact arithmetic by rounding, which collisions amplify: a deviation grows
// by a factor of about 65, 4 and 2 a collision of each disc at packing 0.05, 0.3 and 0.6, for the
// path between collisions is that much longer than a disc. Two correct programs therefore agree for
// a time only, here about 5 collisions a disc at 0.05 and 40 at 0.6.
#include "support/compare.hpp"
#include "support/event_reference.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;
Contact const elastic{Law::swap_scale, 1, 1};
Way const way{EngineKind::events, Precision::double_, Placement::serial};
Way const single_way{EngineKind::events, Precision::single_, Placement::serial};

/// `count` separate discs of radius 1 with this packing, and the step that the fastest could cross
/// a diameter in.
Scene gas(std::size_t count, double packing, double gravity, Contact const& contact, Boundary x,
          Boundary y, std::uint64_t seed)
{
  double const height = height_for(count, packing, 1.25);
  Scene scene;
  scene.model = make_model(1.25 * height, height, gravity, contact, x, y);
  scene.discs = separate_discs(scene.model, count, 1, seed);
  return scene;
}

reference::EventDriven reference_of(Scene const& scene)
{
  auto const& m = scene.model;
  reference::Scene const same{m.box.width,
                              m.box.height,
                              m.radius,
                              m.gravity,
                              m.box.x == periodic,
                              m.box.y == periodic,
                              m.contact.law == Law::swap_scale ? reference::Law::swap_scale
                                                               : reference::Law::restitution,
                              m.contact.restitution,
                              m.contact.friction};
  std::vector<reference::Disc> discs;
  for (auto const& d : scene.discs)
    discs.push_back({d.x, d.y, d.vx, d.vy});
  return {same, discs};
}

std::vector<DiscState> states_of(reference::EventDriven const& run)
{
  std::vector<DiscState> result;
  for (auto const& d : run.states())
    result.push_back({d.x, d.y, d.vx, d.vy});
  return result;
}

/// Largest distance of a disc from its counterpart, nearest images.
double largest_distance(Model const& model, std::vector<DiscState> const& a,
                        std::vector<DiscState> const& b)
{
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    double dx = a[i].x - b[i].x, dy = a[i].y - b[i].y;
    if (model.box.x == periodic)
      dx -= model.box.width * std::round(dx / model.box.width);
    if (model.box.y == periodic)
      dy -= model.box.height * std::round(dy / model.box.height);
    largest = std::max(largest, std::hypot(dx, dy));
  }
  return largest;
}

double energy(Model const& model, std::vector<DiscState> const& discs)
{
  return static_cast<double>(kinetic_energy(discs) + potential_energy(model, discs));
}

struct Setting {
  double packing, gravity;
  Contact contact;
  Boundary x, y;
};

std::string name_of(testing::TestParamInfo<Setting> const& info)
{
  auto const& s = info.param;
  return "packing_" + std::to_string(std::lround(100 * s.packing)) + "_x_" + name(s.x) + "_y_" +
         name(s.y) + (s.gravity == 0 ? "_weightless_" : "_gravity_") +
         (s.contact.restitution == 1 && s.contact.friction == 1 ? "elastic" : name(s.contact.law));
}

std::vector<Setting> settings()
{
  std::vector<Setting> all;
  for (double const packing : {0.05, 0.2, 0.4, 0.6, 0.8})
    for (auto const& contact :
         {elastic, Contact{Law::swap_scale, 0.93, 0.9}, Contact{Law::restitution, 0.95, 0.8}})
      for (auto const x : {walls, periodic})
        for (auto const y : {walls, periodic})
          for (double const gravity : {0.0, 0.05}) {
            bool const comes_to_rest = gravity != 0 && contact.restitution < 1 && packing > 0.5;
            if ((gravity == 0 || y == walls) && !comes_to_rest)
              all.push_back({packing, gravity, contact, x, y});
          }
  return all;
}

class SerialReference : public testing::TestWithParam<Setting> {};

/// Rounding of the first collisions, some 1e-14 of a coordinate, times the growth above in the four
/// or five collisions that a disc has here at most, is below 1e-14 * 65^5 = 1e-5 in the most dilute
/// gas.
TEST_P(SerialReference, HasTheSameEventsAndPlaces)
{
  auto const s = GetParam();
  std::size_t const count = 150;
  Scene scene = gas(count, s.packing, s.gravity, s.contact, s.x, s.y, 11);
  if (s.gravity != 0 && s.contact.restitution < 1) { // no disc starts so low that it soon rests
    scene.model.box.height += 20;
    for (auto& disc : scene.discs)
      disc.y += 10;
  }
  auto reference = reference_of(scene);
  scene.dt = 0.37; // frames fall anywhere between events
  auto const run = start(scene, way);
  std::int64_t const collisions = s.packing < 0.1 ? 150 : 400;
  for (int frame = 1; run->report().collisions < collisions; ++frame) {
    ASSERT_LT(frame, 2000);
    run->advance(1);
    reference.advance(frame * scene.dt);
    auto const report = run->report();
    ASSERT_EQ(report.collisions, reference.pair_events()) << "frame " << frame;
    ASSERT_EQ(report.wall_hits, reference.wall_events()) << "frame " << frame;
    ASSERT_LT(largest_distance(scene.model, states(run), states_of(reference)), 1e-5)
        << "frame " << frame;
  }
}

INSTANTIATE_TEST_SUITE_P(Of, SerialReference, testing::ValuesIn(settings()), name_of);

/// Boxes that are only a few discs wide, where a pair can meet on both sides.
TEST(Events, OfSmallPeriodicBoxesAreTheReferences)
{
  for (double const width : {2.5, 3.9, 4.5, 7.0})
    for (double const height : {2.3, 4.1, 9.0, 30.0}) {
      Scene scene;
      scene.model = make_model(width, height, 0, elastic, periodic, periodic);
      auto count = static_cast<std::size_t>(0.6 * width * height / 3.15) + 1;
      do
        scene.discs = separate_discs(scene.model, count--, 1, 3);
      while (deepest_overlap(scene.model, scene.discs) > 0);
      scene.dt = 0.71;
      auto reference = reference_of(scene);
      auto const run = start(scene, way);
      for (int frame = 1; frame <= 8; ++frame) {
        run->advance(1);
        reference.advance(frame * scene.dt);
        ASSERT_EQ(run->report().collisions, reference.pair_events())
            << width << " x " << height << ", frame " << frame;
        ASSERT_LT(largest_distance(scene.model, states(run), states_of(reference)), 1e-6)
            << width << " x " << height << ", frame " << frame;
      }
    }
}

/// Two discs alone, any impact parameter: the contact time is the root of |d + w t| = 2 r, the
/// velocities the law's. Tolerance: a few roundings of numbers of size 10.
TEST(Events, OfTwoDiscsAreThoseOfTheClosedForm)
{
  for (double const offset : {0.0, 0.3, 1.0, 1.7, 1.99})
    for (double const alpha : {1.0, 0.6, 0.0}) {
      SCOPED_TRACE(testing::Message() << "offset " << offset << ", alpha " << alpha);
      Scene scene;
      scene.model = make_model(40, 40, 0, {Law::restitution, alpha, 1});
      scene.discs = {{-3, 0, 1, 0.25}, {3, offset, -1, 0.25}};
      scene.dt = 3.5;
      auto const run = start(scene, way);
      run->advance(1);

      double const reach = std::sqrt(4 - offset * offset), t = (6 - reach) / 2;
      double const nx = reach / 2, ny = offset / 2; // from the first to the second
      double const kick = (1 + alpha) / 2 * (-2 * nx), rest = scene.dt - t;
      std::vector<DiscState> const expected{
          {-3 + t + (1 + kick * nx) * rest, 0.25 * scene.dt + kick * ny * rest, 1 + kick * nx,
           0.25 + kick * ny},
          {3 - t - (1 + kick * nx) * rest, offset + 0.25 * scene.dt - kick * ny * rest,
           -1 - kick * nx, 0.25 - kick * ny}};
      EXPECT_EQ(run->report().collisions, 1);
      EXPECT_TRUE(close(states(run), expected, 1e-13));
    }
}

/// A ball dropped from h on a floor with alpha: impact n is at sqrt(2 h/g) [1 + 2(a + ... +
/// a^(n-1))]. Between impacts n and n + 1 it is on a parabola that begins at the floor with a^n
/// sqrt(2 g h). Relative error 1e-12: each of the impacts adds a few roundings.
TEST(Events, OfABouncingBallAreThoseOfTheClosedForm)
{
  double const g = 9.81, h = 7;
  for (double const alpha : {1.0, 0.9, 0.5}) {
    SCOPED_TRACE(testing::Message() << "alpha " << alpha);
    Scene scene;
    scene.model = make_model(20, 30, g, {Law::restitution, alpha, 1});
    double const floor = -15 + 1;
    scene.discs = {{0, floor + h, 0, 0}};
    int const impacts = alpha == 1 ? 1000 : 12;
    double power = 1, sum = 1;
    for (int n = 1; n < impacts; ++n) {
      power *= alpha;
      sum += 2 * power;
    }
    double const last = std::sqrt(2 * h / g) * sum; // time of the last impact
    double const speed = power * alpha * std::sqrt(2 * g * h), late = speed / g / 3;
    scene.dt = (last + late) / 7;
    auto const run = start(scene, way);
    run->advance(7);
    auto const ball = states(run)[0];
    EXPECT_EQ(run->report().wall_hits, impacts);
    EXPECT_NEAR(ball.y - floor, speed * late - g * late * late / 2, 1e-12 * impacts * h);
    EXPECT_NEAR(ball.vy, speed - g * late, 1e-12 * impacts * speed);
  }
}

/// 100 collisions a disc; each moves the energy by some roundings of two discs' part of it, at
/// random, so that 1e-12 of the whole is never reached.
TEST(Events, OfElasticDiscsConserveEnergy)
{
  for (double const gravity : {0.0, 0.1})
    for (auto const x : {walls, periodic}) {
      SCOPED_TRACE(testing::Message() << "gravity " << gravity << ", x " << name(x));
      Scene scene = gas(300, 0.4, gravity, elastic, x, walls, 5);
      scene.dt = 5;
      auto const run = start(scene, way);
      while (run->report().collisions < 15000)
        run->advance(1);
      double const before = energy(scene.model, scene.discs);
      EXPECT_NEAR(energy(scene.model, states(run)), before, 1e-12 * before);
      EXPECT_NEAR(run->report().energy.residual(), 0, 1e-12 * before);
    }
}

/// What the laws take is what is missing, to rounding.
TEST(Events, BalanceTheBooks)
{
  for (auto const law : {Law::swap_scale, Law::restitution}) {
    Scene scene = gas(300, 0.3, 0, {law, 0.97, 0.9}, walls, periodic, 8);
    scene.dt = 30;
    auto const run = start(scene, way);
    run->advance(1);
    auto const report = run->report();
    EXPECT_GT(report.collisions, 1000);
    EXPECT_GT(report.energy.lost_pairs, 0.05 * report.energy.initial());
    EXPECT_GT(report.energy.lost_walls, 0);
    EXPECT_EQ(report.energy.numerical, 0);
    EXPECT_NEAR(report.energy.residual(), 0, 1e-12 * report.energy.initial());
  }
}

/// Without walls; for `restitution` at any alpha and beta.
TEST(Events, InAPeriodicBoxConserveMomentum)
{
  for (auto const& contact : {elastic, Contact{Law::restitution, 0.9, 0.7}}) {
    Scene scene = gas(300, 0.4, 0, contact, periodic, periodic, 6);
    scene.dt = 40;
    auto const run = start(scene, way);
    run->advance(1);
    ASSERT_GT(run->report().collisions, 1000);
    auto const now = states(run);
    double const of_all = 300; // speeds are about 1
    EXPECT_NEAR(static_cast<double>(momentum_x(now)), static_cast<double>(momentum_x(scene.discs)),
                1e-13 * of_all);
    EXPECT_NEAR(static_cast<double>(momentum_y(now)), static_cast<double>(momentum_y(scene.discs)),
                1e-13 * of_all);
  }
}

/// A deviation of 1e-15 grows there and back: over two collisions a disc each way at packing 0.5,
/// where it grows by a factor of about 2.5 a collision, to 1e-15 * 2.5^4 on average; 1e-9 leaves
/// room for the discs that collide most.
TEST(Events, OfElasticDiscsRunBackwards)
{
  for (double const gravity : {0.0, 0.1}) {
    Scene scene = gas(300, 0.5, gravity, elastic, walls, walls, 9);
    scene.model.box.width += 0.5; // no disc starts at a wall
    scene.model.box.height += 0.5;
    scene.dt = 1;
    auto const there = start(scene, way);
    std::int64_t steps = 0;
    for (; there->report().collisions < 600; ++steps)
      there->advance(1);
    Scene back = scene;
    back.discs = states(there);
    for (auto& disc : back.discs) {
      disc.vx = -disc.vx;
      disc.vy = -disc.vy;
    }
    auto now = states_after(back, way, steps);
    for (auto& disc : now) {
      disc.vx = -disc.vx;
      disc.vy = -disc.vy;
    }
    EXPECT_TRUE(close(now, scene.discs, 1e-9));
  }
}

/// Mirroring or turning the scene turns the motion: bit for bit where that only changes signs or
/// exchanges x and y, for no operation rounds differently, as long as no two events coincide.
TEST(Events, OfATurnedSceneAreTheTurnedEvents)
{
  Scene scene = gas(300, 0.4, 0, {Law::restitution, 0.95, 0.9}, walls, periodic, 10);
  scene.dt = 3;
  auto const straight = states_after(scene, way, 4);

  Scene mirrored = scene;
  for (auto& d : mirrored.discs)
    d = {-d.x, d.y, -d.vx, d.vy};
  auto back = states_after(mirrored, way, 4);
  for (auto& d : back)
    d = {-d.x, d.y, -d.vx, d.vy};
  EXPECT_TRUE(close(back, straight, 1e-9));

  Scene turned = scene;
  std::swap(turned.model.box.width, turned.model.box.height);
  std::swap(turned.model.box.x, turned.model.box.y);
  for (auto& d : turned.discs)
    d = {-d.y, d.x, -d.vy, d.vx};
  back = states_after(turned, way, 4);
  for (auto& d : back)
    d = {d.y, -d.x, d.vy, -d.vx};
  EXPECT_LT(largest_distance(scene.model, back, straight), 1e-9);
}

/// Discs in line, touching, the first one hits: the last flies off with its speed. All numbers are
/// exact. The line is one island, found disc by disc: a small one, one with a heap, and one whose
/// members need more room than there is.
TEST(Events, OfNewtonsCradlePassTheMomentumOn)
{
  for (int const count : {5, 20, 100}) {
    Scene scene;
    scene.model = make_model(4096, 16, 0, elastic);
    scene.discs = {{-8, 0, 2, 0}};
    for (int k = 0; k < count - 1; ++k)
      scene.discs.push_back({2.0 * k, 0, 0, 0});
    scene.dt = 4; // it hits at 3
    auto expected = scene.discs;
    expected.front() = {-2, 0, 0, 0};
    expected.back() = {2.0 * (count - 2) + 2, 0, 2, 0};
    for (auto const placement : {Placement::serial, Placement::parallel}) {
      auto const run = start(scene, {EngineKind::events, Precision::double_, placement});
      run->advance(1);
      EXPECT_EQ(run->report().collisions, count - 1);
      EXPECT_LT(largest_deviation(states(run), expected), 1e-12) << count;
    }
  }
}

/// A dense cluster in a large box, which is far from the gas that the length of the first window
/// suits: many are connected in it, each by many events. (Rounding grows by less than a factor of 2
/// a collision, and a disc has about 9 here: 1e-13 * 2^9 < 1e-6.)
TEST(Events, OfADenseClusterAreTheReferences)
{
  Scene scene;
  scene.model = make_model(300, 300, 0, elastic);
  Random random(5);
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 12; ++column) {
      double const vx = random.between(-1, 1), vy = random.between(-1, 1);
      scene.discs.push_back({2.05 * column - 12, 2.05 * row - 12, vx, vy});
    }
  scene.dt = 1;
  auto reference = reference_of(scene);
  auto const run = start(scene, way);
  for (int frame = 1; frame <= 3; ++frame) {
    run->advance(1);
    reference.advance(frame * scene.dt);
    ASSERT_EQ(run->report().collisions, reference.pair_events()) << "frame " << frame;
    ASSERT_LT(largest_distance(scene.model, states(run), states_of(reference)), 1e-6);
  }
  EXPECT_GT(run->report().collisions, 4 * 144);
}

/// A disc (k, at the centre) is in the way of another (m), which a third (b) takes off its way,
/// deflected itself in the same window. So k stays where it is, and is still there when a fourth
/// (i) comes in the next window. In the course of finding that out k was elsewhere when i looked.
TEST(Events, DoNotForgetWhoStaysAfterAll)
{
  DiscState const k{0, 0, 0, 0}, m{-3.2, 0, 1.5, 0}, b{-2.45, 2.9, 0, 0}, e{-2.45, 5.5, 0, -3};
  DiscState const i{0, 4.4, 0, 0}, f{0, 7, 0, -2}; // i is hit at 0.3, and meets k at 1.5
  Scene scene;
  scene.model = make_model(40, 40, 0, elastic);
  scene.dt = 1; // a window
  for (auto const& discs : {std::vector<DiscState>{k, i, m, b, e, f}, {i, k, m, b, e, f}}) {
    scene.discs = discs;
    auto const run = start(scene, way);
    run->advance(2); // without a report, which might have the discs sorted
    EXPECT_EQ(run->report().collisions, 4);
    auto const after = states(run);
    EXPECT_NEAR(after[0].vy + after[1].vy, -2, 1e-12);
    EXPECT_NEAR(std::min(after[0].y, after[1].y), -1, 1e-12); // k, since 1.5
  }
}

/// Rows of discs that all hit their right-hand neighbour at the same time: after it every disc
/// moves as its partner did, to the rounding of places.
TEST(Events, ThatCoincideAllHappen)
{
  Scene scene;
  scene.model = make_model(160, 80, 0, elastic);
  std::vector<DiscState> expected;
  for (int row = 0; row < 18; ++row)
    for (int pair = 0; pair < 18; ++pair) {
      double const x = -72.0 + 8 * pair, y = -36.0 + 4 * row;
      scene.discs.push_back({x, y, 1, 0});
      scene.discs.push_back({x + 4, y, -1, 0});
      expected.push_back({x, y, -1, 0});
      expected.push_back({x + 4, y, 1, 0});
    }
  scene.dt = 2; // they meet at 1
  auto const run = start(scene, way);
  run->advance(1);
  EXPECT_EQ(run->report().collisions, 18 * 18);
  EXPECT_TRUE(close(states(run), expected, 1e-13));
}

/// In single precision the same laws hold to its rounding.
TEST(Events, InSinglePrecisionFollowTheSameLaws)
{
  Scene scene = gas(300, 0.4, 0, elastic, periodic, walls, 12);
  scene.dt = 20;
  auto const run = start(scene, single_way);
  run->advance(2);
  auto const report = run->report();
  EXPECT_GT(report.collisions, 1000);
  EXPECT_NEAR(report.energy.kinetic, report.energy.kinetic_initial,
              1e-5 * report.energy.kinetic_initial);
  EXPECT_LT(report.max_overlap, 1e-4);
}

} // namespace
} // namespace ricochet::test
