// Plans the search for discs that meet: when they are sorted, and for how long candidates are
// listed.
#pragma once

#include "ricochet/inspection.hpp"
#include "ricochet/lines.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

namespace ricochet {

/// Who is a candidate in the stretches of time that follow a sort. When discs are sorted, and how
/// far is searched, changes the cost and not a bit of what happens.
template <class Space, class Real>
class LineSearch {
 public:
  using Counts = typename LineMemory<Space>::Counts;

  /// For `discs` discs of `model`; `listed` of those called up are kept at a time.
  LineSearch(Model const& model, int discs, int listed)
    : model_(model),
      grid_(model, discs, cell_side(model, discs)),
      memory_(discs, listed),
      happened_("ricochet::happened")
  {
  }

  LineMemory<Space> const& memory() const { return memory_; }
  Kokkos::View<Happened, Space> const& happened() const { return happened_; }
  CellGrid<Space, Real>& grid() { return grid_; }

  /// Makes room for as many in the list of those called up.
  void keep_listed(int listed) { memory_.keep_listed(listed); }

  /// Makes the next stretch begin with a sort.
  void forget() { is_sorted_ = false; }

  /// Prepares a stretch of time: sorts the discs if they have to be.
  template <bool periodic>
  void prepare(Space const& space, Discs<Space, Real>& discs,
               Inspection<Space, Real> const& inspection, double length)
  {
    if (must_sort(length))
      sort<periodic>(space, discs, inspection, length);
  }

  /// Finds who meets in a stretch: see FindAmongCandidates for `meetings`, of which
  /// meetings_in(lines) makes one.
  template <bool periodic, class MeetingsIn>
  void find(Space const& space, Discs<Space, Real> const& discs, BooksView<Space> const& books,
            double length, MeetingsIn const& meetings_in);

  /// Upper bounds of the speeds until the next sort, and of paths in the lab.
  void note_speed(double speed) { speed_ = std::max(speed_, speed); }
  double speed() const { return speed_; }

  /// Reads what the kernels so far have counted, and notes the speeds.
  Counts const& read_counts(Space const& space)
  {
    counts_ = value_after(space, memory_.counts);
    note_speed(std::sqrt(counts_.speed2));
    return counts_;
  }

  /// Lists the discs that are called up for a round, from `place` on. Returns how many they are,
  /// also if there was no room for all.
  int list_called(Space const& space, int round, int place)
  {
    ricochet::list_called(space, memory_, round, place, WriteTo{&memory_.counts.data()->called});
    return read_counts(space).called;
  }

  /// Notes that all discs have come to the end of the stretch. `has_left_lines`: whether some may
  /// be elsewhere than on the lines that the candidates were listed for.
  void end(double length, bool has_left_lines)
  {
    travel_ += longest_path(length);
    speed_ += std::fabs(model_.gravity) * length;
    since_sort_ += length;
    ++stretches_;
    has_listed_ = has_listed_ && !has_left_lines;
  }

  /// Enters the state in an inspection.
  void inspect(Space const& space, Discs<Space, Real>& discs, Inspection<Space, Real>& inspection)
  {
    if (has_all_that_meet()) {
      inspection.note(inspection.extremes(space, discs),
                      is_periodic(model_.box) ? closest_candidates<true>(space, discs)
                                              : closest_candidates<false>(space, discs));
    } else {
      inspection.look(space, grid_, discs);
      forget(); // it has sorted them
    }
  }

 public: // nvcc takes device lambdas and launches only from public functions
  /// Enters what one kernel reported in the books of the run.
  void enter_happened(Space const& space, BooksView<Space> const& books) const;
  template <bool periodic>
  void sort(Space const& space, Discs<Space, Real>& discs,
            Inspection<Space, Real> const& inspection, double length);
  template <bool periodic>
  Lines<Space, Real, periodic> lines(Discs<Space, Real> const& discs, double length,
                                     double growth) const;
  template <bool periodic>
  Real closest_candidates(Space const& space, Discs<Space, Real> const& discs) const;

 private:
  /// Most stretches from one sort to the next.
  static constexpr int longest_ahead = 32;
  /// On a periodic axis, images of a disc on either side that others are compared with.
  static constexpr int most_images = 8;

  /// Whether all discs that may have come together since they were sorted are candidates. Once the
  /// list is used up, at the horizon, it still tells.
  bool has_all_that_meet() const
  {
    return is_sorted_ && has_listed_ && is_near(travel_) && memory_.has_room(counts_.candidates);
  }

  double longest_path(double length) const
  {
    return (speed_ + std::fabs(model_.gravity) * length / 2) * length * (1 + 1e-6);
  }

  bool must_sort(double length) const
  {
    return !is_sorted_ || stretches_ == longest_ahead ||
           since_sort_ + length > horizon_ * (1 + 1e-13) ||
           !is_near(travel_ + longest_path(length));
  }

