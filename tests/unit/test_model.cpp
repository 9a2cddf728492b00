// What makes a scene impossible, and that every reason is named.
#include "ricochet/engine.hpp"
#include "support/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>

namespace ricochet::test {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();

Model good_model()
{
  return make_model(20, 10, 9.81, {Law::restitution, 0.9, 0.8});
}

std::vector<std::string> quantities(Model const& model)
{
  std::vector<std::string> result;
  for (auto const& problem : problems(model)) {
    result.push_back(problem.quantity);
    EXPECT_FALSE(problem.found.empty());
    EXPECT_FALSE(problem.allowed.empty());
  }
  return result;
}

struct Wrong {
  std::string quantity;
  std::function<void(Model&, double)> set;
  std::vector<double> refused, accepted;
};

std::vector<Wrong> const quantities_with_limits = {
    {"box.width",
     [](Model& m, double v) { m.box.width = v; },
     {nan, infinity, -infinity, -20, 0, std::nextafter(2.0, 0.0)},
     {2, 1e12}},
    {"box.height",
     [](Model& m, double v) { m.box.height = v; },
     {nan, infinity, -infinity, -20, 0, std::nextafter(2.0, 0.0)},
     {2, 1e12}},
    {"discs.radius",
     [](Model& m, double v) { m.radius = v; },
     {nan, infinity, -infinity, -1, 0},
     {1e-12, 5}},
    {"forces.gravity",
     [](Model& m, double v) { m.gravity = v; },
     {nan, infinity, -infinity},
     {-9.81, 0, 1e6}},
    {"contact.restitution",
     [](Model& m, double v) { m.contact.restitution = v; },
     {nan, infinity, -1e-9, std::nextafter(1.0, 2.0)},
     {0, 1}},
    {"contact.friction",
     [](Model& m, double v) { m.contact.friction = v; },
     {nan, infinity, -1e-9, std::nextafter(1.0, 2.0)},
     {0, 1}}};

TEST(Model, WithoutFaultHasNoProblems)
{
  EXPECT_TRUE(problems(good_model()).empty());
  EXPECT_TRUE(problems(Model{}).empty()) << "the defaults";
}

TEST(Model, OutsideALimitIsRefusedByTheNameOfTheQuantity)
{
  for (auto const& limit : quantities_with_limits)
    for (double const value : limit.refused) {
      auto model = good_model();
      limit.set(model, value);
      EXPECT_EQ(quantities(model), std::vector<std::string>{limit.quantity}) << value;
    }
}

TEST(Model, AtALimitIsAccepted)
{
  for (auto const& limit : quantities_with_limits)
    for (double const value : limit.accepted) {
      auto model = good_model();
      limit.set(model, value);
      EXPECT_EQ(quantities(model), std::vector<std::string>{}) << limit.quantity << " = " << value;
    }
}

TEST(Model, WithSeveralFaultsNamesThemAll)
{
  auto model = good_model();
  for (auto const& limit : quantities_with_limits)
    limit.set(model, nan);
  auto const named = quantities(model);
  for (auto const& limit : quantities_with_limits)
    EXPECT_EQ(std::count(named.begin(), named.end(), limit.quantity), 1) << limit.quantity;
}

// Discs would fall for ever, and their potential energy would mean nothing.
TEST(Model, WithGravityAcrossAPeriodicAxisIsRefused)
{
  auto model = good_model();
  model.box.y = Boundary::periodic;
  EXPECT_EQ(problems(model).size(), 1u);
  model.gravity = -1;
  EXPECT_EQ(problems(model).size(), 1u);
  model.gravity = 0;
  EXPECT_TRUE(problems(model).empty());
  model.gravity = 9.81;
  model.box = {20, 10, Boundary::periodic, Boundary::walls};
  EXPECT_TRUE(problems(model).empty()) << "across x it may";
}

TEST(Model, NamesEveryDiscThatIsOutsideOrNotANumber)
{
  auto const model = good_model();
  std::vector<DiscState> const discs = {
      {0, 0, 0, 0},          {nan, 0, 0, 0},          {0, -infinity, 0, 0},
      {0, 0, infinity, nan}, {10, -5, 1e150, -1e150}, {std::nextafter(10.0, 11.0), 0, 0, 0},
      {0, -5.001, 0, 0}};
  auto const found = problems(model, discs);
  std::vector<std::pair<std::size_t, std::string>> named;
  for (auto const& p : found) {
    named.push_back({p.disc, p.problem.quantity});
    EXPECT_FALSE(p.problem.found.empty());
    EXPECT_FALSE(p.problem.allowed.empty());
  }
  std::vector<std::pair<std::size_t, std::string>> const expected = {{1, "x"},  {2, "y"}, {3, "vx"},
                                                                     {3, "vy"}, {5, "x"}, {6, "y"}};
  EXPECT_EQ(named, expected);
}

// A disc whose centre is inside may poke through a wall.
TEST(Model, TakesDiscsThatPokeThroughAWall)
{
  EXPECT_TRUE(problems(good_model(), {{9.5, 4.5, 0, 0}, {-10, -5, 0, 0}}).empty());
}

/// The message of the exception, or "accepted".
std::string refusal(Model const& model, double dt, std::vector<DiscState> const& discs)
{
  try {
    make_engine(model, {EngineKind::sweep, Precision::double_, dt, Placement::serial}, discs);
  } catch (std::invalid_argument const& error) {
    return error.what();
  }
  return "accepted";
}

TEST(Engine, IsNotMadeForAnImpossibleSceneAndSaysWhy)
{
  auto model = good_model();
  model.radius = -1;
  model.contact.friction = 2;
  auto const message = refusal(model, 0.01, {{0, nan, 0, 0}});
  for (auto const* const part : {"discs.radius", "contact.friction", "-1", "2", "y", "nan"})
    EXPECT_NE(message.find(part), std::string::npos) << part << " in: " << message;
}

TEST(Engine, IsNotMadeForAStepThatIsNoStep)
{
  EXPECT_EQ(refusal(good_model(), 0.01, {}), "accepted");
  for (double const dt : {0.0, -0.01, nan, infinity})
    EXPECT_NE(refusal(good_model(), dt, {}).find("dt"), std::string::npos) << dt;
}

TEST(PackingFraction, IsTheAreaOfTheDiscsOverThatOfTheBox)
{
  auto model = make_model(10, 20, 0, {});
  model.radius = 0.5;
  EXPECT_DOUBLE_EQ(packing_fraction(model, 40), 40 * 3.14159265358979323846 * 0.25 / 200);
  EXPECT_EQ(packing_fraction(model, 0), 0);
}

} // namespace
} // namespace ricochet::test
