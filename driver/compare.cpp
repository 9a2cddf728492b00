#include "compare.hpp"

#include "output_file.hpp"
#include "states_csv.hpp"
#include "text.hpp"
#include "trajectory_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

namespace ricochet::driver {

namespace {

constexpr std::int64_t slab = 65536; // discs that are in memory at a time

// One side of a comparison: a trajectory, or a list of states as a single frame.
class Side {
 public:
  explicit Side(std::string const& path) : path_(path)
  {
    if (is_hdf5(path)) {
      file_ = std::make_unique<TrajectoryReader>(path);
    } else {
      ProblemList problems;
      states_ = read_states(path, std::nullopt, problems);
      problems.throw_if_any();
    }
  }

  std::string const& path() const { return path_; }
  TrajectoryReader const* trajectory() const { return file_.get(); }
  std::int64_t discs() const
  {
    return file_ ? file_->discs() : static_cast<std::int64_t>(states_.size());
  }
  bool has(std::string const& field) const { return !file_ || file_->has(field); }

  void read(std::string const& field, int component, std::int64_t frame, std::int64_t first,
            std::int64_t count, double* values) const
  {
    if (file_)
      return file_->read(field, component, frame, first, count, values);
    for (std::int64_t i = first; i < first + count; ++i) {
      DiscState const& disc = states_[static_cast<std::size_t>(i)];
      bool const is_position = field == "position";
      double const vector[3] = {is_position ? disc.x : disc.vx, is_position ? disc.y : disc.vy, 0};
      *values++ = vector[component];
    }
  }

