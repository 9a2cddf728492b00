#include "pictures/statistics.hpp"

#include "text.hpp"
#include "trajectory_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ricochet::driver {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

void count(std::vector<double>& bins, double share)
{
  if (share >= 0 && share < 1)
    ++bins[static_cast<std::size_t>(share * static_cast<double>(bins.size()))];
}

// Length from `a` to `b`, on a periodic axis the shortest.
double apart(double a, double b, double length, Boundary boundary)
{
  double const way = b - a;
  return boundary == Boundary::periodic ? way - length * std::round(way / length) : way;
}

// Discs by square cells of at least a given size.
class Cells {
 public:
  Cells(Box const& box, double size, std::vector<DiscState> const& discs)
    : box_(box),
      columns_(std::max(1, static_cast<int>(std::min(box.width / size, 4096.0)))),
      rows_(std::max(1, static_cast<int>(std::min(box.height / size, 4096.0)))),
      members_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_))
  {
    for (std::size_t i = 0; i < discs.size(); ++i)
      members_[index(column(discs[i]), row(discs[i]))].push_back(i);
  }

  /// Calls use(other) for all discs in the cell of `disc` and those around, each once.
  template <class Use>
  void around(DiscState const& disc, Use const& use) const
  {
    for (int const r : neighbours(row(disc), rows_, box_.y))
      for (int const c : neighbours(column(disc), columns_, box_.x))
        for (std::size_t const other : members_[index(c, r)])
          use(other);
  }

 private:
  static int cell(double place, double length, int cells)
  {
    double const share = (place / length + 0.5) * cells;
    return share > 0 ? static_cast<int>(std::min(share, cells - 1.0)) : 0;
  }
  int column(DiscState const& d) const { return cell(d.x, box_.width, columns_); }
  int row(DiscState const& d) const { return cell(d.y, box_.height, rows_); }
  std::size_t index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
           static_cast<std::size_t>(column);
  }
  static std::vector<int> neighbours(int cell, int cells, Boundary boundary)
  {
    std::vector<int> found;
    for (int c = cell - 1; c <= cell + 1; ++c) {
      int const here = boundary == Boundary::periodic ? (c + cells) % cells : c;
      if (here >= 0 && here < cells && std::count(found.begin(), found.end(), here) == 0)
        found.push_back(here);
    }
    return found;
  }

  Box box_;
  int columns_, rows_;
  std::vector<std::vector<std::size_t>> members_;
};

} // namespace

std::string as_csv(Table const& table)
{
  std::string text;
  for (std::string const& column : table.columns)
    text += (text.empty() ? "" : ",") + column;
  for (auto const& row : table.rows) {
    char separator = '\n';
    for (double const value : row) {
      text += separator;
      if (std::isfinite(value))
        append_shortest(text, value);
      separator = ',';
    }
  }
  return text + "\n";
}

Table observables_table(TrajectoryReader const& file)
{
  Table table{"time", {"time"}, {}};
  auto const frames = file.steps().size();
  auto times = file.times();
  times.resize(frames, unknown);
  std::vector<std::vector<double>> columns{times};
  for (char const* const name :
       {"kinetic", "potential", "lost_pairs", "lost_walls", "numerical", "temperature",
        "pressure_z", "collisions", "wall_hits", "max_overlap"}) {
    table.columns.emplace_back(name);
    columns.push_back(file.observable(name));
    columns.back().resize(frames, unknown);
  }
  for (std::size_t frame = 0; frame < frames; ++frame) {
    table.rows.emplace_back();
    for (auto const& column : columns)
      table.rows.back().push_back(column[frame]);
  }
  return table;
}

Statistics::Statistics(Stage const& stage) : stage_(stage), speeds_(60), heights_(50), pairs_(100)
{
  Box const& box = stage.box;
  double const share_x = box.width / (box.x == Boundary::periodic ? 2 : 4);
  double const share_y = box.height / (box.y == Boundary::periodic ? 2 : 4);
  farthest_ = std::min({10 * stage.radius, share_x, share_y});
}

void Statistics::add(std::vector<DiscState> const& discs)
{
  ++frames_;
  discs_ += static_cast<double>(discs.size());
  for (DiscState const& d : discs) {
    double const square = d.vx * d.vx + d.vy * d.vy;
    squares_ += square;
    count(speeds_, std::sqrt(square) / (2 * stage_.fast));
    count(heights_, d.y / stage_.box.height + 0.5);
  }
  add_pairs(discs);
}

bool Statistics::is_far_from_walls(DiscState const& disc) const
{
  Box const& box = stage_.box;
  return (box.x == Boundary::periodic || box.width / 2 - std::abs(disc.x) >= farthest_) &&
         (box.y == Boundary::periodic || box.height / 2 - std::abs(disc.y) >= farthest_);
}

void Statistics::add_pairs(std::vector<DiscState> const& discs)
{
  Box const& box = stage_.box;
  Cells const cells(box, farthest_, discs);
  constexpr std::size_t enough = 20000; // centres, for a smooth curve
  std::size_t const every = discs.size() / enough + 1;
  for (std::size_t i = 0; i < discs.size(); i += every) {
    if (!is_far_from_walls(discs[i]))
      continue;
    ++centres_;
    cells.around(discs[i], [&](std::size_t j) {
      if (j != i)
        count(pairs_, std::hypot(apart(discs[i].x, discs[j].x, box.width, box.x),
                                 apart(discs[i].y, discs[j].y, box.height, box.y)) /
                          farthest_);
    });
  }
}

Table Statistics::speeds() const
{
  Table table{"speeds", {"speed", "density", "maxwell"}, {}};
  double const width = 2 * stage_.fast / static_cast<double>(speeds_.size());
  double const temperature = squares_ / (2 * discs_);
  for (std::size_t i = 0; i < speeds_.size(); ++i) {
    double const v = (static_cast<double>(i) + 0.5) * width;
    table.rows.push_back(
        {v, speeds_[i] / (discs_ * width), v / temperature * std::exp(-v * v / (2 * temperature))});
  }
  return table;
}

Table Statistics::heights() const
{
  Table table{"heights", {"y", "packing"}, {}};
  double const height = stage_.box.height / static_cast<double>(heights_.size());
  double const share = pi * stage_.radius * stage_.radius / (frames_ * stage_.box.width * height);
  for (std::size_t i = 0; i < heights_.size(); ++i)
    table.rows.push_back(
        {(static_cast<double>(i) + 0.5) * height - stage_.box.height / 2, heights_[i] * share});
  return table;
}

Table Statistics::pairs() const
{
  Table table{"pairs", {"distance", "g"}, {}};
  double const density = discs_ / (frames_ * stage_.box.width * stage_.box.height);
  double const width = farthest_ / static_cast<double>(pairs_.size());
  for (std::size_t i = 0; i < pairs_.size(); ++i) {
    double const r = (static_cast<double>(i) + 0.5) * width;
    double const expected = centres_ * density * 2 * pi * r * width;
    table.rows.push_back({r / (2 * stage_.radius), pairs_[i] / expected});
  }
  return table;
}

} // namespace ricochet::driver
