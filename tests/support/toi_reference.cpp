#include "support/toi_reference.hpp"

#include "ricochet/contact_law.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::test {

namespace {

template <class Real>
constexpr Real never = std::numeric_limits<Real>::infinity();

template <class Real>
Real wrapped(Real x, Real length)
{
  Real const half = length / 2;
  if (x >= -half && x < half)
    return x;
  x = x - length * std::floor((x + half) / length);
  return x >= -half && x < half ? x : -half;
}

long double energy(double vx, double vy)
{
  return (static_cast<long double>(vx) * vx + static_cast<long double>(vy) * vy) / 2;
}

/// Time in which `gap` is covered at first speed `speed` towards it under acceleration `pull`
/// towards it: the positive root of gap = speed t + pull t^2/2 that is met first.
template <class Real>
Real time_to_cover(Real gap, Real speed, Real pull)
{
  gap = std::max(gap, Real(0));
  if (pull == 0)
    return speed > 0 ? gap / speed : never<Real>;
  if (pull < 0 && !(speed > 0))
    return never<Real>;
  Real const square = speed * speed + 2 * pull * gap;
  if (!(square >= 0))
    return never<Real>;
  Real const root = std::sqrt(square);
  if (speed < 0)
    return (root - speed) / pull;
  return speed + root > 0 ? 2 * gap / (speed + root) : Real(0);
}

/// Time in which discs of diameter `size` meet whose centres are (dx, dy) apart.
template <class Real>
Real time_to_meet(Real dx, Real dy, Real wx, Real wy, Real size)
{
  Real const b = dx * wx + dy * wy, c = (dx * dx + dy * dy) - size * size;
  if (!(b < 0))
    return never<Real>;
  if (c <= 0)
    return 0;
  Real const square = b * b - (wx * wx + wy * wy) * c;
  return square >= 0 ? c / (std::sqrt(square) - b) : never<Real>;
}

} // namespace

template <class Real>
ToiReference<Real>::ToiReference(Model const& model, double dt,
                                 std::vector<DiscState> const& initial)
  : model_(model),
    dt_(static_cast<Real>(dt)),
    g_(static_cast<Real>(model.gravity)),
    alpha_(static_cast<Real>(model.contact.restitution)),
    beta_(static_cast<Real>(model.contact.friction)),
    diameter_(static_cast<Real>(2 * model.radius)),
    most_x_(static_cast<Real>(model.box.width / 2 - model.radius)),
    most_y_(static_cast<Real>(model.box.height / 2 - model.radius)),
    width_(static_cast<Real>(model.box.width)),
    height_(static_cast<Real>(model.box.height)),
    walls_x_(model.box.x == Boundary::walls),
    walls_y_(model.box.y == Boundary::walls)
{
  for (auto const& d : initial) {
    Disc disc{static_cast<Real>(d.x), static_cast<Real>(d.y), static_cast<Real>(d.vx),
              static_cast<Real>(d.vy)};
    if (!walls_x_)
      disc.px = wrapped(disc.px, width_);
    if (!walls_y_)
      disc.py = wrapped(disc.py, height_);
    discs_.push_back(disc);
  }
}

template <class Real>
void ToiReference<Real>::advance(std::int64_t steps)
{
  for (std::int64_t k = 0; k < steps; ++k)
    step();
}

template <class Real>
std::vector<DiscState> ToiReference<Real>::states() const
{
  std::vector<DiscState> result;
  for (auto const& d : discs_)
    result.push_back({d.px, d.py, d.wx, d.wy});
  return result;
}

template <class Real>
void ToiReference<Real>::step()
{
  int const n = static_cast<int>(discs_.size());
  auto const any_law = contact_law<Real>(model_.contact);
  int round = 0;
  for (bool something_happens = true; something_happens && round < 32; ++round) {
    something_happens = false;
    images_x_ = walls_x_ ? 0 : images(width_);
    images_y_ = walls_y_ ? 0 : images(height_);
    std::vector<Event> next;
    for (int i = 0; i < n; ++i)
      next.push_back(next_event(i));
    for (int i = 0; i < n; ++i) {
      Event const& event = next[static_cast<std::size_t>(i)];
      if (event.with == wall_x || event.with == wall_y)
        bounce(discs_[static_cast<std::size_t>(i)], event);
      else if (event.with > i && next[static_cast<std::size_t>(event.with)].with == i)
        std::visit([&](auto const& law) { collide(i, event.with, event.time, law); }, any_law);
      something_happens = something_happens || event.with != nobody;
    }
  }
  books_.longest_step = std::max(books_.longest_step, round - 1);
  for (auto& disc : discs_)
    land(disc);
}

