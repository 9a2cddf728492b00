#include "overlaps.hpp"

#include "random.hpp"

#include <algorithm>
#include <cmath>

namespace ricochet::driver {

namespace {

constexpr double rounding = 1e-12; // of a diameter, which touching discs may overlap by
constexpr double clearance = 1e-6; // of a diameter, that separated discs are apart
constexpr std::int64_t most_passes = 20000;

double nearest(double d, double length)
{
  return d > length / 2 ? d - length : d < -length / 2 ? d + length : d;
}

double wrapped(double x, double length)
{
  return x >= length / 2 ? x - length : x < -length / 2 ? x + length : x;
}

// The place in the box, clear of walls, next to `p`.
Vector confined(Model const& model, Vector p)
{
  auto const along = [&](double x, double length, Boundary boundary) {
    double const reach = std::max(0.0, length / 2 - model.radius);
    return boundary == Boundary::periodic ? wrapped(x, length) : std::clamp(x, -reach, reach);
  };
  return {along(p.x, model.box.width, model.box.x), along(p.y, model.box.height, model.box.y)};
}

// A direction for two discs whose centres are the same, by their numbers.
Vector direction(std::size_t i, std::size_t j)
{
  double const t = 2 * Random(i, j).unit() - 1; // tan of half the angle
  return {(1 - t * t) / (1 + t * t), 2 * t / (1 + t * t)};
}

} // namespace

std::int64_t DiscFinder::Axis::at(double x) const
{
  double const u = std::floor((x / length + 0.5) * static_cast<double>(cells));
  return static_cast<std::int64_t>(std::clamp(u, 0.0, static_cast<double>(cells - 1)));
}

DiscFinder::DiscFinder(Model const& model, std::size_t count) : diameter_(2 * model.radius)
{
  // Cells of at least a diameter, and not many more of them than discs.
  double const area = model.box.width * model.box.height / static_cast<double>(count + 1);
  double const side = std::max(diameter_ * (1 + 1e-9), std::sqrt(area / 2));
  auto const axis = [&](double length, Boundary boundary) {
    double const cells =
        std::clamp(std::floor(length / side), 1.0, 1.0 + 2.0 * static_cast<double>(count));
    return Axis{length, static_cast<std::int64_t>(cells), boundary == Boundary::periodic};
  };
  x_ = axis(model.box.width, model.box.x);
  y_ = axis(model.box.height, model.box.y);
  first_.assign(static_cast<std::size_t>(x_.cells * y_.cells), -1);
  positions_.reserve(count);
  next_.reserve(count);
  previous_.reserve(count);
  cell_.reserve(count);
}

std::size_t DiscFinder::cell(Vector p) const
{
  return static_cast<std::size_t>(y_.at(p.y) * x_.cells + x_.at(p.x));
}

void DiscFinder::link(std::size_t disc, std::size_t cell)
{
  std::int32_t const head = first_[cell];
  next_[disc] = head;
  previous_[disc] = -1;
  if (head >= 0)
    previous_[static_cast<std::size_t>(head)] = static_cast<std::int32_t>(disc);
  first_[cell] = static_cast<std::int32_t>(disc);
  cell_[disc] = cell;
}

void DiscFinder::unlink(std::size_t disc)
{
  std::int32_t const before = previous_[disc], after = next_[disc];
  if (before >= 0)
    next_[static_cast<std::size_t>(before)] = after;
  else
    first_[cell_[disc]] = after;
  if (after >= 0)
    previous_[static_cast<std::size_t>(after)] = before;
}

void DiscFinder::add(Vector position)
{
  std::size_t const disc = positions_.size();
  positions_.push_back(position);
  next_.push_back(-1);
  previous_.push_back(-1);
  cell_.push_back(0);
  link(disc, cell(position));
}

void DiscFinder::move(std::size_t disc, Vector position)
{
  positions_[disc] = position;
  std::size_t const to = cell(position);
  if (to == cell_[disc])
    return;
  unlink(disc);
  link(disc, to);
}

Vector DiscFinder::separation(Vector a, Vector b) const
{
  Vector const d{b.x - a.x, b.y - a.y};
  return {x_.periodic ? nearest(d.x, x_.length) : d.x, y_.periodic ? nearest(d.y, y_.length) : d.y};
}

void DiscFinder::find_near(Vector p, std::vector<std::size_t>& found) const
{
  // The cell of `p` and those beside it, each once also where an axis has one or two.
  struct Line {
    std::int64_t cells[3];
    int count = 0;
  };
  auto const around = [](Axis const& axis, double x) {
    Line line;
    std::int64_t const middle = axis.at(x);
    for (std::int64_t c = middle - 1; c <= middle + 1; ++c) {
      if (!axis.periodic && (c < 0 || c >= axis.cells))
        continue;
      std::int64_t const cell = (c + axis.cells) % axis.cells;
      if (std::find(line.cells, line.cells + line.count, cell) == line.cells + line.count)
        line.cells[line.count++] = cell;
    }
    return line;
  };
  Line const columns = around(x_, p.x), rows = around(y_, p.y);
  found.clear();
  for (int r = 0; r < rows.count; ++r)
    for (int c = 0; c < columns.count; ++c) {
      auto const cell = static_cast<std::size_t>(rows.cells[r] * x_.cells + columns.cells[c]);
      for (std::int32_t k = first_[cell]; k >= 0; k = next_[static_cast<std::size_t>(k)]) {
        Vector const d = separation(p, positions_[static_cast<std::size_t>(k)]);
        if (d.x * d.x + d.y * d.y < diameter_ * diameter_)
          found.push_back(static_cast<std::size_t>(k));
      }
    }
}

Overlaps find_overlaps(Model const& model, std::vector<DiscState> const& discs)
{
  double const diameter = 2 * model.radius;
  Overlaps overlaps;
  DiscFinder finder(model, discs.size());
  std::vector<std::size_t> near;
  for (std::size_t i = 0; i < discs.size(); ++i) {
    Vector const p{discs[i].x, discs[i].y};
    finder.find_near(p, near);
    for (std::size_t const j : near) {
      Vector const d = finder.separation(p, finder.position(j));
      double const depth = diameter - std::sqrt(d.x * d.x + d.y * d.y);
      if (depth <= rounding * diameter)
        continue;
      ++overlaps.pairs;
      if (depth > overlaps.deepest) {
        overlaps.deepest = depth;
        overlaps.first = j;
        overlaps.second = i;
      }
    }
    finder.add(p);
    Vector const clear = confined(model, p);
    if (std::fabs(p.x - clear.x) + std::fabs(p.y - clear.y) > rounding * diameter)
      ++overlaps.outside;
  }
  return overlaps;
}

Relaxation relax(Model const& model, std::vector<DiscState>& discs)
{
  double const diameter = 2 * model.radius;
  DiscFinder finder(model, discs.size());
  for (DiscState const& disc : discs)
    finder.add(confined(model, {disc.x, disc.y}));

  Relaxation result;
  std::vector<std::size_t> near;
  for (bool pushed = true; pushed && result.passes < most_passes; ++result.passes) {
    pushed = false;
    for (std::size_t i = 0; i < discs.size(); ++i) {
      finder.find_near(finder.position(i), near);
      for (std::size_t const j : near) {
        Vector const d = finder.separation(finder.position(i), finder.position(j));
        double const distance = std::sqrt(d.x * d.x + d.y * d.y);
        if (j == i || distance >= diameter) // the latter after a push of another pair
          continue;
        Vector const n = distance > 0 ? Vector{d.x / distance, d.y / distance} : direction(i, j);
        double const way = 0.5 * (diameter * (1 + clearance) - distance);
        Vector const a = finder.position(i), b = finder.position(j);
        finder.move(i, confined(model, {a.x - way * n.x, a.y - way * n.y}));
        finder.move(j, confined(model, {b.x + way * n.x, b.y + way * n.y}));
        pushed = true;
      }
    }
  }

  for (std::size_t i = 0; i < discs.size(); ++i) {
    Vector const to = finder.position(i);
    Vector const d = finder.separation({discs[i].x, discs[i].y}, to);
    double const way = std::sqrt(d.x * d.x + d.y * d.y);
    if (way == 0)
      continue;
    ++result.moved;
    if (way > result.farthest) {
      result.farthest = way;
      result.disc = i;
    }
    discs[i].x = to.x;
    discs[i].y = to.y;
  }
  result.left = find_overlaps(model, discs);
  return result;
}

} // namespace ricochet::driver
