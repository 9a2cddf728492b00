// The engines equal the O(N^2) reference bit for bit; `events` equals itself, however it is run.
//
// Bits are the whole claim here, so no tolerance appears. The scenes start with discs thrown
// anywhere, on top of each other and into the walls: the hardest states an engine can be given.
#include "support/compare.hpp"
#include "support/random.hpp"
#include "support/reference.hpp"
#include "support/runs.hpp"
#include "support/same_runs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;

Contact const elastic{Law::swap_scale, 1, 1};
Contact const scaling{Law::swap_scale, 0.93, 0.9};
Contact const damping{Law::restitution, 0.9, 0.8};

template <class Real>
void expect_reference_bits(Scene const& scene, EngineKind engine, Precision precision,
                           std::vector<std::int64_t> const& checked_steps)
{
  Reference<Real> reference(engine, scene.model, scene.dt, scene.discs);
  auto const serial = start(scene, {engine, precision, Placement::serial});
  auto const parallel = start(scene, {engine, precision, Placement::parallel});

  SCOPED_TRACE(std::string(name(precision)) + " precision");
  expect_bits_of(reference, serial, parallel, checked_steps);
  if (testing::Test::HasFatalFailure())
    return;
  auto const report = serial->report();
  auto const& books = reference.books();
  EXPECT_TRUE(same_bits(parallel->report(), report));
  EXPECT_EQ(report.collisions, books.collisions);
  EXPECT_EQ(report.separating_hits, books.separating_hits);
  EXPECT_EQ(report.wall_hits, books.wall_hits);
  EXPECT_GE(report.max_overlap, books.max_overlap) << "it may have been deeper at the start";

  if (engine != EngineKind::sweep)
    return;
  // However the ordered loop is executed, its bits and its books are the same.
  for (auto const execution :
       {Execution::islands, Execution::crowd, Execution::rounds, Execution::in_order})
    for (auto const placement : {Placement::serial, Placement::parallel}) {
      auto const forced = start(scene, {engine, precision, placement, execution});
      forced->advance(checked_steps.back());
      ASSERT_TRUE(same_bits(states(forced), reference.states()))
          << "execution " << static_cast<int>(execution) << " on " << forced->backend();
      auto books_of_forced = forced->report();
      books_of_forced.executions = report.executions;
      EXPECT_TRUE(same_bits(books_of_forced, report));
    }
}

void expect_reference_bits(Scene const& scene, EngineKind engine,
                           std::vector<std::int64_t> const& checked_steps)
{
  expect_reference_bits<double>(scene, engine, Precision::double_, checked_steps);
  expect_reference_bits<float>(scene, engine, Precision::single_, checked_steps);
}

Scene crowd(std::size_t count, double packing, double speed, Ids ids, double gravity,
            Contact const& contact, Boundary x, Boundary y, std::uint64_t seed)
{
  double const aspect = 1.3, height = height_for(count, packing, aspect);
  Scene scene;
  scene.model = make_model(aspect * height, height, gravity, contact, x, y);
  scene.discs = random_discs(scene.model, count, speed, ids, seed);
  return scene;
}

struct Setting {
  EngineKind engine;
  Boundary x, y;
  double gravity;
  Contact contact;
};

std::string name_of(testing::TestParamInfo<Setting> const& info)
{
  auto const& s = info.param;
  return std::string(name(s.engine)) + "_x_" + name(s.x) + "_y_" + name(s.y) +
         (s.gravity == 0 ? "_weightless_" : "_gravity_") +
         (s.contact.restitution == 1 ? "elastic" : name(s.contact.law));
}

std::vector<Setting> settings()
{
  std::vector<Setting> all;
  for (auto const engine : {EngineKind::sweep, EngineKind::simultaneous})
    for (auto const contact : {elastic, scaling, damping})
      for (auto const x : {walls, periodic})
        for (auto const y : {walls, periodic})
          for (auto const gravity : {0.0, 9.81})
            if (y == walls || gravity == 0)
              all.push_back({engine, x, y, gravity, contact});
  return all;
}

class EngineBits : public testing::TestWithParam<Setting> {};

