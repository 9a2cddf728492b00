#include "generate.hpp"

#include "config.hpp"
#include "final_states.hpp"
#include "kokkos_startup.hpp"
#include "melt.hpp"
#include "output_file.hpp"
#include "overlaps.hpp"
#include "random.hpp"
#include "scene.hpp"
#include "text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <optional>

namespace ricochet::driver {

namespace {

constexpr double pi = 3.14159265358979323846;
constexpr double rounding = 1e-12; // of a diameter, by which discs of a lattice may be too near

// Streams of random numbers of a seed.
constexpr std::uint64_t of_positions = 0, of_order = std::uint64_t{1} << 32,
                        of_velocities = std::uint64_t{2} << 32;

/// Rows of discs at equal distances that fill a box; every other row may be shifted by half of the
/// distance between its discs.
struct Lattice {
  std::int64_t columns = 0, rows = 0;
  bool shifted = false;
  Vector start{0, 0}, spacing{0, 0};
  double nearest = 0; ///< least distance of two discs, or of one and its image

  Vector site(std::int64_t k) const
  {
    std::int64_t const row = k / columns, column = k % columns;
    double const shift = shifted && row % 2 == 1 ? 0.5 : 0;
    return {start.x + (static_cast<double>(column) + shift) * spacing.x,
            start.y + static_cast<double>(row) * spacing.y};
  }
};

// The lattice of `columns` columns with room for `count` discs.
Lattice lattice(Model const& model, std::int64_t count, std::int64_t columns, bool shifted)
{
  Box const& box = model.box;
  Lattice l;
  l.columns = columns;
  l.rows = (count + columns - 1) / columns;
  l.shifted = shifted && l.rows > 1;
  bool const periodic_x = box.x == Boundary::periodic, periodic_y = box.y == Boundary::periodic;
  if (l.shifted && periodic_y)
    l.rows += l.rows % 2; // or two rows of the same kind would meet
  // At walls a row stays half of the spacing away, like from the next disc, or a radius if there is
  // less room.
  auto const spread = [&](double length, double discs, bool periodic) {
    double const even = length / discs;
    if (periodic || even >= 2 * model.radius || discs <= 1)
      return even;
    return (length - 2 * model.radius) / (discs - 1);
  };
  double const wide = static_cast<double>(columns) + (l.shifted && !periodic_x ? 0.5 : 0);
  l.spacing = {spread(box.width, wide, periodic_x),
               spread(box.height, static_cast<double>(l.rows), periodic_y)};
  l.start = {-0.5 * (wide - 1) * l.spacing.x,
             -0.5 * (static_cast<double>(l.rows) - 1) * l.spacing.y};
  if (l.shifted && periodic_x)
    l.start.x -= 0.25 * l.spacing.x;

  double const a = l.spacing.x, b = l.spacing.y, half = 0.5 * a;
  bool const alone = columns == 1 && !periodic_x;
  l.nearest = alone ? HUGE_VAL : a;
  if (l.rows > 1)
    l.nearest = std::min(l.nearest, l.shifted ? std::sqrt(half * half + b * b) : b);
  if (l.rows > 2)
    l.nearest = std::min(l.nearest, 2 * b);
  return l;
}

// The lattice whose discs keep the greatest distance.
Lattice widest_lattice(Model const& model, std::int64_t count, bool shifted)
{
  Lattice best;
  double const most = std::min(std::floor(model.box.width / (2 * model.radius) * (1 + rounding)),
                               static_cast<double>(count));
  for (std::int64_t columns = 1; columns <= static_cast<std::int64_t>(most); ++columns) {
    Lattice const l = lattice(model, count, columns, shifted);
    if (l.nearest > best.nearest)
      best = l;
  }
  return best;
}

// Places discs one after the other where there is room; nothing if there is none left.
std::optional<std::vector<Vector>> place_at_random(Model const& model, std::size_t count,
                                                   Random& random)
{
  // Near the end of the room, discs that still find a place need some hundred attempts at packing
  // 0.5, and ever more beyond.
  constexpr int most_attempts = 100000;
  Box const& box = model.box;
  double const inset_x = box.x == Boundary::walls ? model.radius : 0;
  double const inset_y = box.y == Boundary::walls ? model.radius : 0;
  DiscFinder finder(model, count);
  std::vector<Vector> places;
  std::vector<std::size_t> near;
  while (places.size() < count) {
    int attempts = 0;
    Vector p{0, 0};
    do {
      if (++attempts > most_attempts)
        return std::nullopt;
      p.x = (random.unit() - 0.5) * (box.width - 2 * inset_x);
      p.y = (random.unit() - 0.5) * (box.height - 2 * inset_y);
      finder.find_near(p, near);
    } while (!near.empty());
    finder.add(p);
    places.push_back(p);
  }
  return places;
}

// A random order of 0...count-1.
std::vector<std::size_t> shuffled(std::size_t count, Random random)
{
  std::vector<std::size_t> order(count);
  for (std::size_t i = 0; i < count; ++i)
    order[i] = i;
  for (std::size_t i = count; i > 1; --i)
    std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

class Generator {
 public:
  Generator(Settings const& settings, Model const& model, ProblemList& problems)
    : settings_(settings),
      model_(model),
      problems_(problems),
      seed_(static_cast<std::uint64_t>(*settings.seed))
  {
  }

  std::vector<DiscState> discs()
  {
    if (!choose_count())
      return {};
    place();
    if (!discs_.empty())
      set_velocities();
    return std::move(discs_);
  }

 private:
  Origin amount() const
  {
    return blame(settings_,
                 settings_.count ? "discs.generate.count" : "discs.generate.packing_fraction");
  }

  bool choose_count()
  {
    if (settings_.count) {
      count_ = *settings_.count;
    } else {
      double const discs = *settings_.packing * model_.box.width * model_.box.height /
                           (pi * model_.radius * model_.radius);
      if (!(discs < 1 << 30)) {
        problems_.add(amount(),
                      fmt::format("this makes {:.3g} discs (allowed: fewer than 2^30)", discs));
        return false;
      }
      count_ = static_cast<std::int64_t>(std::floor(discs + 0.5));
    }
    double const packing =
        settings_.packing.value_or(packing_fraction(model_, static_cast<std::size_t>(count_)));
    bool const is_random = *settings_.arrangement == Arrangement::random;
    double const most = is_random ? densest_random : densest_packing;
    if (packing <= most)
      return true;
    problems_.add(amount(),
                  fmt::format("{} discs would cover {:.4g} of the box (allowed: up to {}{})",
                              count_, packing, most,
                              is_random ? " at random places, beyond which discs freeze" : ""),
                  is_random && packing <= densest_packing ? "choose arrangement = \"triangular\""
                                                          : "make the box larger");
    return false;
  }

  void place()
  {
    auto const count = static_cast<std::size_t>(count_);
    bool const is_random = *settings_.arrangement == Arrangement::random;
    if (is_random && !is_to_be_melted(settings_, model_)) {
      // In a small box it is a matter of luck where the first discs leave room for the last.
      constexpr int most_trials = 20;
      Random random(seed_, of_positions);
      for (int trial = 0; trial < most_trials; ++trial)
        if (auto const places = place_at_random(model_, count, random)) {
          for (Vector const& p : *places)
            discs_.push_back({p.x, p.y, 0, 0});
          return;
        }
      problems_.add(amount(),
                    fmt::format("found no room for all of {} discs at random places (in {} trials)",
                                count_, most_trials),
                    "choose arrangement = \"triangular\"");
      return;
    }
    // The square lattice melts faster, but in a small box it may lack the room.
    bool const is_triangular = *settings_.arrangement == Arrangement::triangular;
    Lattice best = widest_lattice(model_, count_, is_triangular);
    if (is_random && best.nearest < 2 * model_.radius)
      best = widest_lattice(model_, count_, true);
    if (count_ > 0 && best.nearest < 2 * model_.radius * (1 - rounding)) {
      problems_.add(amount(),
                    fmt::format("{} discs do not fit on a lattice that fills the box (the best has "
                                "a spacing of {:.4g}, less than the diameter {})",
                                count_, best.nearest, shortest(2 * model_.radius)),
                    *settings_.arrangement == Arrangement::square
                        ? "choose arrangement = \"triangular\""
                        : "make the box larger");
      return;
    }
    // Ids in random order: what depends on them should not depend on the place too.
    for (std::size_t const site : shuffled(count, Random(seed_, of_order))) {
      Vector const p = best.site(static_cast<std::int64_t>(site));
      discs_.push_back({p.x, p.y, 0, 0});
    }
  }

  // Normally distributed velocities, scaled to the temperature.
  void set_velocities()
  {
    double const temperature = *settings_.temperature;
    if (temperature == 0)
      return;
    auto const n = static_cast<double>(discs_.size());
    double mean_x = 0, mean_y = 0;
    for (std::size_t i = 0; i < discs_.size(); ++i) {
      Random random(seed_, of_velocities + i);
      mean_x += discs_[i].vx = random.normal();
      mean_y += discs_[i].vy = random.normal();
    }
    mean_x /= n;
    mean_y /= n;
    double sum = 0;
    for (DiscState& disc : discs_) {
      if (*settings_.zero_momentum) {
        disc.vx -= mean_x;
        disc.vy -= mean_y;
      }
      sum += disc.vx * disc.vx + disc.vy * disc.vy;
    }
    if (!(sum > 0)) {
      problems_.add(blame(settings_, "discs.generate.zero_momentum"),
                    "one disc without momentum has no temperature (but one above 0 is asked for)",
                    "set the temperature to 0");
      return;
    }
    double const scale = std::sqrt(temperature / (sum / (2 * n)));
    for (DiscState& disc : discs_) {
      disc.vx *= scale;
      disc.vy *= scale;
    }
  }

  Settings const& settings_;
  Model const& model_;
  ProblemList& problems_;
  std::uint64_t seed_;
  std::int64_t count_ = 0;
  std::vector<DiscState> discs_;
};

} // namespace

std::vector<DiscState> generate_discs(Settings const& settings, Model const& model,
                                      ProblemList& problems)
{
  return Generator(settings, model, problems).discs();
}

Exit generate(GenerateOptions const& options)
{
  check_outputs({options.output, options.config}, {options.scene.file, options.scene.config},
                options.force);
  Scene scene = read_scene(options.scene, Purpose::states);
  if (is_to_be_melted(scene.settings, scene.model)) {
    KokkosSession const kokkos({{}, {}, true});
    melt(scene);
  }
  ProblemList problems;
  Overlaps const overlaps = find_overlaps(scene.model, scene.discs);
  if (overlaps.pairs > 0)
    problems.add(blame(scene.settings, "discs.states"),
                 fmt::format("{} pairs of discs overlap, discs {} and {} by {:.3g} (the deepest)",
                             overlaps.pairs, overlaps.first, overlaps.second, overlaps.deepest),
                 "--relax separates them");
  if (overlaps.outside > 0)
    problems.add(blame(scene.settings, "discs.states"),
                 fmt::format("{} discs poke through a wall", overlaps.outside),
                 "--relax moves them inside");
  std::string config;
  if (!options.config.empty())
    config = as_config(scene.settings, problems);
  problems.throw_if_any();

  OutputFile states(options.output, options.force);
  write_states(states, scene.discs);
  states.commit();
  if (!options.config.empty()) {
    OutputFile file(options.config, options.force);
    file.write(config);
    file.commit();
  }
  for (std::string const& note : scene.notes)
    std::fprintf(stderr, "%s\n", note.c_str());
  return Exit::done;
}

} // namespace ricochet::driver
