/// Serial event-driven dynamics of equal hard discs: the oracle of the tests.
///
/// Plain C++17, written without sight of the parallel engine it judges. It favours being
/// obviously right over being fast; good for up to a few thousand discs.
///
/// What it is not: a contact solver. Piles at rest and inelastic collapse need infinitely many
/// events in finite time; `advance` throws once event times stop increasing.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <queue>
#include <vector>

namespace ricochet::reference {

/// What two touching, approaching discs do. n = unit normal from the first disc to the second,
/// u = v.n, t = v - u n.
enum class Law {
  swap_scale,  ///< v1' = alpha u2 n + beta t1, v2' = alpha u1 n + beta t2; momentum is lost
  restitution, ///< v1' = (u1 (1-alpha)/2 + u2 (1+alpha)/2) n + t1 (1+beta)/2 + t2 (1-beta)/2
};

/// The box, centred at the origin, and the laws in it. Discs have mass 1.
struct Scene {
  double width;            ///< x extent of the box [length], at least 2 radius
  double height;           ///< y extent of the box [length], at least 2 radius
  double radius;           ///< of every disc [length], > 0
  double gravity = 0;      ///< downward acceleration [length / time^2], >= 0; 0 if `periodic_y`
  bool periodic_x = false; ///< else walls at x = -width/2 and width/2
  bool periodic_y = false; ///< else walls at y = -height/2 and height/2
  Law law = Law::restitution;
  double alpha = 1; ///< normal factor, 0 .. 1, of pairs and walls (1: elastic)
  double beta = 1;  ///< tangential factor, 0 .. 1, of pairs and walls (1: smooth)
};

/// Centre and velocity.
struct Disc {
  double x, y, vx, vy;
};

/// In the order in which simultaneous hits of one disc are executed.
enum Wall : int { left_wall, right_wall, floor_wall, ceiling_wall };

/// In the order in which simultaneous events are executed.
enum class EventKind { pair, wall };

/// One executed contact.
struct Event {
  double time; ///< since the start
  EventKind kind;
  int first;  ///< disc; the smaller id of a pair
  int second; ///< the larger id of a pair, or the `Wall`
};

/// Exact motion between and through contacts.
///
/// Rules.
/// - Only approaching pairs collide. Overlapping and approaching: now. Overlapping and
///   separating: never. The normal is the line of centres, whatever their distance.
/// - A pair that has collided does not collide again, through the same periodic image, before
///   another contact of either disc. (Through another image it may: two discs alone in a
///   periodic box do so for ever.)
/// - A hit on a wall puts the centre exactly on the line where the disc touches, multiplies the
///   normal velocity by -alpha and the tangential one by beta.
/// - Simultaneous events run in the order (time, pair before wall, smaller id, larger id or
///   wall). Times are compared as rounded numbers, without tolerance.
///
/// The trajectory is, bit for bit, a function of the scene and the initial discs alone: it
/// depends neither on when it is looked at nor on `least_cell_width`. This holds because cell
/// crossings never touch a disc's state, and a pair's contact time is always predicted from the
/// instant of the later of the two discs' last contacts.
class EventDriven {
 public:
  /// Throws std::invalid_argument if the scene is impossible, a number is not finite or a centre
  /// lies beyond a wall. Overlaps are accepted. `least_cell_width` widens the search cells, for
  /// tests; the default suits the density.
  EventDriven(Scene const& scene, std::vector<Disc> const& discs, double least_cell_width = 0);

  /// Runs all events up to and including `time` since the start, and stops there.
  ///
  /// Throws std::runtime_error when far more events than discs pass at one instant (rest on the
  /// floor, inelastic collapse).
  void advance(double time);

  /// Runs exactly `count` more contacts (or as many as ever come) and stops at the last one.
  void advance_events(std::int64_t count);

  /// From now on contacts are appended to `log()`, or not. Off at the start.
  void record(bool on) { recording_ = on; }

