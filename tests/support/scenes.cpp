#include "support/scenes.hpp"

#include "support/random.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

namespace ricochet::test {

Model make_model(double width, double height, double gravity, Contact contact, Boundary x,
                 Boundary y)
{
  Model model;
  model.box = {width, height, x, y};
  model.radius = 1;
  model.gravity = gravity;
  model.contact = contact;
  return model;
}

Scene scene_of(double width, double height, double gravity, Contact const& contact,
               std::vector<DiscState> discs, double dt)
{
  return {make_model(width, height, gravity, contact), dt, std::move(discs)};
}

std::vector<std::vector<DiscState>> const& inseparate_discs()
{
  static std::vector<std::vector<DiscState>> const all{
      {{0, 0, 0, 0}, {0, 0, 0, 0}}, {{0, 0, 0, 0}, {1.99, 0, 0, 0}}, {{19.1, 0, 0, 0}}};
  return all;
}

std::vector<DiscState> random_discs(Model const& model, std::size_t count, double speed, Ids ids,
                                    std::uint64_t seed)
{
  Random random(seed);
  double const w = model.box.width / 2, h = model.box.height / 2;
  std::vector<DiscState> discs(count);
  for (auto& d : discs) {
    d.x = random.between(-w, w);
    d.y = random.between(-h, h);
    d.vx = random.between(-speed, speed);
    d.vy = random.between(-speed, speed);
  }
  if (ids == Ids::shuffled)
    return discs;

  auto const row = [&](DiscState const& d) {
    return static_cast<long>((d.y + h) / (2 * model.radius));
  };
  std::sort(discs.begin(), discs.end(), [&](auto const& a, auto const& b) {
    return row(a) != row(b) ? row(a) < row(b) : a.x < b.x;
  });
  if (ids == Ids::reversed)
    std::reverse(discs.begin(), discs.end());
  return discs;
}

std::vector<DiscState> lattice_discs(Model const& model, std::size_t count, double speed,
                                     std::uint64_t seed)
{
  Random random(seed);
  std::size_t columns = 1;
  while (columns * columns * model.box.height < static_cast<double>(count) * model.box.width)
    ++columns;
  std::size_t const rows = (count + columns - 1) / columns;
  double const dx = model.box.width / static_cast<double>(columns);
  double const dy = model.box.height / static_cast<double>(rows);
  std::vector<DiscState> discs(count);
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t const row = k / columns, column = k - row * columns;
    discs[k].x = (static_cast<double>(column) + 0.5) * dx - model.box.width / 2;
    discs[k].y = (static_cast<double>(row) + 0.5) * dy - model.box.height / 2;
    discs[k].vx = random.between(-speed, speed);
    discs[k].vy = random.between(-speed, speed);
  }
  return discs;
}