TEST_P(EngineBits, AreTheReferencesAtEveryPackingAndOrderOfIds)
{
  auto const s = GetParam();
  std::uint64_t seed = 1;
  for (double const packing : {0.05, 0.3, 0.6, 0.9, 1.1})
    for (auto const ids : {Ids::shuffled, Ids::row_major, Ids::reversed}) {
      if (ids != Ids::shuffled && packing != 0.6 && packing != 1.1)
        continue; // the order of ids matters where discs push each other
      SCOPED_TRACE("packing " + std::to_string(packing) + ", ids " + name(ids));
      expect_reference_bits(crowd(173, packing, 20, ids, s.gravity, s.contact, s.x, s.y, seed++),
                            s.engine, {1, 2, 8});
      if (HasFatalFailure())
        return;
    }
}

// Long enough for the crowd to come apart or, with gravity and damping, to settle on the floor.
TEST_P(EngineBits, AreTheReferencesAfterAHundredAndFiftySteps)
{
  auto const s = GetParam();
  expect_reference_bits(crowd(150, 0.5, 20, Ids::row_major, s.gravity, s.contact, s.x, s.y, 99),
                        s.engine, {60, 150});
}

// Steps of up to seven diameters: discs overshoot walls and wrap around, and may end up far
// outside.
TEST_P(EngineBits, AreTheReferencesWhereDiscsCrossTheBoxInAFewSteps)
{
  auto const s = GetParam();
  for (double const packing : {0.1, 0.7})
    expect_reference_bits(
        crowd(101, packing, 600, Ids::shuffled, s.gravity, s.contact, s.x, s.y, 5), s.engine,
        {1, 2, 20});
}

INSTANTIATE_TEST_SUITE_P(Settings, EngineBits, testing::ValuesIn(settings()), name_of);

struct LargeCase {
  double packing;
  Ids ids;
  Setting setting;
};

class LargeEngineBits : public testing::TestWithParam<LargeCase> {};

TEST_P(LargeEngineBits, AreTheReferencesForFiveThousandDiscs)
{
  auto const& c = GetParam();
  auto const& s = c.setting;
  expect_reference_bits(crowd(5000, c.packing, 20, c.ids, s.gravity, s.contact, s.x, s.y, 7),
                        s.engine, {3});
}

constexpr auto sweep = EngineKind::sweep, simultaneous = EngineKind::simultaneous;

std::string name_of_large(testing::TestParamInfo<LargeCase> const& info)
{
  auto const& c = info.param;
  return "packing_" + std::to_string(static_cast<int>(100 * c.packing)) + "_" +
         (c.ids == Ids::row_major ? "row_major" : name(c.ids)) + "_" + name_of({c.setting, 0});
}

INSTANTIATE_TEST_SUITE_P(
    Crowds, LargeEngineBits,
    testing::Values(LargeCase{0.05, Ids::shuffled, {sweep, walls, walls, 9.81, scaling}},
                    LargeCase{0.2, Ids::row_major, {sweep, periodic, periodic, 0, elastic}},
                    LargeCase{0.5, Ids::shuffled, {sweep, walls, walls, 9.81, damping}},
                    LargeCase{0.5, Ids::reversed, {sweep, periodic, walls, 9.81, scaling}},
                    LargeCase{0.8, Ids::row_major, {sweep, walls, walls, 9.81, scaling}},
                    LargeCase{0.8, Ids::shuffled, {sweep, walls, periodic, 0, damping}},
                    LargeCase{1.1, Ids::row_major, {sweep, periodic, periodic, 0, damping}},
                    LargeCase{1.1, Ids::shuffled, {sweep, walls, walls, 0, elastic}},
                    LargeCase{0.2, Ids::shuffled, {simultaneous, walls, walls, 9.81, scaling}},
                    LargeCase{1.1, Ids::row_major, {simultaneous, periodic, periodic, 0, elastic}}),
    name_of_large);

// In parallel the loop is executed out of order and then verified. Each of these states breaks a
// verification that is a little less than complete.

