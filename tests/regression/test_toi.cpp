// Engine `toi` equals the serial reference of its scheme bit for bit, however it is run.
//
// Bits are the whole claim here, so no tolerance appears.
#include "support/compare.hpp"
#include "support/runs.hpp"
#include "support/same_runs.hpp"
#include "support/toi_reference.hpp"

#include <gtest/gtest.h>

namespace ricochet::test {
namespace {

constexpr auto walls = Boundary::walls, periodic = Boundary::periodic;

Contact const elastic{Law::swap_scale, 1, 1};
Contact const scaling{Law::swap_scale, 0.93, 0.9};
Contact const damping{Law::restitution, 0.9, 0.8};
Contact const sticky{Law::restitution, 0, 0};

Scene fluid(std::size_t count, double packing, double speed, double gravity, Contact const& contact,
            Boundary x, Boundary y, std::uint64_t seed)
{
  double const height = height_for(count, packing, 1.3);
  Scene scene;
  scene.model = make_model(1.3 * height, height, gravity, contact, x, y);
  scene.discs = separate_discs(scene.model, count, speed, seed);
  scene.dt = 0.02;
  return scene;
}

template <class Real>
void expect_reference_bits(Scene const& scene, Precision precision,
                           std::vector<std::int64_t> const& checked_steps)
{
  ToiReference<Real> reference(scene.model, scene.dt, scene.discs);
  auto const serial = start(scene, {EngineKind::toi, precision, Placement::serial});
  auto const parallel = start(scene, {EngineKind::toi, precision, Placement::parallel});
  SCOPED_TRACE(std::string(name(precision)) + " precision");
  expect_bits_of(reference, serial, parallel, checked_steps);
  if (testing::Test::HasFatalFailure())
    return;
  auto const report = serial->report();
  auto const& books = reference.books();
  EXPECT_TRUE(same_bits(parallel->report(), report));
  EXPECT_EQ(report.collisions, books.collisions);
  EXPECT_EQ(report.wall_hits, books.wall_hits);
  // Kept apart in the reference to 64 bits a term, here to 2^-80 of the energy.
  double const rounding = 1e-12 * scale(report.energy);
  EXPECT_NEAR(report.energy.lost_pairs, static_cast<double>(books.lost_pairs), rounding);
  EXPECT_NEAR(report.energy.lost_walls, static_cast<double>(books.lost_walls), rounding);
  EXPECT_NEAR(report.energy.numerical, static_cast<double>(books.numerical), rounding);
}

void expect_reference_bits(Scene const& scene, std::vector<std::int64_t> const& checked_steps)
{
  expect_reference_bits<double>(scene, Precision::double_, checked_steps);
  expect_reference_bits<float>(scene, Precision::single_, checked_steps);
}

/// Steps from a fiftieth of a radius to several boxes, in which discs have one contact or many.
TEST(ToiBits, AreTheReferencesAtEveryPackingAndStep)
{
  std::uint64_t seed = 1;
  for (auto const x : {walls, periodic})
    for (auto const y : {walls, periodic})
      for (double const gravity : {0.0, 9.81, -3.0})
        for (auto const& contact : {elastic, scaling, damping}) {
          if (y == periodic && gravity != 0)
            continue;
          if (gravity < 0 && contact.restitution == 1)
            continue;
          for (double const packing : {0.05, 0.4, 0.75})
            for (double const speed : {1.0, 30.0, 1000.0}) {
              if (speed == 1000 && packing != 0.4)
                continue;
              SCOPED_TRACE(testing::Message()
                           << "x " << name(x) << ", y " << name(y) << ", gravity " << gravity
                           << ", alpha " << contact.restitution << ", " << name(contact.law)
                           << ", packing " << packing << ", speed " << speed);
              expect_reference_bits(fluid(67, packing, speed, gravity, contact, x, y, seed++),
                                    speed > 100 ? std::vector<std::int64_t>{1, 2}
                                                : std::vector<std::int64_t>{1, 2, 9});
              if (HasFatalFailure() || HasNonfatalFailure())
                return;
            }
        }
}

/// Long enough for discs to settle on the floor and on each other, where rounds run out.
TEST(ToiBits, AreTheReferencesInAHeap)
{
  for (auto const& contact : {damping, scaling, sticky}) {
    SCOPED_TRACE(testing::Message()
                 << "alpha " << contact.restitution << ", " << name(contact.law));
    auto const scene = fluid(50, 0.5, 2, 200, contact, walls, walls, 5);
    expect_reference_bits(scene, {50, 100});
    ToiReference<double> reference(scene.model, scene.dt, scene.discs);
    reference.advance(100);
    if (contact.restitution > 0) {
      EXPECT_EQ(reference.books().longest_step, 31) << "no contact was ever left to the next step";
    }
  }
}

/// Enough discs for several cells and steps between two sorts.
TEST(ToiBits, AreTheReferencesForManyDiscs)
{
  expect_reference_bits(fluid(700, 0.5, 1, 0, elastic, periodic, periodic, 7), {20});
  expect_reference_bits(fluid(700, 0.2, 4, 9.81, damping, walls, walls, 8), {20});
  expect_reference_bits(fluid(700, 0.05, 8, 9.81, scaling, periodic, walls, 9), {40});
}

/// All discs are in a corner of a box that is sparse on the whole, so that they are sorted into
/// large cells and there are more candidates than discs.
TEST(ToiBits, AreTheReferencesInACrowd)
{
  for (double const speed : {0.3, 3.0}) {
    auto scene = fluid(150, 0.75, speed, 0, damping, walls, walls, 11);
    double const shift_x = 2 * scene.model.box.width, shift_y = 2 * scene.model.box.height;
    for (auto& disc : scene.discs) {
      disc.x -= shift_x;
      disc.y -= shift_y;
    }
    scene.model.box.width *= 5;
    scene.model.box.height *= 5;
    expect_reference_bits(scene, {10, 40, 80});
  }
}

/// Boxes of one to a few cells, where discs have neighbours, or images of them, on both sides.
TEST(ToiBits, AreTheReferencesInSmallPeriodicBoxes)
{
  std::uint64_t seed = 20;
  for (std::size_t const count : {2, 3, 5, 9, 16})
    for (double const packing : {0.05, 0.15, 0.3})
      for (double const speed : {0.5, 5.0}) {
        SCOPED_TRACE(testing::Message() << count << " discs, packing " << packing);
        expect_reference_bits(fluid(count, packing, speed, 0, elastic, periodic, periodic, seed++),
                              {25, 60});
        expect_reference_bits(fluid(count, packing, speed, 9.81, scaling, periodic, walls, seed++),
                              {25, 60});
      }
}

/// A triangular lattice, all velocities equal and opposite in turn: everything happens at once.
TEST(ToiBits, AreTheReferencesWhereEverythingIsSimultaneous)
{
  auto scene = fluid(144, 0.6, 0, 0, elastic, periodic, periodic, 9);
  scene.discs.clear();
  double const w = scene.model.box.width / 12, h = scene.model.box.height / 12;
  for (int row = 0; row < 12; ++row)
    for (int column = 0; column < 12; ++column)
      scene.discs.push_back({(column - 5.5) * w, (row - 5.5) * h,
                             (row + column) % 2 == 0 ? 8.0 : -8.0, row % 2 == 0 ? 8.0 : -8.0});
  scene.dt = 0.25;
  expect_reference_bits(scene, {1, 2, 3, 8});
}

// How often discs are sorted must not show, nor who looks: a report sorts them.
TEST(ToiBits, DoNotDependOnHowTheStepsAreAskedFor)
{
  auto const scene = fluid(500, 0.5, 5, 9.81, damping, periodic, walls, 3);
  for (auto const& way : ways_of(EngineKind::toi)) {
    SCOPED_TRACE(name(way));
    auto const one_by_one = start_and_look(scene, way, 30);
    auto const at_once = start(scene, way);
    at_once->advance(30);
    EXPECT_TRUE(same_bits(states(one_by_one), states(at_once)));
    EXPECT_TRUE(same_bits(one_by_one->report(), at_once->report()));
  }
}

TEST(ToiBits, AreTheSameAcrossARestart)
{
  auto const scene = fluid(500, 0.5, 5, 9.81, damping, periodic, walls, 4);
  for (auto const& way : ways_of(EngineKind::toi))
    expect_same_across_restart(scene, way, 13, 12);
}

TEST(ToiBits, AreTheSameFromACheckpoint)
{
  auto const scene = fluid(500, 0.5, 5, 9.81, damping, periodic, walls, 4);
  for (auto const& way : ways_of(EngineKind::toi))
    expect_same_from_checkpoint(scene, way, 13, 12);
}

} // namespace
} // namespace ricochet::test