std::vector<DiscState> separate_discs(Model const& model, std::size_t count, double speed,
                                      std::uint64_t seed)
{
  auto const& box = model.box;
  double const diameter = 2 * model.radius;
  double const width = box.x == Boundary::walls ? box.width - diameter : box.width;
  double const height = box.y == Boundary::walls ? box.height - diameter : box.height;
  // Of all numbers of rows, the one that leaves neighbours farthest apart. Every second row is
  // shifted by half a place; between walls that takes half a place of each row.
  std::size_t best_rows = 0, best_columns = 0;
  double best = 0, dx = 0, dy = 0;
  for (std::size_t rows = 1; rows <= count; ++rows) {
    if (box.y == Boundary::periodic && rows % 2 == 1 && rows > 1)
      continue;
    std::size_t const columns = (count + rows - 1) / rows;
    bool const x_walls = box.x == Boundary::walls, y_walls = box.y == Boundary::walls;
    auto const places = static_cast<double>(columns);
    double const w = width / (x_walls ? std::max(places - 0.5, 0.5) : places);
    double const h = height / std::max(static_cast<double>(rows) - (y_walls ? 1 : 0), 1.0);
    double apart = w;
    if (rows > 1)
      apart = std::min(apart, std::sqrt(w * w / 4 + h * h));
    if (rows > 2)
      apart = std::min(apart, 2 * h);
    if (apart > best) {
      best = apart;
      best_rows = rows;
      best_columns = columns;
      dx = w;
      dy = h;
    }
  }
  Random random(seed);
  double const gap = std::max(best - diameter, 0.0);
  double const jitter = 0.3 * gap; // sqrt(2) of it, for both discs, is less than the gap
  double const right = box.width / 2 - model.radius, top = box.height / 2 - model.radius;
  std::vector<DiscState> discs;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t const row = k / best_columns, column = k % best_columns;
    double x = -width / 2 + dx * (static_cast<double>(column) + (row % 2 == 1 ? 0.5 : 0.0));
    double y = best_rows == 1 ? 0 : -height / 2 + dy * static_cast<double>(row);
    x += random.between(-jitter, jitter);
    y += random.between(-jitter, jitter);
    if (box.x == Boundary::walls)
      x = std::clamp(x, -right, right);
    if (box.y == Boundary::walls)
      y = std::clamp(y, -top, top);
    double const vx = random.between(-speed, speed), vy = random.between(-speed, speed);
    discs.push_back({x, y, vx, vy});
  }
  for (auto& disc : discs) { // back into a periodic box
    if (disc.x < -box.width / 2)
      disc.x += box.width;
    if (disc.y < -box.height / 2)
      disc.y += box.height;
  }
  return reordered(discs, random_order(count, seed + 1));
}

Scene thermal_gas(std::size_t count, double packing, double gravity, Contact const& contact,
                  Boundary x, Boundary y)
{
  double const height = height_for(count, packing, 1.0) / 2;
  Scene scene;
  scene.model = make_model(height, height, gravity, contact, x, y);
  scene.model.radius = 0.5;
  scene.discs = separate_discs(scene.model, count, 0, 21);
  Random random(22);
  auto const normal = [&] {
    double sum = -6;
    for (int k = 0; k < 12; ++k)
      sum += random.unit();
    return sum;
  };
  double px = 0, py = 0, square = 0;
  for (auto& disc : scene.discs) {
    disc.vx = normal();
    disc.vy = normal();
    px += disc.vx / static_cast<double>(count);
    py += disc.vy / static_cast<double>(count);
  }
  for (auto& disc : scene.discs) {
    disc.vx -= px;
    disc.vy -= py;
    square += (disc.vx * disc.vx + disc.vy * disc.vy) / static_cast<double>(2 * count);
  }
  for (auto& disc : scene.discs) {
    disc.vx /= std::sqrt(square);
    disc.vy /= std::sqrt(square);
  }
  return scene;
}

std::vector<DiscState> reordered(std::vector<DiscState> const& discs,
                                 std::vector<std::size_t> const& order)
{
  std::vector<DiscState> result;
  for (auto const k : order)
    result.push_back(discs[k]);
  return result;
}

std::vector<std::size_t> random_order(std::size_t count, std::uint64_t seed)
{
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  Random random(seed);
  for (std::size_t k = count; k > 1; --k)
    std::swap(order[k - 1], order[random.below(k)]);
  return order;
}

double height_for(std::size_t count, double packing, double aspect)
{
  double const area = static_cast<double>(count) * 3.14159265358979323846 / packing;
  double lo = 0, hi = area + 1;
  for (int k = 0; k < 100; ++k) {
    double const mid = (lo + hi) / 2;
    (mid * mid * aspect < area ? lo : hi) = mid;
  }
  return hi;
}

char const* name(Ids ids)
{
  return ids == Ids::shuffled ? "shuffled" : ids == Ids::row_major ? "row-major" : "reversed";
}

char const* name(Boundary boundary)
{
  return boundary == Boundary::walls ? "walls" : "periodic";
}

} // namespace ricochet::test
