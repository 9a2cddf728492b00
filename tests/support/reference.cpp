#include "support/reference.hpp"

#include "ricochet/contact_law.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::test {

namespace {

using Wide = long double;

/// Twice the kinetic energy.
template <class Real>
Wide square(Real vx, Real vy)
{
  return Wide{vx} * Wide{vx} + Wide{vy} * Wide{vy};
}

/// What a pair gains in kinetic energy when its velocities `before` become `after`.
template <class Real>
Wide gain(PairVelocity<Real> const& before, PairVelocity<Real> const& after)
{
  return (square(after.first.x, after.first.y) + square(after.second.x, after.second.y) -
          square(before.first.x, before.first.y) - square(before.second.x, before.second.y)) /
         2;
}

/// (change of velocity) . d
template <class Real>
Wide work(Vec2<Real> before, Vec2<Real> after, Real dx, Real dy)
{
  return (Wide{after.x} - Wide{before.x}) * Wide{dx} + (Wide{after.y} - Wide{before.y}) * Wide{dy};
}

template <class Real>
Real nearest_image(Real d, Real length)
{
  if (d > length / 2)
    return d - length;
  if (d < -(length / 2))
    return d + length;
  return d;
}

template <class Real>
Real into_period(Real x, Real half, Real length)
{
  Real const lo = -half, hi = half;
  if (x >= lo && x < hi)
    return x;
  x = x - length * std::floor((x - lo) / length);
  return x >= lo && x < hi ? x : lo;
}

} // namespace

template <class Real>
Reference<Real>::Reference(EngineKind engine, Model const& model, double dt,
                           std::vector<DiscState> const& initial)
  : engine_(engine),
    model_(model),
    radius_(static_cast<Real>(model.radius)),
    diameter_(2 * radius_),
    gravity_(static_cast<Real>(model.gravity)),
    dt_(static_cast<Real>(dt)),
    width_(static_cast<Real>(model.box.width)),
    height_(static_cast<Real>(model.box.height)),
    half_width_(static_cast<Real>(model.box.width / 2)),
    half_height_(static_cast<Real>(model.box.height / 2))
{
  for (auto const& d : initial) {
    discs_.push_back({static_cast<Real>(d.x), static_cast<Real>(d.y), static_cast<Real>(d.vx),
                      static_cast<Real>(d.vy)});
    wrap(discs_.back());
  }
}

template <class Real>
void Reference<Real>::advance(std::int64_t steps)
{
  auto const any_law = contact_law<Real>(model_.contact);
  for (std::int64_t step = 0; step < steps; ++step) {
    std::visit(
        [&](auto const& law) {
          if (engine_ == EngineKind::sweep)
            resolve_pairs_in_order(law);
          else
            resolve_pairs_simultaneously(law);
        },
        any_law);
    move();
    bounce_off_walls();
  }
}

template <class Real>
std::vector<DiscState> Reference<Real>::states() const
{
  std::vector<DiscState> result;
  for (auto const& d : discs_)
    result.push_back({d.x, d.y, d.vx, d.vy});
  return result;
}

/// From one centre to the nearest image of another; only x and y of the result mean anything.
template <class Real>
typename Reference<Real>::Disc Reference<Real>::separation(Disc const& from, Disc const& to) const
{
  Disc d{to.x - from.x, to.y - from.y, 0, 0};
  if (model_.box.x == Boundary::periodic)
    d.x = nearest_image(d.x, width_);
  if (model_.box.y == Boundary::periodic)
    d.y = nearest_image(d.y, height_);
  return d;
}

template <class Real>
void Reference<Real>::note_overlap(Real distance)
{
  double const diameter = diameter_;
  books_.max_overlap = std::max(books_.max_overlap, (diameter - double{distance}) / diameter);
}

template <class Real>
template <class Law>
void Reference<Real>::resolve_pairs_in_order(Law const& law)
{
  Real const reach2 = diameter_ * diameter_;
  for (std::size_t i = 0; i < discs_.size(); ++i)
    for (std::size_t j = i + 1; j < discs_.size(); ++j) {
      auto &a = discs_[i], &b = discs_[j];
      auto const d = separation(a, b);
      Real const d2 = d.x * d.x + d.y * d.y;
      if (!(d2 < reach2))
        continue;

      Real const distance = std::sqrt(d2);
      note_overlap(distance);
      auto const n = contact_normal<Real>({d.x, d.y}, distance);
      PairVelocity<Real> const before{{a.vx, a.vy}, {b.vx, b.vy}};
      auto const after = law(n, before);

      books_.collisions += 1;
      if ((b.vx - a.vx) * n.x + (b.vy - a.vy) * n.y >= 0)
        books_.separating_hits += 1;
      books_.lost_pairs -= gain(before, after);
      books_.virial += (work(before.second, after.second, d.x, d.y) -
                        work(before.first, after.first, d.x, d.y)) /
                       2;

      a.vx = after.first.x;
      a.vy = after.first.y;
      b.vx = after.second.x;
      b.vy = after.second.y;

      Real const y_before = b.y;
      b.x += (diameter_ - distance) * n.x;
      b.y += (diameter_ - distance) * n.y;
      books_.numerical += Wide{gravity_} * (Wide{b.y} - Wide{y_before});
      wrap(b);
    }
}

