#include "event_reference.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>

namespace ricochet::reference {

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

struct Vec2 {
  double x, y;
};

Vec2 operator+(Vec2 a, Vec2 b)
{
  return {a.x + b.x, a.y + b.y};
}
Vec2 operator-(Vec2 a, Vec2 b)
{
  return {a.x - b.x, a.y - b.y};
}
Vec2 operator*(double s, Vec2 a)
{
  return {s * a.x, s * a.y};
}
double dot(Vec2 a, Vec2 b)
{
  return a.x * b.x + a.y * b.y;
}

/// Time until two discs of diameter `sigma` touch; gravity drops out of the relative motion.
///
/// |dr + dv t| = sigma with b = dr.dv < 0 has the first root t = (-b - sqrt D) / dv^2,
/// D = b^2 - dv^2 c, c = dr^2 - sigma^2; multiplied by its conjugate it does not cancel.
double time_to_touch(Vec2 dr, Vec2 dv, double sigma)
{
  double const b = dot(dr, dv);
  if (b >= 0)
    return never;
  double const c = dot(dr, dr) - sigma * sigma;
  if (c <= 0)
    return 0; // overlapping and approaching
  double const discriminant = b * b - dot(dv, dv) * c;
  if (discriminant < 0)
    return never;
  return c / (-b + std::sqrt(discriminant));
}

/// Time until a disc at height `h` above a line, rising at `v`, comes down through it: the later
/// root of h + v t - g t^2 / 2 = 0, in the form that does not cancel. A disc found below the line
/// that cannot rise to it is given the top of its path.
double time_to_fall(double h, double v, double g)
{
  double const speed = std::sqrt(std::max(0.0, v * v + 2 * g * h));
  if (v >= 0)
    return (v + speed) / g;
  return std::max(0.0, 2 * h / (speed - v));
}

/// Time until a disc `h` below a line, rising at `v` > 0, first reaches it: the earlier root of
/// v t - g t^2 / 2 = h; none if v^2 < 2 g h.
double time_to_rise(double h, double v, double g)
{
  if (h <= 0)
    return 0;
  double const square = v * v - 2 * g * h;
  if (square < 0)
    return never;
  return 2 * h / (v + std::sqrt(square));
}

/// Time to close a gap at a constant speed > 0.
double time_to_close(double gap, double speed)
{
  return std::max(0.0, gap / speed);
}

/// Velocities after a contact with unit normal n from the first to the second disc.
std::pair<Vec2, Vec2> after_contact(Scene const& scene, Vec2 n, Vec2 v1, Vec2 v2)
{
  double const u1 = dot(v1, n), u2 = dot(v2, n);
  Vec2 const t1 = v1 - u1 * n, t2 = v2 - u2 * n;
  double const alpha = scene.alpha, beta = scene.beta;

  if (scene.law == Law::swap_scale)
    return {alpha * u2 * n + beta * t1, alpha * u1 * n + beta * t2};

  double const keep = (1 - alpha) / 2, swap = (1 + alpha) / 2;
  double const own = (1 + beta) / 2, other = (1 - beta) / 2;
  return {(keep * u1 + swap * u2) * n + own * t1 + other * t2,
          (keep * u2 + swap * u1) * n + own * t2 + other * t1};
}

/// n with floor(a / n), for n > 0.
std::int64_t floor_div(std::int64_t a, std::int64_t n)
{
  return a >= 0 ? a / n : -((-a + n - 1) / n);
}

std::int64_t cells_along(double length, double least_width)
{
  return std::max(std::int64_t{1}, static_cast<std::int64_t>(std::floor(length / least_width)));
}

/// How many periods x lies away from [-period/2, period/2).
std::int64_t periods(double x, double period)
{
  return static_cast<std::int64_t>(std::floor(x / period + 0.5));
}

double wrapped(double x, double period)
{
  double const y = x - period * static_cast<double>(periods(x, period));
  // A point a rounding below the lower edge lands on the upper one, which is the lower one.
  return y >= 0.5 * period ? -0.5 * period : std::max(y, -0.5 * period);
}

std::int64_t cell_index(double x, double length, double width, std::int64_t count)
{
  auto const k = static_cast<std::int64_t>(std::floor((x + 0.5 * length) / width));
  return std::clamp(k, std::int64_t{0}, count - 1);
}

void check(Scene const& s, std::vector<Disc> const& discs)
{
  auto const demand = [](bool fine, char const* sentence) {
    if (!fine)
      throw std::invalid_argument(std::string("reference engine: ") + sentence);
  };
  demand(std::isfinite(s.width) && std::isfinite(s.height) && std::isfinite(s.gravity),
         "width, height and gravity must be finite");
  demand(s.radius > 0, "radius must be positive");
  demand(s.width >= 2 * s.radius && s.height >= 2 * s.radius, "a disc must fit into the box");
  demand(s.gravity >= 0, "gravity must not be negative (it points down)");
  demand(!(s.periodic_y && s.gravity > 0), "gravity needs walls in y (energy has no zero)");
  demand(s.alpha >= 0 && s.alpha <= 1, "alpha must be in 0 .. 1");
  demand(s.beta >= 0 && s.beta <= 1, "beta must be in 0 .. 1");
  for (Disc const& d : discs) {
    demand(std::isfinite(d.x) && std::isfinite(d.y) && std::isfinite(d.vx) && std::isfinite(d.vy),
           "positions and velocities must be finite");
    demand(s.periodic_x || std::abs(d.x) <= 0.5 * s.width, "a centre lies outside the box in x");
    demand(s.periodic_y || std::abs(d.y) <= 0.5 * s.height, "a centre lies outside the box in y");
  }
}

} // namespace