 private:
  std::string path_;
  std::unique_ptr<TrajectoryReader> file_;
  std::vector<DiscState> states_;
};

// Frames of both sides that belong together.
struct FramePair {
  std::int64_t step, a, b;
};

std::vector<FramePair> matching_frames(Side const& a, Side const& b, Comparison& result)
{
  auto const last = [](Side const& side) {
    return side.trajectory() ? side.trajectory()->frames() - 1 : 0;
  };
  if (last(a) < 0 || last(b) < 0) {
    result.mismatches.push_back(fmt::format("{} has no frames", last(a) < 0 ? a.path() : b.path()));
    return {};
  }
  if (!a.trajectory() || !b.trajectory()) {
    auto const* file = a.trajectory() ? a.trajectory() : b.trajectory();
    if (file)
      result.notes.push_back(fmt::format("compared with the last frame of {}, step {}",
                                         file->path(), file->steps().back()));
    return {{file ? file->steps().back() : 0, last(a), last(b)}};
  }

  std::vector<FramePair> pairs;
  auto const& steps_a = a.trajectory()->steps();
  auto const& steps_b = b.trajectory()->steps();
  std::size_t i = 0, j = 0;
  while (i < steps_a.size() && j < steps_b.size()) {
    if (steps_a[i] == steps_b[j])
      pairs.push_back({steps_a[i], static_cast<std::int64_t>(i), static_cast<std::int64_t>(j)});
    bool const next_a = steps_a[i] <= steps_b[j];
    bool const next_b = steps_b[j] <= steps_a[i];
    i += next_a;
    j += next_b;
  }
  if (pairs.size() != steps_a.size() || pairs.size() != steps_b.size())
    result.mismatches.push_back(fmt::format("{} frames and {} frames: {} have the same step",
                                            steps_a.size(), steps_b.size(), pairs.size()));
  return pairs;
}

// Compares one field in one pair of frames.
void compare_field(Side const& a, Side const& b, FramePair const& pair, std::string const& field,
                   Comparison::Deviation* const components, double& largest_of_frame)
{
  std::vector<double> va(slab), vb(slab);
  for (int k = 0; k < 3; ++k) {
    Comparison::Deviation& component = components[k];
    for (std::int64_t first = 0; first < a.discs(); first += slab) {
      std::int64_t const count = std::min(slab, a.discs() - first);
      a.read(field, k, pair.a, first, count, va.data());
      b.read(field, k, pair.b, first, count, vb.data());
      for (std::int64_t i = 0; i < count; ++i) {
        auto const at = static_cast<std::size_t>(i);
        double const apart = deviation(va[at], vb[at]);
        largest_of_frame = std::max(largest_of_frame, apart);
        if (apart > component.largest)
          component = {component.component, apart, pair.step, first + i, va[at], vb[at]};
      }
    }
  }
}

std::string in_words(Comparison const& result, double tolerance)
{
  std::string text;
  for (std::string const& note : result.notes)
    text += note + "\n";
  text += fmt::format("{} frame{} of {} discs compared\n", result.frames,
                      result.frames == 1 ? "" : "s", result.discs);
  if (result.frames > 0) {
    text += fmt::format("{:<6} {:>12}  {}\n", "field", "deviation", "largest at");
    for (auto const& d : result.deviations) {
      text += fmt::format("{:<6} {:>12.6g}", d.component, d.largest);
      if (d.largest > 0)
        text += fmt::format("  {}disc {}: {} and {}",
                            result.has_steps ? fmt::format("step {} ", d.step) : "", d.disc,
                            shortest(d.a), shortest(d.b));
      text += "\n";
    }
  }
  for (std::string const& mismatch : result.mismatches)
    text += "differ: " + mismatch + "\n";
  if (result.within(tolerance))
    return text +
           (tolerance > 0 ? fmt::format("equal within {}\n", shortest(tolerance)) : "equal\n");
  if (result.first_beyond >= 0)
    text +=
        fmt::format("differ: by more than {}{}\n", shortest(tolerance),
                    result.has_steps ? fmt::format(" from step {} on", result.first_beyond) : "");
  return text;
}

} // namespace

double deviation(double a, double b)
{
  if (a == b || (std::isnan(a) && std::isnan(b)))
    return 0;
  double const apart = std::abs(a - b);
  return std::isnan(apart) ? std::numeric_limits<double>::infinity() : apart;
}

bool Comparison::within(double tolerance) const
{
  return mismatches.empty() &&
         std::all_of(deviations.begin(), deviations.end(),
                     [&](Deviation const& d) { return d.largest <= tolerance; });
}

Comparison compare_files(std::string const& path_a, std::string const& path_b, double tolerance)
{
  Side const a(path_a), b(path_b);
  Comparison result;
  result.first_beyond = -1;
  result.discs = a.discs();
  if (a.discs() != b.discs()) {
    result.mismatches.push_back(fmt::format("{} discs and {} discs", a.discs(), b.discs()));
    return result;
  }

  std::vector<std::string> fields;
  for (std::string const field : {"position", "velocity"}) {
    if (a.has(field) && b.has(field))
      fields.push_back(field);
    else if (a.has(field) || b.has(field))
      result.notes.push_back(fmt::format("{} is only in {}", field, (a.has(field) ? a : b).path()));
    else
      result.notes.push_back(fmt::format("{} is in neither file", field));
  }
  for (std::string const& field : fields)
    for (char const* axis : {"x", "y", "z"})
      result.deviations.push_back({(field == "velocity" ? "v" : "") + std::string(axis)});

  std::vector<FramePair> const pairs = matching_frames(a, b, result);
  result.has_steps = a.trajectory() || b.trajectory();
  result.frames = static_cast<std::int64_t>(pairs.size());
  for (FramePair const& pair : pairs) {
    double largest = 0;
    for (std::size_t f = 0; f < fields.size(); ++f)
      compare_field(a, b, pair, fields[f], &result.deviations[3 * f], largest);
    if (largest > tolerance && result.first_beyond < 0)
      result.first_beyond = pair.step;
  }

  // Two-dimensional motion has z = 0; who stores something else there sees it.
  auto const is_flat = [](Comparison::Deviation const& d) {
    return d.component.back() == 'z' && d.largest == 0;
  };
  auto& all = result.deviations;
  all.erase(std::remove_if(all.begin(), all.end(), is_flat), all.end());
  return result;
}

Exit compare(CompareOptions const& options)
{
  Comparison const result = compare_files(options.a, options.b, options.tolerance);
  OutputFile out("-", false);
  out.write(in_words(result, options.tolerance));
  out.commit();
  return result.within(options.tolerance) ? Exit::done : Exit::differs;
}

} // namespace ricochet::driver