// Rows of discs on a lattice, each pushing the next: with ids in the order of the lattice the
// pushes run through the whole box, and nearly all islands turn out to be one.
TEST(OrderedExecution, IsTheLoopWhereAPushRunsThroughALattice)
{
  for (double const gap : {1.7, 1.95})
    for (auto const x : {walls, periodic}) {
      SCOPED_TRACE("lattice constant " + std::to_string(gap));
      Scene scene;
      scene.model = make_model(24 * gap, 24 * gap, 0, scaling, x, x);
      scene.discs = lattice_discs(scene.model, 576, 5, 11);
      expect_reference_bits(scene, EngineKind::sweep, {1, 2, 10});
    }
}

// Dense random states, one sweep each. To compare where discs were before and after the sweep is
// not enough: a disc may be pushed onto another and away again by a third. Of such states a
// verification of net displacements gets about one in six wrong.
TEST(OrderedExecution, IsTheLoopWhereADiscIsPushedOntoAnotherAndAwayAgain)
{
  for (std::uint64_t seed = 1; seed <= 36; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    double const packing = 0.3 + 0.1 * static_cast<double>(seed % 6);
    auto const ids = seed % 3 == 0 ? Ids::row_major : Ids::shuffled;
    expect_reference_bits(crowd(400, packing, 20, ids, 0, elastic, walls, walls, seed),
                          EngineKind::sweep, {1});
    if (HasFatalFailure())
      return;
  }
}

// Pairs of discs that nearly cover each other, so that half of the discs are pushed by about a
// diameter. One that is pushed so far may end beside a disc that is executed again, for another
// reason, and looks around for less. That is rare, so they are many.
TEST(OrderedExecution, IsTheLoopWhereDiscsArePushedByADiameter)
{
  auto scene = crowd(400000, 0.3, 20, Ids::shuffled, 0, elastic, periodic, periodic, 3);
  auto const n = scene.discs.size();
  std::mt19937_64 random(7);
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  std::uniform_real_distribution<double> offset(-0.3 * scene.model.radius,
                                                0.3 * scene.model.radius);
  auto const inside = [](double place, double length) {
    return std::clamp(place, -0.499 * length, 0.499 * length);
  };
  for (std::size_t k = 1; k < n; k += 2) {
    auto const& other = scene.discs[order[k - 1]];
    auto& disc = scene.discs[order[k]];
    disc.x = inside(other.x + offset(random), scene.model.box.width);
    disc.y = inside(other.y + offset(random), scene.model.box.height);
  }
  auto const hash = [&](Execution execution) {
    auto const run =
        start(scene, {EngineKind::sweep, Precision::double_, Placement::parallel, execution});
    run->advance(1);
    return run->state_hash();
  };
  EXPECT_EQ(hash(Execution::islands), hash(Execution::in_order));
}

// Three islands: discs 0 and 1, 2 and 4, 3 and 5. At first 2 pushes 4 out of the way of 5, which 3
// pushes there. But 0 pushes 1, and that pushes 2 away before it comes to 4. So 4 is not pushed
// when it is executed again, and 5 meets it where it began; 5 is not executed again, so 4 must see
// it.
TEST(OrderedExecution, IsTheLoopWhereADiscIsNotPushedAfterAll)
{
  Scene scene;
  scene.model = make_model(20, 20, 0, scaling, walls, walls);
  ASSERT_EQ(scene.model.radius, 1);
  scene.discs = {{0.15, -3.25, 1, 0}, {0.15, -2.1, 0, 1}, {0, 0, 0, -1},
                 {1.7, 3.99, -1, 0},  {1.8, 0, 2, 1},     {1.7, 2.4, 1, -3}};
  expect_reference_bits(scene, EngineKind::sweep, {1, 3});
}

// A heap at rest on the floor: islands of many discs, and pushes from below and above.
TEST(OrderedExecution, IsTheLoopInASettledHeap)
{
  for (auto const ids : {Ids::shuffled, Ids::row_major, Ids::reversed}) {
    SCOPED_TRACE(name(ids));
    auto scene = crowd(250, 0.4, 5, ids, 9.81, scaling, walls, walls, 21);
    scene.model.gravity = 30;
    expect_reference_bits(scene, EngineKind::sweep, {120});
  }
}

struct ManyDiscs {
  double packing;
  Ids ids;
};

class OrderedExecutionOfMany : public testing::TestWithParam<ManyDiscs> {};

