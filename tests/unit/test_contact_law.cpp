// The contact laws as functions of two velocities and a normal.
#include "ricochet/contact_law.hpp"
#include "support/random.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace ricochet::test {
namespace {

template <class Real>
struct Encounter {
  Vec2<Real> n;
  PairVelocity<Real> v;
};

/// Unit normals in all directions, velocities up to 10, approaching and separating.
template <class Real>
std::vector<Encounter<Real>> encounters()
{
  Random random(11);
  auto const real = [&](double lo, double hi) { return static_cast<Real>(random.between(lo, hi)); };
  std::vector<Encounter<Real>> result;
  for (int k = 0; k < 2000; ++k) {
    Vec2<Real> const d{real(-2, 2), real(-2, 2)};
    result.push_back({contact_normal(d, std::sqrt(dot(d, d))),
                      {{real(-10, 10), real(-10, 10)}, {real(-10, 10), real(-10, 10)}}});
  }
  return result;
}

/// The rounding of a dozen operations on numbers up to 20, in a normal that is itself rounded.
template <class Real>
constexpr Real tolerance = 32 * 20 * std::numeric_limits<Real>::epsilon();

template <class Real>
Vec2<Real> tangent(Vec2<Real> n)
{
  return {-n.y, n.x};
}

template <class Real>
Real energy(PairVelocity<Real> v)
{
  return (dot(v.first, v.first) + dot(v.second, v.second)) / 2;
}

template <class Real>
bool same(PairVelocity<Real> a, PairVelocity<Real> b)
{
  return a.first == b.first && a.second == b.second;
}

template <class Real>
class ContactLaw : public testing::Test {
};
using Reals = testing::Types<double, float>;
TYPED_TEST_SUITE(ContactLaw, Reals);

TYPED_TEST(ContactLaw, ElasticExchangesTheNormalComponentsAndKeepsTheTangential)
{
  using Real = TypeParam;
  for (auto const& [n, v] : encounters<Real>()) {
    auto const t = tangent(n);
    auto const after = Elastic<Real>{}(n, v);
    EXPECT_NEAR(dot(after.first, n), dot(v.second, n), tolerance<Real>);
    EXPECT_NEAR(dot(after.second, n), dot(v.first, n), tolerance<Real>);
    EXPECT_NEAR(dot(after.first, t), dot(v.first, t), tolerance<Real>);
    EXPECT_NEAR(dot(after.second, t), dot(v.second, t), tolerance<Real>);
  }
}

TYPED_TEST(ContactLaw, ElasticConservesEnergyAndMomentum)
{
  using Real = TypeParam;
  for (auto const& [n, v] : encounters<Real>()) {
    auto const after = Elastic<Real>{}(n, v);
    EXPECT_NEAR(energy(after), energy(v), 20 * tolerance<Real>);
    EXPECT_NEAR(after.first.x + after.second.x, v.first.x + v.second.x, tolerance<Real>);
    EXPECT_NEAR(after.first.y + after.second.y, v.first.y + v.second.y, tolerance<Real>);
  }
}

TYPED_TEST(ContactLaw, SwapScaleSwapsTheNormalComponentsTimesAlphaAndScalesTheTangentialByBeta)
{
  using Real = TypeParam;
  Real const alpha = Real(0.7), beta = Real(0.4);
  for (auto const& [n, v] : encounters<Real>()) {
    auto const t = tangent(n);
    auto const after = SwapScale<Real>{alpha, beta}(n, v);
    EXPECT_NEAR(dot(after.first, n), alpha * dot(v.second, n), tolerance<Real>);
    EXPECT_NEAR(dot(after.second, n), alpha * dot(v.first, n), tolerance<Real>);
    EXPECT_NEAR(dot(after.first, t), beta * dot(v.first, t), tolerance<Real>);
    EXPECT_NEAR(dot(after.second, t), beta * dot(v.second, t), tolerance<Real>);
  }
}

TYPED_TEST(ContactLaw, RestitutionReversesTheRelativeNormalVelocityTimesAlpha)
{
  using Real = TypeParam;
  for (Real const alpha : {Real(0), Real(0.5), Real(0.93), Real(1)})
    for (auto const& [n, v] : encounters<Real>()) {
      auto const after = Restitution<Real>(alpha, Real(0.4))(n, v);
      EXPECT_NEAR(dot(after.second - after.first, n), -alpha * dot(v.second - v.first, n),
                  tolerance<Real>);
    }
}

TYPED_TEST(ContactLaw, RestitutionMultipliesTheRelativeTangentialVelocityByBeta)
{
  using Real = TypeParam;
  for (Real const beta : {Real(0), Real(0.5), Real(0.93), Real(1)})
    for (auto const& [n, v] : encounters<Real>()) {
      auto const t = tangent(n);
      auto const after = Restitution<Real>(Real(0.7), beta)(n, v);
      EXPECT_NEAR(dot(after.second - after.first, t), beta * dot(v.second - v.first, t),
                  tolerance<Real>);
    }
}

TYPED_TEST(ContactLaw, RestitutionConservesMomentum)
{
  using Real = TypeParam;
  for (auto const& [n, v] : encounters<Real>()) {
    auto const after = Restitution<Real>(Real(0.7), Real(0.4))(n, v);
    EXPECT_NEAR(after.first.x + after.second.x, v.first.x + v.second.x, tolerance<Real>);
    EXPECT_NEAR(after.first.y + after.second.y, v.first.y + v.second.y, tolerance<Real>);
  }
}

// Galilean invariance: the same collision seen from a moving frame.
TYPED_TEST(ContactLaw, RestitutionIsTheSameInEveryFrame)
{
  using Real = TypeParam;
  Vec2<Real> const frame{Real(3), Real(-5)};
  Restitution<Real> const law(Real(0.7), Real(0.4));
  for (auto const& [n, v] : encounters<Real>()) {
    auto const here = law(n, v);
    auto const there = law(n, {v.first + frame, v.second + frame});
    EXPECT_NEAR(there.first.x, here.first.x + frame.x, tolerance<Real>);
    EXPECT_NEAR(there.first.y, here.first.y + frame.y, tolerance<Real>);
    EXPECT_NEAR(there.second.x, here.second.x + frame.x, tolerance<Real>);
    EXPECT_NEAR(there.second.y, here.second.y + frame.y, tolerance<Real>);
  }
}

TYPED_TEST(ContactLaw, NoLawCreatesEnergy)
{
  using Real = TypeParam;
  for (Real const alpha : {Real(0), Real(0.5), Real(1)})
    for (Real const beta : {Real(0), Real(0.5), Real(1)})
      for (auto const& [n, v] : encounters<Real>()) {
        auto const most = energy(v) + 20 * tolerance<Real>;
        EXPECT_LE(energy(SwapScale<Real>{alpha, beta}(n, v)), most);
        EXPECT_LE(energy(Restitution<Real>(alpha, beta)(n, v)), most);
      }
}

TYPED_TEST(ContactLaw, AtOneAndOneEveryLawIsTheElasticOneToTheBit)
{
  using Real = TypeParam;
  for (auto const& [n, v] : encounters<Real>()) {
    auto const elastic = Elastic<Real>{}(n, v);
    EXPECT_TRUE(same(SwapScale<Real>{1, 1}(n, v), elastic));
    EXPECT_TRUE(same(Restitution<Real>(1, 1)(n, v), elastic));
  }
}

// Which disc is called the first is a matter of words.
TYPED_TEST(ContactLaw, EveryLawTreatsBothDiscsAlikeToTheBit)
{
  using Real = TypeParam;
  auto const expect_symmetry = [](auto const& law) {
    for (auto const& [n, v] : encounters<Real>()) {
      auto const one = law(n, v);
      auto const other = law(Real(-1) * n, {v.second, v.first});
      EXPECT_TRUE(same(one, {other.second, other.first}));
    }
  };
  expect_symmetry(Elastic<Real>{});
  expect_symmetry(SwapScale<Real>{Real(0.7), Real(0.4)});
  expect_symmetry(Restitution<Real>(Real(0.7), Real(0.4)));
}

TYPED_TEST(ContactLaw, ANormalHasUnitLengthHoweverSmallTheSeparation)
{
  using Real = TypeParam;
  Random random(3);
  Real scale = 1;
  for (int k = 0; k < 40; ++k, scale /= 2)
    for (int sample = 0; sample < 20; ++sample) {
      Vec2<Real> const d{scale * static_cast<Real>(random.between(-1, 1)),
                         scale * static_cast<Real>(random.between(-1, 1))};
      auto const n = contact_normal(d, std::sqrt(dot(d, d)));
      // The length of n errs by the rounding of the distance (2) and of two divisions.
      EXPECT_NEAR(dot(n, n), 1, 8 * std::numeric_limits<Real>::epsilon());
      EXPECT_GE(dot(n, d), 0) << "a normal points from the first disc to the second";
    }
}

TYPED_TEST(ContactLaw, DiscsWithTheSameCentreHaveTheNormalPlusX)
{
  using Real = TypeParam;
  EXPECT_TRUE((contact_normal<Real>({0, 0}, 0) == Vec2<Real>{1, 0}));
}

template <class Real, template <class> class Expected>
bool chosen(Contact const& contact)
{
  return std::holds_alternative<Expected<Real>>(contact_law<Real>(contact));
}

TYPED_TEST(ContactLaw, OfASceneIsTheCheapestThatFits)
{
  using Real = TypeParam;
  EXPECT_TRUE((chosen<Real, Elastic>({Law::swap_scale, 1, 1})));
  EXPECT_TRUE((chosen<Real, Elastic>({Law::restitution, 1, 1})));
  EXPECT_TRUE((chosen<Real, SwapScale>({Law::swap_scale, 0.93, 1})));
  EXPECT_TRUE((chosen<Real, SwapScale>({Law::swap_scale, 1, 0.93})));
  EXPECT_TRUE((chosen<Real, Restitution>({Law::restitution, 0.93, 1})));
  EXPECT_TRUE((chosen<Real, Restitution>({Law::restitution, 1, 0.93})));
}

TYPED_TEST(ContactLaw, OfASceneHasItsCoefficients)
{
  using Real = TypeParam;
  // Head on along x, and sliding past each other along y.
  PairVelocity<Real> const v{{2, 1}, {-2, -1}};
  auto const with = [&](Law law) {
    return std::visit(
        [&](auto const& rule) {
          return rule({1, 0}, v);
        },
        contact_law<Real>({law, 0.5, 0.25}));
  };
  for (auto const law : {Law::swap_scale, Law::restitution})
    EXPECT_TRUE(same(with(law), {{-1, Real(0.25)}, {1, Real(-0.25)}})) << static_cast<int>(law);
}

} // namespace
} // namespace ricochet::test