template <class Real>
template <class Law>
void Reference<Real>::resolve_pairs_simultaneously(Law const& law)
{
  Real const reach2 = diameter_ * diameter_;
  auto const old = discs_;
  for (std::size_t i = 0; i < old.size(); ++i) {
    auto const& a = old[i];
    Wide half_loss = 0, half_virial = 0;
    for (std::size_t j = 0; j < old.size(); ++j) {
      auto const& b = old[j];
      auto const d = separation(a, b);
      Real const d2 = d.x * d.x + d.y * d.y;
      if (i == j || !(d2 < reach2))
        continue;
      Real const distance = std::sqrt(d2);
      note_overlap(distance);
      if (a.x == b.x && a.y == b.y && a.vx == b.vx && a.vy == b.vy)
        continue;

      auto const n = contact_normal<Real>({d.x, d.y}, distance);
      PairVelocity<Real> const before{{a.vx, a.vy}, {b.vx, b.vy}};
      auto const after = law(n, before);
      if (i < j) {
        books_.collisions += 1;
        if ((b.vx - a.vx) * n.x + (b.vy - a.vy) * n.y >= 0)
          books_.separating_hits += 1;
      }
      if (after.first.x == a.vx && after.first.y == a.vy)
        continue;
      discs_[i].vx = after.first.x;
      discs_[i].vy = after.first.y;
      half_loss = -gain(before, after) / 2;
      half_virial = -work(before.first, after.first, d.x, d.y) / 2;
    }
    Wide const gained = (square(discs_[i].vx, discs_[i].vy) - square(a.vx, a.vy)) / 2;
    books_.lost_pairs += half_loss;
    books_.virial += half_virial;
    books_.numerical += gained + half_loss;
  }
}

template <class Real>
void Reference<Real>::move()
{
  Real const kick = gravity_ * dt_;
  for (auto& d : discs_) {
    d.vy -= kick;
    d.x += d.vx * dt_;
    d.y += d.vy * dt_;
    wrap(d);
    books_.numerical -= Wide{kick} * Wide{kick} / 2;
  }
}

template <class Real>
void Reference<Real>::bounce_off_walls()
{
  auto const alpha = static_cast<Real>(model_.contact.restitution);
  auto const beta = static_cast<Real>(model_.contact.friction);
  bool const walls_x = model_.box.x == Boundary::walls, walls_y = model_.box.y == Boundary::walls;
  Real const left = -half_width_, right = half_width_, bottom = -half_height_, top = half_height_;

  for (auto& d : discs_) {
    auto const before = d;
    bool hit_side = false, hit_end = false;
    if (walls_x && d.x - radius_ < left) {
      d.x = d.x + 2 * ((left - d.x) + radius_);
      hit_side = true;
    } else if (walls_x && d.x + radius_ > right) {
      d.x = d.x - 2 * ((d.x + radius_) - right);
      hit_side = true;
    } else if (walls_y && d.y + radius_ > top) {
      d.y = d.y - 2 * ((d.y + radius_) - top);
      hit_end = true;
    } else if (walls_y && d.y - radius_ < bottom) {
      d.y = d.y + 2 * ((bottom - d.y) + radius_);
      hit_end = true;
    }
    if (hit_side) {
      d.vx = -(alpha * d.vx);
      d.vy = beta * d.vy;
    }
    if (hit_end) {
      d.vx = beta * d.vx;
      d.vy = -(alpha * d.vy);
    }
    if (hit_side || hit_end) {
      books_.wall_hits += 1;
      books_.lost_walls += (square(before.vx, before.vy) - square(d.vx, d.vy)) / 2;
      books_.numerical += Wide{gravity_} * (Wide{d.y} - Wide{before.y});
    }
  }
}

template <class Real>
void Reference<Real>::wrap(Disc& disc) const
{
  if (model_.box.x == Boundary::periodic)
    disc.x = into_period(disc.x, half_width_, width_);
  if (model_.box.y == Boundary::periodic)
    disc.y = into_period(disc.y, half_height_, height_);
}

template class Reference<float>;
template class Reference<double>;

double deepest_overlap(Model const& model, std::vector<DiscState> const& discs)
{
  double const diameter = 2 * model.radius;
  double deepest = 0;
  for (std::size_t i = 0; i < discs.size(); ++i)
    for (std::size_t j = i + 1; j < discs.size(); ++j) {
      double dx = discs[j].x - discs[i].x, dy = discs[j].y - discs[i].y;
      if (model.box.x == Boundary::periodic)
        dx = nearest_image(dx, model.box.width);
      if (model.box.y == Boundary::periodic)
        dy = nearest_image(dy, model.box.height);
      deepest = std::max(deepest, 1 - std::sqrt(dx * dx + dy * dy) / diameter);
    }
  return deepest;
}

double farthest_outside(Model const& model, std::vector<DiscState> const& discs)
{
  double farthest = 0;
  for (auto const& d : discs) {
    if (model.box.x == Boundary::walls)
      farthest = std::max(farthest, std::abs(d.x) + model.radius - model.box.width / 2);
    if (model.box.y == Boundary::walls)
      farthest = std::max(farthest, std::abs(d.y) + model.radius - model.box.height / 2);
  }
  return farthest / (2 * model.radius);
}

long double kinetic_energy(std::vector<DiscState> const& discs)
{
  Wide sum = 0;
  for (auto const& d : discs)
    sum += square(d.vx, d.vy) / 2;
  return sum;
}

long double potential_energy(Model const& model, std::vector<DiscState> const& discs)
{
  Wide sum = 0;
  for (auto const& d : discs)
    sum += Wide{d.y} + model.box.height / 2;
  return model.gravity * sum;
}

long double momentum_x(std::vector<DiscState> const& discs)
{
  Wide sum = 0;
  for (auto const& d : discs)
    sum += d.vx;
  return sum;
}

long double momentum_y(std::vector<DiscState> const& discs)
{
  Wide sum = 0;
  for (auto const& d : discs)
    sum += d.vy;
  return sum;
}

} // namespace ricochet::test