bool EventDriven::Later::operator()(Forecast const& a, Forecast const& b) const
{
  if (a.time != b.time)
    return a.time > b.time;
  return std::tie(a.kind, a.first, a.second, a.image.x, a.image.y) >
         std::tie(b.kind, b.first, b.second, b.image.x, b.image.y);
}

EventDriven::EventDriven(Scene const& scene, std::vector<Disc> const& discs,
                         double least_cell_width)
  : scene_(scene)
{
  check(scene, discs);

  // Discs in cells that are not neighbours must be more than a diameter apart, also after
  // rounding. About one disc per cell keeps both crossings and candidates few.
  double const per_disc =
      std::sqrt(scene.width * scene.height / std::max(1.0, static_cast<double>(discs.size())));
  double const least = std::max({2.002 * scene.radius, per_disc, least_cell_width});
  columns_ = cells_along(scene.width, least);
  rows_ = cells_along(scene.height, least);
  cell_width_ = scene.width / static_cast<double>(columns_);
  cell_height_ = scene.height / static_cast<double>(rows_);
  cell_head_.resize(static_cast<std::size_t>(columns_ * rows_));

  bodies_.reserve(discs.size());
  for (Disc const& d : discs)
    bodies_.push_back({d.x, d.y, d.vx, d.vy, 0, 0, 0, 0, false, {nobody, {}}, nobody, nobody});
  rebase();
}

void EventDriven::advance(double time)
{
  double const target = (time - epoch_) - epoch_low_;
  run(target, std::numeric_limits<std::int64_t>::max());
  // A rebase on the way moved the epoch.
  now_ = std::max(now_, (time - epoch_) - epoch_low_);
}

void EventDriven::advance_events(std::int64_t count)
{
  run(never, count);
}

std::vector<Disc> EventDriven::states() const
{
  std::vector<Disc> result;
  result.reserve(bodies_.size());
  for (Body const& body : bodies_) {
    Body const b = flown(body, now_);
    result.push_back({scene_.periodic_x ? wrapped(b.x, scene_.width) : b.x,
                      scene_.periodic_y ? wrapped(b.y, scene_.height) : b.y, b.vx, b.vy});
  }
  return result;
}

/// The event loop: runs what is forecast up to `last_time`, counted from the epoch of the call.
void EventDriven::run(double last_time, std::int64_t count)
{
  // Rounding of a contact time grows with the time since the epoch; a few contacts per disc
  // keep it at that of a single flight.
  auto const contacts_per_rebase = static_cast<std::int64_t>(4 * bodies_.size() + 16);

  while (count > 0 && !forecasts_.empty() && forecasts_.top().time <= last_time) {
    Forecast const next = forecasts_.top();
    forecasts_.pop();
    if (is_void(next))
      continue;
    now_ = next.time;
    if (next.kind == Kind::crossing) {
      cross(next);
      continue;
    }
    guard_against_stall();
    if (next.kind == Kind::wall)
      bounce(next);
    else if (!collide(next))
      continue;
    --count;
    if (++contacts_since_rebase_ >= contacts_per_rebase) {
      last_time -= now_;
      rebase();
    }
  }
}