  /// States at the present time, in the order given; periodic coordinates in [-L/2, L/2).
  std::vector<Disc> states() const;

  /// Since the start.
  double time() const { return epoch_ + (epoch_low_ + now_); }

  std::int64_t pair_events() const { return pair_events_; }
  std::int64_t wall_events() const { return wall_events_; }

  /// Search bookkeeping, not physics.
  std::int64_t crossings() const { return crossings_; }

  /// Sum over pair contacts of (dv2 - dv1).(r2 - r1) / 2, dv = change of velocity.
  ///
  /// If pairs conserve momentum this is dv2.(r2 - r1), and without walls, with T = kinetic energy
  /// per disc, the virial theorem in 2-D reads p A / (N T) = Z = 1 + virial / (2 N T t).
  double virial() const { return virial_; }

  /// Sum of the normal momentum handed to each wall, outward positive, by `Wall`.
  std::array<double, 4> const& wall_impulse() const { return wall_impulse_; }

  std::vector<Event> const& log() const { return log_; }

 private:
  /// Which periodic copy of the other disc a pair means: the one at its centre + (x width,
  /// y height).
  struct Image {
    std::int64_t x = 0, y = 0;
  };

  struct Partner {
    std::size_t disc;
    Image image;
  };

  /// A disc as its last contact (or the last `rebase`) left it, and where the search has it now.
  struct Body {
    double x, y, vx, vy; ///< at `clock`; periodic coordinates are not wrapped between rebases
    double clock;
    std::int64_t contacts;      ///< forecasts that remember another number are void
    std::int64_t column, row;   ///< cell at the present time, unwrapped like x and y
    bool falling;               ///< has left a cell downward since `clock`, under gravity
    Partner last;               ///< of the last contact; disc == nobody if that was a wall
    std::size_t next, previous; ///< in the cell's list
  };

  enum class Kind { crossing, pair, wall };

  struct Forecast {
    double time; ///< since the epoch
    Kind kind;
    std::size_t first, second; ///< pair: smaller and larger id; else disc and wall or cell face
    Image image;               ///< of the second, seen from the first
    std::int64_t first_contacts, second_contacts;
  };

  struct Later {
    bool operator()(Forecast const& a, Forecast const& b) const;
  };

  static constexpr std::size_t nobody = static_cast<std::size_t>(-1);

  void run(double last_time, std::int64_t count);
  bool is_void(Forecast const& f) const;
  Body flown(Body const& b, double time) const;
  void rebase();
  void guard_against_stall();

  std::size_t cell(std::int64_t column, std::int64_t row) const;
  void link(std::size_t i);
  void unlink(std::size_t i);

  void forecast_pair(std::size_t i, std::size_t j, Image image);
  void forecast_cell(std::size_t i, std::int64_t column, std::int64_t row, bool each_pair_once);
  void forecast_neighbours(std::size_t i, bool each_pair_once);
  void forecast_walls(std::size_t i);
  void forecast_crossing(std::size_t i);

  void cross(Forecast const& f);
  bool collide(Forecast const& f);
  void bounce(Forecast const& f);

  Scene scene_;
  std::int64_t columns_, rows_;
  double cell_width_, cell_height_;
  std::vector<Body> bodies_;
  std::vector<std::size_t> cell_head_;
  std::priority_queue<Forecast, std::vector<Forecast>, Later> forecasts_;

  double epoch_ = 0, epoch_low_ = 0; ///< unevaluated sum: start of the present time count
  double now_ = 0;                   ///< since the epoch
  std::int64_t contacts_since_rebase_ = 0;
  double stall_time_ = -1; ///< since the start
  std::int64_t stall_events_ = 0;

  bool recording_ = false;
  std::int64_t pair_events_ = 0, wall_events_ = 0, crossings_ = 0;
  double virial_ = 0;
  std::array<double, 4> wall_impulse_{};
  std::vector<Event> log_;
};

} // namespace ricochet::reference