  /// Whether discs that meet are in neighbouring cells, if none is farther than `travel` from where
  /// it was sorted.
  bool is_near(double travel) const { return travel < nearness(); }
  double nearness() const
  {
    return (grid_.cells().side() * (1 - 1e-6) - rounding(0) - 2 * model_.radius) / 2;
  }

  /// Whether discs sorted into neighbouring cells meet through one end of a periodic box at most.
  bool has_one_image() const
  {
    auto const is_wide = [&](Boundary boundary, double length) {
      return boundary == Boundary::walls || length > 4 * grid_.cells().side();
    };
    return is_wide(model_.box.x, model_.box.width) && is_wide(model_.box.y, model_.box.height);
  }

  /// For how many stretches those that meet will be there, if no contact makes a disc faster.
  int stretches_near(double length) const
  {
    double const gain = std::fabs(model_.gravity) * length;
    double travel = 0;
    for (int stretches = 0; stretches < longest_ahead; ++stretches) {
      travel += longest_path(length) + stretches * gain * length * (1 + 1e-6);
      if (!is_near(travel))
        return stretches;
    }
    return longest_ahead;
  }

  /// More than rounding can add to a distance from one sort to the next. In the stretches that
  /// candidates are listed for, no path is longer than the side of a cell.
  double rounding(double length) const
  {
    double const farthest =
        std::max(model_.box.width, model_.box.height) + grid_.cells().side() + longest_path(length);
    return 8 * (2 + longest_ahead) * static_cast<double>(std::numeric_limits<Real>::epsilon()) *
           farthest;
  }

  /// Side of cells [diameters]: the wider they are the longer discs stay near where they were
  /// sorted; but three in a row should hold no more than a search reads at once.
  static double cell_side(Model const& model, int discs)
  {
    constexpr double in_a_cell = 1.9, least = 1.5, most = 8;
    double const area = model.box.width * model.box.height / std::max(discs, 1);
    double const side = std::sqrt(in_a_cell * area) / (2 * model.radius);
    return std::min(std::max(side, least), most);
  }