bool EventDriven::is_void(Forecast const& f) const
{
  return f.first_contacts != bodies_[f.first].contacts ||
         (f.kind == Kind::pair && f.second_contacts != bodies_[f.second].contacts);
}

/// The exact parabola: y' = y + v t - g t^2 / 2, v' = v - g t.
EventDriven::Body EventDriven::flown(Body const& b, double time) const
{
  double const t = time - b.clock;
  Body after = b;
  after.x += b.vx * t;
  after.y += (b.vy - 0.5 * scene_.gravity * t) * t;
  after.vy -= scene_.gravity * t;
  after.clock = time;
  return after;
}

/// Starts a new time count at the present: all discs here, wrapped, all forecasts anew.
void EventDriven::rebase()
{
  std::vector<Image> moved(bodies_.size());
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& b = bodies_[i];
    b = flown(b, now_);
    b.clock = 0;
    b.falling = false;
    if (scene_.periodic_x) {
      double const x = b.x;
      b.x = wrapped(x, scene_.width);
      moved[i].x = std::llround((b.x - x) / scene_.width);
    }
    if (scene_.periodic_y) {
      double const y = b.y;
      b.y = wrapped(y, scene_.height);
      moved[i].y = std::llround((b.y - y) / scene_.height);
    }
  }

  // Sum in twice the precision (Knuth's TwoSum), lest long runs lose the time of day.
  double const sum = epoch_ + now_;
  double const part = sum - epoch_;
  epoch_low_ += (epoch_ - (sum - part)) + (now_ - part);
  epoch_ = sum;
  now_ = 0;
  contacts_since_rebase_ = 0;

  std::fill(cell_head_.begin(), cell_head_.end(), nobody);
  forecasts_ = {};
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    Body& b = bodies_[i];
    if (b.last.disc != nobody) {
      b.last.image.x += moved[i].x - moved[b.last.disc].x;
      b.last.image.y += moved[i].y - moved[b.last.disc].y;
    }
    b.column = cell_index(b.x, scene_.width, cell_width_, columns_);
    b.row = cell_index(b.y, scene_.height, cell_height_, rows_);
    link(i);
  }
  for (std::size_t i = 0; i < bodies_.size(); ++i) {
    forecast_neighbours(i, true);
    forecast_walls(i);
    forecast_crossing(i);
  }
}

/// Simultaneous contacts are fine, also many of them in a symmetric start; a rest is not. Judged
/// by the time since the start: right after a rebase the bounces of a ball near rest would still
/// advance a clock at 0, without end.
void EventDriven::guard_against_stall()
{
  if (time() > stall_time_) {
    stall_time_ = time();
    stall_events_ = 0;
  } else if (++stall_events_ > static_cast<std::int64_t>(1000 + 64 * bodies_.size())) {
    throw std::runtime_error("reference engine: event times no longer increase (rest on the floor "
                             "or inelastic collapse): not a scene for event-driven dynamics");
  }
}

std::size_t EventDriven::cell(std::int64_t column, std::int64_t row) const
{
  std::int64_t const c = column - columns_ * floor_div(column, columns_);
  std::int64_t const r = row - rows_ * floor_div(row, rows_);
  return static_cast<std::size_t>(r * columns_ + c);
}

void EventDriven::link(std::size_t i)
{
  Body& b = bodies_[i];
  std::size_t& head = cell_head_[cell(b.column, b.row)];
  b.previous = nobody;
  b.next = head;
  if (head != nobody)
    bodies_[head].previous = i;
  head = i;
}

void EventDriven::unlink(std::size_t i)
{
  Body const& b = bodies_[i];
  if (b.next != nobody)
    bodies_[b.next].previous = b.previous;
  if (b.previous != nobody)
    bodies_[b.previous].next = b.next;
  else
    cell_head_[cell(b.column, b.row)] = b.next;
}

/// `image` is that of j, seen from i.
void EventDriven::forecast_pair(std::size_t i, std::size_t j, Image image)
{
  if (i > j) {
    std::swap(i, j);
    image = {-image.x, -image.y};
  }
  Body const& a = bodies_[i];
  Body const& b = bodies_[j];
  // The partners of a contact point at each other until either has another one.
  if (a.last.disc == j && b.last.disc == i && a.last.image.x == image.x &&
      a.last.image.y == image.y && b.last.image.x == -image.x && b.last.image.y == -image.y)
    return;

  double const start = std::max(a.clock, b.clock);
  Body const p = flown(a, start), q = flown(b, start);
  Vec2 const dr{(q.x - p.x) + static_cast<double>(image.x) * scene_.width,
                (q.y - p.y) + static_cast<double>(image.y) * scene_.height};
  double const t = time_to_touch(dr, {q.vx - p.vx, q.vy - p.vy}, 2 * scene_.radius);
  if (t < never)
    forecasts_.push({std::max(start + t, now_), Kind::pair, i, j, image, a.contacts, b.contacts});
}