TEST_P(OrderedExecutionOfMany, IsTheLoopForTwentyThousandDiscs)
{
  auto const& c = GetParam();
  auto const scene = crowd(20000, c.packing, 20, c.ids, 9.81, scaling, walls, walls, 31);
  Reference<double> reference(EngineKind::sweep, scene.model, scene.dt, scene.discs);
  reference.advance(2);
  for (auto const execution :
       {Execution::automatic, Execution::islands, Execution::rounds, Execution::in_order}) {
    auto const run =
        start(scene, {EngineKind::sweep, Precision::double_, Placement::parallel, execution});
    run->advance(2);
    ASSERT_TRUE(same_bits(states(run), reference.states()))
        << "execution " << static_cast<int>(execution);
  }
}

std::string name_of_many(testing::TestParamInfo<ManyDiscs> const& info)
{
  auto const& c = info.param;
  return "packing_" + std::to_string(static_cast<int>(100 * c.packing)) + "_" +
         (c.ids == Ids::row_major ? "row_major" : name(c.ids));
}

INSTANTIATE_TEST_SUITE_P(Crowds, OrderedExecutionOfMany,
                         testing::Values(ManyDiscs{0.05, Ids::shuffled},
                                         ManyDiscs{0.2, Ids::row_major},
                                         ManyDiscs{0.5, Ids::shuffled},
                                         ManyDiscs{0.8, Ids::reversed}),
                         name_of_many);

// Boxes down to one disc wide, with fewer cells than a stencil has, and every mixture of terms.
TEST(EngineBits, AreTheReferencesInBoxesOfEveryShape)
{
  Random random(17);
  auto const either = [&] { return random.below(2) == 0; };
  for (int k = 0; k < 250; ++k) {
    SCOPED_TRACE("scene " + std::to_string(k));
    Scene scene;
    auto const side = [&] { return either() ? random.between(2, 9) : random.between(2, 40); };
    double const width = side(), height = either() ? 2.0 : side();
    Contact const contact{either() ? Law::swap_scale : Law::restitution,
                          either() ? 1.0 : random.unit(), either() ? 1.0 : random.unit()};
    scene.model = make_model(width, height, either() ? 0 : random.between(-20, 20), contact,
                             either() ? walls : periodic, either() ? walls : periodic);
    if (scene.model.box.y == periodic)
      scene.model.gravity = 0;
    scene.dt = random.between(0.001, 0.1);
    scene.discs = random_discs(scene.model, random.below(40), random.between(0, 50), Ids::shuffled,
                               random.bits());
    expect_reference_bits(scene, either() ? EngineKind::sweep : EngineKind::simultaneous, {1, 10});
    if (HasFailure())
      return;
  }
}

// A disc's own history must not matter: a run that stops, reports and goes on is the same run.
TEST(EngineBits, DoNotDependOnHowTheStepsAreAskedFor)
{
  auto const scene = crowd(300, 0.6, 20, Ids::shuffled, 9.81, scaling, walls, walls, 3);
  for (auto const& way : all_ways()) {
    SCOPED_TRACE(name(way));
    auto const one_by_one = start_and_look(scene, way, 40);
    auto const at_once = start(scene, way);
    at_once->advance(40);
    EXPECT_TRUE(same_bits(states(one_by_one), states(at_once)));
    EXPECT_TRUE(same_bits(one_by_one->report(), at_once->report()));
  }
}

// So a run can go on from its written states: nothing but the states determines the future.
TEST(EngineBits, AreTheSameAcrossARestart)
{
  auto const scene = crowd(300, 0.6, 20, Ids::shuffled, 9.81, damping, periodic, walls, 4);
  for (auto const& way : all_ways())
    expect_same_across_restart(scene, way, 25, 15);
}

TEST(EngineBits, AreTheSameFromACheckpoint)
{
  auto const sparse = crowd(300, 0.6, 20, Ids::shuffled, 9.81, damping, periodic, walls, 4);
  // Takes some of its steps in order, and for how long depends on those before.
  auto const dense = crowd(2000, 0.3, 20, Ids::shuffled, 9.81, scaling, walls, walls, 5);
  for (auto const& way : all_ways()) {
    expect_same_from_checkpoint(sparse, way, 26, 15);
    expect_same_from_checkpoint(dense, way, 7, 30);
  }
  auto const executions = report_after(dense, sweep_ways()[0], 37).executions;
  EXPECT_GT(executions.in_order, 0);
  EXPECT_GT(executions.islands + executions.crowd, 0);
}