/// None if discs come too little closer in a step to meet other images than the nearest, else
/// three.
template <class Real>
int ToiReference<Real>::images(Real length) const
{
  Real fastest = 0;
  for (auto const& d : discs_)
    fastest = std::max({fastest, std::fabs(d.wx), std::fabs(d.wy)});
  return diameter_ + 8 * fastest * dt_ < length / 2 ? 0 : 3;
}

/// Of all events of disc i the first; of simultaneous ones discs before walls, lower ids first.
template <class Real>
typename ToiReference<Real>::Event ToiReference<Real>::next_event(int i) const
{
  Event next = next_wall(discs_[static_cast<std::size_t>(i)]);
  for (int j = 0; j < static_cast<int>(discs_.size()); ++j) {
    Real const time = i == j ? never<Real> : meeting(i, j);
    if (time < dt_ && (time < next.time || (time == next.time && next.with < 0)))
      next = {time, j};
  }
  return next;
}

template <class Real>
typename ToiReference<Real>::Event ToiReference<Real>::next_wall(Disc const& disc) const
{
  Real const from = disc.since, rest = dt_ - from;
  Real const x = disc.px + from * disc.wx;
  Real const y = (disc.py + from * disc.wy) - g_ * from * from / 2;
  Real const vx = disc.wx, vy = disc.wy - g_ * from;
  // Surely between the walls until the end of the step: with and without the fall.
  auto const inside = [](Real place, Real most) { return std::fabs(place) < most; };
  Real const straight = y + vy * rest;
  bool const misses_x = !walls_x_ || (inside(x, most_x_) && inside(x + vx * rest, most_x_));
  bool const misses_y = !walls_y_ || (inside(y, most_y_) && inside(straight, most_y_) &&
                                      inside(straight - g_ * rest * rest / 2, most_y_));
  if (misses_x && misses_y)
    return {dt_, nobody};
  Real time_x = never<Real>, time_y = never<Real>;
  if (walls_x_)
    time_x =
        vx > 0 ? time_to_cover(most_x_ - x, vx, Real(0)) : time_to_cover(most_x_ + x, -vx, Real(0));
  if (walls_y_)
    time_y = std::min(time_to_cover(most_y_ + y, -vy, g_), time_to_cover(most_y_ - y, vy, -g_));
  Event const first =
      time_x <= time_y ? Event{from + time_x, wall_x} : Event{from + time_y, wall_y};
  return first.time < dt_ ? first : Event{dt_, nobody};
}

template <class Real>
Real ToiReference<Real>::nearest_x(Real d) const
{
  if (walls_x_)
    return d;
  return d > width_ / 2 ? d - width_ : (d < -width_ / 2 ? d + width_ : d);
}

template <class Real>
Real ToiReference<Real>::nearest_y(Real d) const
{
  if (walls_y_)
    return d;
  return d > height_ / 2 ? d - height_ : (d < -height_ / 2 ? d + height_ : d);
}

/// Whichever image comes first; two that have met do not meet again in the nearest one.
template <class Real>
Real ToiReference<Real>::meeting(int i, int j) const
{
  auto const &a = discs_[static_cast<std::size_t>(i)], &b = discs_[static_cast<std::size_t>(j)];
  Real const from = std::max(a.since, b.since);
  Real const wx = b.wx - a.wx, wy = b.wy - a.wy;
  Real const dx = nearest_x((b.px - a.px) + from * wx), dy = nearest_y((b.py - a.py) + from * wy);
  bool const met = a.met == j && b.met == i;
  Real first = never<Real>;
  for (int kx = -images_x_; kx <= images_x_; ++kx)
    for (int ky = -images_y_; ky <= images_y_; ++ky)
      if (!met || kx != 0 || ky != 0)
        first =
            std::min(first, time_to_meet(dx + static_cast<Real>(kx) * width_,
                                         dy + static_cast<Real>(ky) * height_, wx, wy, diameter_));
  return from + first;
}