  Model model_;
  CellGrid<Space, Real> grid_;
  LineMemory<Space> memory_;
  Kokkos::View<Happened, Space> happened_; ///< in one kernel
  Counts counts_;                          ///< as the host last saw them
  bool is_sorted_ = false;
  bool has_listed_ = false; ///< candidates
  int stretches_ = 0;       ///< since discs were sorted
  double since_sort_ = 0;   ///< time
  double horizon_ = 0;      ///< when discs are sorted again, at the latest
  double travel_ = 0;       ///< how far a disc can be from where it was sorted
  double speed_ = 0;        ///< of the fastest disc; no less than that
};

/// Stores the discs by cell, finds the fastest, and lists the candidates of the stretches ahead, if
/// they are as long as this one.
template <class Space, class Real>
template <bool periodic>
void LineSearch<Space, Real>::sort(Space const& space, Discs<Space, Real>& discs,
                                   Inspection<Space, Real> const& inspection, double length)
{
  grid_.sort(space, discs);
  is_sorted_ = true;
  speed_ = std::sqrt(inspection.extremes(space, discs).speed2) * (1 + 1e-6);
  travel_ = since_sort_ = 0;
  stretches_ = 0;
  int const near = stretches_near(length);
  horizon_ = std::max(near, 1) * length;
  counts_ = {};
  double const latest_due = static_cast<double>(std::numeric_limits<float>::max());
  has_listed_ = near > 1 && has_one_image() && horizon_ < latest_due;
  if (!has_listed_)
    return;
  Kokkos::deep_copy(space, memory_.counts, counts_);
  using List = ListCandidates<Space, Real, periodic>;
  Kokkos::parallel_for("ricochet::list_candidates",
                       uneven(space, 0, blocks_of(List::block, discs.count())),
                       List{lines<periodic>(discs, length, 1.5)});
  counts_ = value_after(space, memory_.counts);
}

/// The discs in a stretch in which contacts make no disc faster than `growth` times the fastest
/// now.
template <class Space, class Real>
template <bool periodic>
Lines<Space, Real, periodic> LineSearch<Space, Real>::lines(Discs<Space, Real> const& discs,
                                                            double length, double growth) const
{
  auto const& box = model_.box;
  double const diameter = 2 * model_.radius;
  double const speed = growth * speed_ + std::fabs(model_.gravity) * length;
  double const apart =
      2 * (speed * length + std::fabs(model_.gravity) * length * length) + diameter;
  double const error = rounding(length);
  auto const limits = centre_limits<Real>(model_);
  // The image of the other disc that is nearest at some time may be met at another only if the two
  // come that far.
  auto const images = [&](Boundary boundary, double side) {
    if (boundary == Boundary::walls)
      return 0;
    double const far = apart + std::max(side / 2, apart) + error;
    return static_cast<int>(std::min(std::floor(far / side), double{most_images}));
  };
  // Whoever is farther than that from the ends of the box has no neighbours across them.
  double const widest = 1 / std::min(grid_.cells().x.per_length, grid_.cells().y.per_length);
  auto const inner = [&](Boundary boundary, double side) {
    double const far = std::max(2 * widest, apart + travel_ + speed * length) + error;
    return boundary == Boundary::walls ? std::numeric_limits<Real>::infinity()
                                       : static_cast<Real>(side / 2 - far);
  };
  auto const size = static_cast<Real>(diameter);
  auto const safe = static_cast<Real>(diameter + error);
  // Where cells are much wider than discs, the discriminant of discs far from each other is less
  // certain than their places.
  auto const uncertainty2 = static_cast<Real>(
      64 * static_cast<double>(std::numeric_limits<Real>::epsilon()) * widest * widest);
  int const images_x = images(box.x, box.width), images_y = images(box.y, box.height);
  bool const any_image = images_x + images_y > 0;
  double const travel = travel_ + speed * length;
  return {memory_,
          discs,
          Neighbours<Space, Real, periodic>(discs, grid_.cells(), box),
          grid_.cell(),
          {Domain<Real, periodic>(box), size * size, static_cast<Real>(model_.gravity), limits.x,
           limits.y, static_cast<Real>(box.width), static_cast<Real>(box.height), images_x,
           images_y, inner(box.x, box.width), inner(box.y, box.height), static_cast<Real>(length)},
          size,
          safe * safe + uncertainty2,
          static_cast<Real>(error),
          static_cast<Real>((apart + error) * (apart + error)),
          any_image,
          is_near(travel) && !any_image,
          static_cast<Real>(has_listed_ ? std::max(horizon_ - since_sort_, length) : length),
          static_cast<Real>(since_sort_),
          has_listed_ ? std::max(nearness(), travel) : travel,
          speed};
}

template <class Space, class Real>
template <bool periodic, class MeetingsIn>
void LineSearch<Space, Real>::find(Space const& space, Discs<Space, Real> const& discs,
                                   BooksView<Space> const& books, double length,
                                   MeetingsIn const& meetings_in)
{
  ProfilingRegion const region("ricochet::find_contacts");
  has_listed_ = has_listed_ && memory_.has_room(counts_.candidates);
  Counts counts;
  counts.candidates = counts_.candidates;
  Kokkos::deep_copy(space, memory_.counts, counts);
  auto const here = lines<periodic>(discs, length, 1.5);
  auto const meetings = meetings_in(here);
  using Meetings = std::decay_t<decltype(meetings)>;
  if (has_listed_) {
    auto const end = static_cast<float>((since_sort_ + length) * (1 + 1e-6));
    using Find = FindAmongCandidates<Space, Real, periodic, Meetings>;
    Kokkos::parallel_reduce("ricochet::find_among_candidates",
                            uneven(space, 0, blocks_of(Find::block, counts.candidates)),
                            Find{here, meetings, counts.candidates, end},
                            Merge<Happened, Space>(happened_));
    enter_happened(space, books);
    return;
  }
  auto const find = [&](auto walls, auto near) {
    Kokkos::parallel_reduce(
        "ricochet::find_among_all", Range<Space>(space, 0, discs.count()),
        FindAmongAll<Space, Real, periodic, Meetings, walls, near>{here, meetings},
        Merge<Happened, Space>(happened_));
  };
  bool const near = is_near(travel_ + longest_path(length)) && !here.any_image;
  bool const walls = model_.box.x == Boundary::walls || model_.box.y == Boundary::walls;
  if (!periodic || walls) // if not periodic, there are walls
    near ? find(std::true_type{}, std::true_type{}) : find(std::true_type{}, std::false_type{});
  else if constexpr (periodic)
    near ? find(std::false_type{}, std::true_type{}) : find(std::false_type{}, std::false_type{});
  enter_happened(space, books);
}

template <class Space, class Real>
void LineSearch<Space, Real>::enter_happened(Space const& space,
                                             BooksView<Space> const& books) const
{
  auto const counts = memory_.counts;
  auto const happened = happened_;
  Kokkos::parallel_for(
      "ricochet::enter_in_books", Range<Space>(space, 0, 1), KOKKOS_LAMBDA(int) {
        books().merge(happened().books);
        counts().speed2 = happened().speed2 > counts().speed2 ? happened().speed2 : counts().speed2;
      });
}

/// Distance of the closest candidates.
template <class Space, class Real>
template <bool periodic>
Real LineSearch<Space, Real>::closest_candidates(Space const& space,
                                                 Discs<Space, Real> const& discs) const
{
  auto const candidate = memory_.candidate;
  Domain<Real, periodic> const domain(model_.box);
  Real closest2 = 0;
  Kokkos::parallel_reduce(
      "ricochet::find_closest_candidates", Range<Space>(space, 0, counts_.candidates),
      KOKKOS_LAMBDA(int place, Real& least) {
        int const i = candidate(place, 0), k = candidate(place, 1);
        if (k == partner::none)
          return;
        auto const d = domain.separation(discs.position(i), discs.position(k));
        least = dot(d, d) < least ? dot(d, d) : least;
      },
      Kokkos::Min<Real>(closest2));
  return std::sqrt(closest2);
}

} // namespace ricochet