TEST(EngineBits, ACheckpointOfAnotherSceneIsRefused)
{
  auto const scene = crowd(30, 0.3, 20, Ids::shuffled, 9.81, damping, periodic, walls, 4);
  auto const larger = crowd(31, 0.3, 20, Ids::shuffled, 9.81, damping, periodic, walls, 4);
  auto const run = start(scene, sweep_ways()[0]);
  EXPECT_THROW(run->restore(start(larger, sweep_ways()[0])->checkpoint()), std::invalid_argument);
  Checkpoint partial = run->checkpoint();
  partial.integers.erase("steps");
  EXPECT_THROW(run->restore(partial), std::invalid_argument);
}

Scene fluid(std::size_t count, double packing, double gravity, Contact const& contact, Boundary x,
            Boundary y, std::uint64_t seed)
{
  double const height = height_for(count, packing, 1.3);
  Scene scene;
  scene.model = make_model(1.3 * height, height, gravity, contact, x, y);
  scene.discs = separate_discs(scene.model, count, 5, seed);
  scene.dt = 0.2;
  return scene;
}

/// Both ways in which an engine may use the machine, after every step; the books as well.
TEST(EventBits, AreTheSameOnOneThreadAndOnTheDefaultBackend)
{
  for (auto const precision : {Precision::double_, Precision::single_})
    for (double const packing : {0.05, 0.3, 0.6, 0.8})
      for (auto const& contact : {elastic, scaling, damping}) {
        SCOPED_TRACE(testing::Message() << name(precision) << ", packing " << packing << ", alpha "
                                        << contact.restitution << ", " << name(contact.law));
        auto const scene = fluid(800, packing, 0, contact, walls, periodic, 31);
        auto const serial = start(scene, {EngineKind::events, precision, Placement::serial});
        auto const parallel = start(scene, {EngineKind::events, precision, Placement::parallel});
        for (int step = 0; step < 4; ++step) {
          serial->advance(1);
          parallel->advance(1);
          ASSERT_TRUE(same_bits(states(parallel), states(serial))) << "step " << step;
        }
        EXPECT_GT(serial->report().collisions, 20);
        EXPECT_TRUE(same_bits(parallel->report(), serial->report()));
      }
}

// What the past taught the engine, the length of its windows, must not show: a run that goes on
// from written states starts with other windows.
TEST(EventBits, AreTheSameAcrossARestart)
{
  auto const scene = fluid(500, 0.5, 0.5, elastic, periodic, walls, 32);
  for (auto const& way : ways_of(EngineKind::events))
    expect_same_across_restart(scene, way, 3, 3);
}

TEST(EventBits, AreTheSameFromACheckpoint)
{
  auto const scene = fluid(500, 0.5, 0.5, elastic, periodic, walls, 32);
  for (auto const& way : ways_of(EngineKind::events))
    expect_same_from_checkpoint(scene, way, 4, 3);
}

TEST(EventBits, DoNotDependOnHowStepsAreGroupedOrOnWhoLooks)
{
  auto const scene = fluid(500, 0.5, 0, scaling, walls, walls, 33);
  for (auto const& way : ways_of(EngineKind::events)) {
    SCOPED_TRACE(name(way));
    auto const one_by_one = start_and_look(scene, way, 5);
    auto const at_once = start(scene, way);
    at_once->advance(5);
    EXPECT_TRUE(same_bits(states(one_by_one), states(at_once)));
  }
}

// Ids only break ties, and there are none: discs in another order move as they did.
TEST(EventBits, DoNotDependOnTheOrderOfDiscs)
{
  Scene const scene = fluid(500, 0.5, 0, elastic, walls, periodic, 34);
  auto const order = random_order(500, 35);
  Scene other = scene;
  other.discs = reordered(scene.discs, order);
  for (auto const& way : ways_of(EngineKind::events)) {
    SCOPED_TRACE(name(way));
    EXPECT_TRUE(
        same_bits(states_after(other, way, 4), reordered(states_after(scene, way, 4), order)));
  }
}

} // namespace
} // namespace ricochet::test