template <class Real>
typename ToiReference<Real>::Motion ToiReference<Real>::motion(Disc const& d, Real t) const
{
  Motion now{d.px + t * d.wx, (d.py + t * d.wy) - g_ * t * t / 2, d.wx, d.wy - g_ * t};
  if (d.rests != 0) {
    now.y = static_cast<Real>(d.rests) * most_y_;
    now.vy = 0;
  }
  return now;
}

template <class Real>
void ToiReference<Real>::set_line(Disc& d, Motion const& now, Real t, int met) const
{
  d.wx = now.vx;
  d.wy = now.vy + g_ * t;
  d.px = now.x - t * d.wx;
  d.py = (now.y + g_ * t * t / 2) - t * d.wy;
  d.since = t;
  d.met = met;
  d.rests = 0;
}

template <class Real>
template <class Law>
void ToiReference<Real>::collide(int i, int j, Real t, Law const& law)
{
  auto &a = discs_[static_cast<std::size_t>(i)], &b = discs_[static_cast<std::size_t>(j)];
  Motion m = motion(a, t), n = motion(b, t);
  Real const dx = nearest_x(n.x - m.x), dy = nearest_y(n.y - m.y);
  auto const normal = contact_normal<Real>({dx, dy}, std::sqrt(dx * dx + dy * dy));
  auto const after = law(normal, PairVelocity<Real>{{m.vx, m.vy}, {n.vx, n.vy}});
  long double const before = energy(m.vx, m.vy) + energy(n.vx, n.vy);
  m.vx = after.first.x;
  m.vy = after.first.y;
  n.vx = after.second.x;
  n.vy = after.second.y;
  set_line(a, m, t, j);
  set_line(b, n, t, i);
  books_.collisions += 1;
  books_.lost_pairs += before - (energy(m.vx, m.vy) + energy(n.vx, n.vy));
}

template <class Real>
void ToiReference<Real>::bounce(Disc& disc, Event const& event)
{
  Real const t = event.time;
  Motion const before = motion(disc, t);
  Motion now = before;
  int rests = 0;
  if (event.with == wall_x) {
    now.x = before.vx < 0 ? -most_x_ : most_x_;
    now.vx = -(alpha_ * before.vx);
    now.vy = beta_ * before.vy;
  } else {
    // In a box one disc high the two are at the same height.
    bool const floor = before.y != 0 ? before.y < 0 : before.vy < 0 || (before.vy == 0 && g_ > 0);
    now.y = floor ? -most_y_ : most_y_;
    now.vx = beta_ * before.vx;
    now.vy = -(alpha_ * before.vy);
    Real const pull = floor ? g_ : -g_, speed = floor ? -before.vy : before.vy;
    // All further bounces would be over before the step is.
    if (pull > 0 && 2 * alpha_ * speed <= pull * (1 - alpha_) * (dt_ - t)) {
      now.vx = beta_ < 1 ? Real(0) : before.vx;
      now.vy = 0;
      rests = floor ? -1 : 1;
    }
  }
  set_line(disc, now, t, nobody);
  if (rests != 0) { // the line that ends the step at rest on the wall
    disc.wy = g_ * dt_;
    disc.py = (now.y + g_ * dt_ * dt_ / 2) - dt_ * disc.wy;
    disc.rests = rests;
  }
  books_.wall_hits += 1;
  books_.lost_walls += energy(before.vx, before.vy) - energy(now.vx, now.vy);
  books_.numerical += static_cast<long double>(g_) * (static_cast<long double>(now.y) - before.y);
}

template <class Real>
void ToiReference<Real>::land(Disc& d)
{
  Real x = d.px + dt_ * d.wx, y = (d.py + dt_ * d.wy) - g_ * dt_ * dt_ / 2;
  Real const fallen = y;
  x = walls_x_ ? std::min(std::max(x, -most_x_), most_x_) : wrapped(x, width_);
  y = walls_y_ ? std::min(std::max(y, -most_y_), most_y_) : wrapped(y, height_);
  books_.numerical += static_cast<long double>(g_) * (static_cast<long double>(y) - fallen);
  d = {x, y, d.wx, d.wy - g_ * dt_};
}

template class ToiReference<float>;
template class ToiReference<double>;

} // namespace ricochet::test