/// Pairs i with whatever is in one cell, addressed unwrapped: a small periodic box may offer the
/// same cell, and the same disc, through several images.
void EventDriven::forecast_cell(std::size_t i, std::int64_t column, std::int64_t row,
                                bool each_pair_once)
{
  if (!scene_.periodic_x && (column < 0 || column >= columns_))
    return;
  if (!scene_.periodic_y && (row < 0 || row >= rows_))
    return;
  for (std::size_t j = cell_head_[cell(column, row)]; j != nobody; j = bodies_[j].next) {
    if (j == i || (each_pair_once && j < i))
      continue; // a disc keeps its distance from its own images
    Body const& other = bodies_[j];
    forecast_pair(i, j, {(column - other.column) / columns_, (row - other.row) / rows_});
  }
}

void EventDriven::forecast_neighbours(std::size_t i, bool each_pair_once)
{
  Body const& b = bodies_[i];
  for (std::int64_t dr = -1; dr <= 1; ++dr)
    for (std::int64_t dc = -1; dc <= 1; ++dc)
      forecast_cell(i, b.column + dc, b.row + dr, each_pair_once);
}

/// Only right after a contact of i or a rebase: its state must be of the present.
void EventDriven::forecast_walls(std::size_t i)
{
  Body const& b = bodies_[i];
  auto const push = [&](double t, Wall wall) {
    if (t < never)
      forecasts_.push(
          {b.clock + t, Kind::wall, i, static_cast<std::size_t>(wall), {}, b.contacts, 0});
  };

  if (!scene_.periodic_x) {
    double const reach = 0.5 * scene_.width - scene_.radius;
    if (b.vx > 0)
      push(time_to_close(reach - b.x, b.vx), right_wall);
    else if (b.vx < 0)
      push(time_to_close(b.x + reach, -b.vx), left_wall);
  }

  if (!scene_.periodic_y) {
    double const g = scene_.gravity;
    double const reach = 0.5 * scene_.height - scene_.radius;
    if (g > 0) {
      double const rise = b.vy > 0 ? time_to_rise(reach - b.y, b.vy, g) : never;
      if (rise < never)
        push(rise, ceiling_wall);
      else
        push(time_to_fall(b.y + reach, b.vy, g), floor_wall);
    } else if (b.vy > 0) {
      push(time_to_close(reach - b.y, b.vy), ceiling_wall);
    } else if (b.vy < 0) {
      push(time_to_close(b.y + reach, -b.vy), floor_wall);
    }
  }
}

/// When, and through which face, i leaves its present cell. Faces are named like the walls.
void EventDriven::forecast_crossing(std::size_t i)
{
  Body const& b = bodies_[i];
  double time = never;
  Wall face = left_wall;
  auto const offer = [&](double t, Wall candidate) {
    if (t < time) {
      time = t;
      face = candidate;
    }
  };
  auto const x_of = [&](std::int64_t k) {
    return static_cast<double>(k) * cell_width_ - 0.5 * scene_.width;
  };
  auto const y_of = [&](std::int64_t k) {
    return static_cast<double>(k) * cell_height_ - 0.5 * scene_.height;
  };
  // At a wall there is no next cell; the wall itself is met earlier.
  bool const has_left = scene_.periodic_x || b.column > 0;
  bool const has_right = scene_.periodic_x || b.column < columns_ - 1;
  bool const has_lower = scene_.periodic_y || b.row > 0;
  bool const has_upper = scene_.periodic_y || b.row < rows_ - 1;

  if (b.vx > 0 && has_right)
    offer(time_to_close(x_of(b.column + 1) - b.x, b.vx), right_wall);
  if (b.vx < 0 && has_left)
    offer(time_to_close(b.x - x_of(b.column), -b.vx), left_wall);

  double const g = scene_.gravity;
  if (g > 0) {
    // A disc that has come down into this cell has passed its upper face for good.
    if (b.vy > 0 && !b.falling && has_upper)
      offer(time_to_rise(y_of(b.row + 1) - b.y, b.vy, g), ceiling_wall);
    if (has_lower)
      offer(time_to_fall(b.y - y_of(b.row), b.vy, g), floor_wall);
  } else {
    if (b.vy > 0 && has_upper)
      offer(time_to_close(y_of(b.row + 1) - b.y, b.vy), ceiling_wall);
    if (b.vy < 0 && has_lower)
      offer(time_to_close(b.y - y_of(b.row), -b.vy), floor_wall);
  }

  if (time < never)
    forecasts_.push({std::max(b.clock + time, now_),
                     Kind::crossing,
                     i,
                     static_cast<std::size_t>(face),
                     {},
                     b.contacts,
                     0});
}

/// Moves a disc to the next cell's list and meets the three cells that become neighbours.
void EventDriven::cross(Forecast const& f)
{
  ++crossings_;
  std::size_t const i = f.first;
  Body& b = bodies_[i];
  unlink(i);
  std::int64_t dc = 0, dr = 0;
  switch (static_cast<Wall>(f.second)) {
  case left_wall:
    dc = -1;
    break;
  case right_wall:
    dc = 1;
    break;
  case floor_wall:
    dr = -1;
    break;
  case ceiling_wall:
    dr = 1;
    break;
  }
  b.column += dc;
  b.row += dr;
  if (dr < 0 && scene_.gravity > 0)
    b.falling = true;
  link(i);

  for (std::int64_t k = -1; k <= 1; ++k)
    forecast_cell(i, b.column + (dc != 0 ? dc : k), b.row + (dr != 0 ? dr : k), false);
  forecast_crossing(i);
}

/// False if nothing happened: rounding can forecast a graze between discs that do not approach.
bool EventDriven::collide(Forecast const& f)
{
  std::size_t const i = f.first, j = f.second;
  Body const a = flown(bodies_[i], f.time), b = flown(bodies_[j], f.time);
  Vec2 const dr{(b.x - a.x) + static_cast<double>(f.image.x) * scene_.width,
                (b.y - a.y) + static_cast<double>(f.image.y) * scene_.height};
  Vec2 const v1{a.vx, a.vy}, v2{b.vx, b.vy};
  if (dot(dr, v2 - v1) >= 0)
    return false;

  Vec2 const n = (1 / std::sqrt(dot(dr, dr))) * dr;
  auto const [w1, w2] = after_contact(scene_, n, v1, v2);
  ++pair_events_;
  virial_ += 0.5 * dot((w2 - v2) - (w1 - v1), dr);
  if (recording_)
    log_.push_back({time(), EventKind::pair, static_cast<int>(i), static_cast<int>(j)});

  auto const leave = [&](std::size_t k, Body const& state, Vec2 v, Partner const& partner) {
    Body& body = bodies_[k];
    body = state;
    body.vx = v.x;
    body.vy = v.y;
    body.falling = false;
    ++body.contacts;
    body.last = partner;
  };
  leave(i, a, w1, {j, f.image});
  leave(j, b, w2, {i, {-f.image.x, -f.image.y}});
  for (std::size_t const k : {i, j}) {
    forecast_neighbours(k, false);
    forecast_walls(k);
    forecast_crossing(k);
  }
  return true;
}

void EventDriven::bounce(Forecast const& f)
{
  std::size_t const i = f.first;
  auto const wall = static_cast<Wall>(f.second);
  Body& b = bodies_[i];
  b = flown(b, f.time);

  bool const vertical = wall == left_wall || wall == right_wall;
  double const outward = wall == right_wall || wall == ceiling_wall ? 1 : -1;
  double& position = vertical ? b.x : b.y;
  double& normal = vertical ? b.vx : b.vy;
  double& tangential = vertical ? b.vy : b.vx;

  position = outward * (0.5 * (vertical ? scene_.width : scene_.height) - scene_.radius);
  // The turning point of a flight may lie on the wall; rounding must not send it through.
  double const speed = std::max(0.0, outward * normal);
  normal = -outward * scene_.alpha * speed;
  tangential *= scene_.beta;

  ++wall_events_;
  wall_impulse_[f.second] += (1 + scene_.alpha) * speed;
  if (recording_)
    log_.push_back({time(), EventKind::wall, static_cast<int>(i), static_cast<int>(wall)});

  b.falling = false;
  ++b.contacts;
  b.last = {nobody, {}};
  forecast_neighbours(i, false);
  forecast_walls(i);
  forecast_crossing(i);
}

} // namespace ricochet::reference
