// Discs that do not meet each other: each flies by itself, exactly, over steps of any length.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/free_paths.hpp"
#include "ricochet/inspection.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"

namespace ricochet {

/// The way of a disc through a step in which it meets walls, from one to the next.
template <class Real, bool periodic>
struct Bounces {
  Domain<Real, periodic> domain;
  Real dt, g;
  Vec2<Real> high; ///< the most that |x| and |y| of a centre can be; infinite on a periodic axis
  WallRule<Real, true> wall;
  Scales scales;

  /// The step of disc i of these places and velocities.
  RICOCHET_APART void operator()(Real* x, Real* y, Real* vx, Real* vy, int i, Books& books) const
  {
    auto const after = at_end({{x[i], y[i]}, {vx[i], vy[i]}}, books);
    x[i] = after.place.x;
    y[i] = after.place.y;
    vx[i] = after.velocity.x;
    vy[i] = after.velocity.y;
  }

 private:
  KOKKOS_FUNCTION Motion<Real> at_end(Motion<Real> disc, Books& books) const
  {
    Real left = dt; // of the step
    bool rests = false;
    for (;;) {
      auto const& [p, v] = disc;
      Real const x = v.x > 0 ? time_to_cover(ahead(high.x - p.x), v.x, Real(0))
                             : time_to_cover(ahead(high.x + p.x), -v.x, Real(0));
      Real const floor = time_to_cover(ahead(high.y + p.y), -v.y, g);
      Real const ceiling = time_to_cover(ahead(high.y - p.y), v.y, -g);
      Real const y = rests ? never : (floor < ceiling ? floor : ceiling);
      Real const time = x <= y ? x : y;
      if (!(time < left))
        break;
      left = left - time;
      fly(disc, time, rests);
      if (x <= y)
        bounce_in_x(disc, books);
      else
        rests = bounce_in_y(disc, left, books);
    }
    fly(disc, left, rests);
    return {domain.wrapped(inside(disc.place)), disc.velocity};
  }

  static constexpr Real never = std::numeric_limits<Real>::infinity();
  static constexpr Real negligible = 0x1p-40; ///< share of a step; so hits can be counted

  KOKKOS_INLINE_FUNCTION void fly(Motion<Real>& disc, Real time, bool rests) const
  {
    disc.place = disc.place + time * disc.velocity;
    if (rests)
      return;
    disc.place.y = disc.place.y - g * time * time / 2;
    disc.velocity.y = disc.velocity.y - g * time;
  }

  KOKKOS_INLINE_FUNCTION void bounce_in_x(Motion<Real>& disc, Books& books) const
  {
    auto const before = disc;
    disc = wall.off_side(before, high.x);
    enter(1, before, disc, books);
  }

  /// At the floor or the ceiling, with `left` of the step to come. Returns whether the disc comes
  /// to rest there in it.
  ///
  /// A disc that returns to the wall n times does so with alpha^n of its speed u, each time after
  /// 2 alpha^n u/g; for ever, that takes 2 alpha u/(g (1 - alpha)). If no more than that is left,
  /// it comes to rest: normal velocity 0, and beta^n = 0 of the tangential, or all of it if beta
  /// = 1. So it does if one flight is negligible, whatever alpha is.
  KOKKOS_INLINE_FUNCTION bool bounce_in_y(Motion<Real>& disc, Real& left, Books& books) const
  {
    auto const before = disc;
    auto const v = before.velocity;
    bool const below = is_floor(disc.place.y, v.y, g);
    disc = wall.off_level(before, high.y, below);
    Real const pull = below ? g : -g; // towards the wall
    Real const flight = pull > 0 ? 2 * fabs(v.y) / pull : never;
    bool const rests =
        flight <= negligible * left || wall.alpha * flight <= (1 - wall.alpha) * left;
    std::int64_t hits = v.y == 0 ? 0 : 1;
    if (rests)
      disc.velocity = {wall.beta < 1 ? Real(0) : v.x, 0};
    else
      hits += bounce_many_times(disc, left, pull);
    enter(hits, before, disc, books);
    return rests;
  }

  /// Takes a disc that has just left a wall, to which it is pulled back, through as many flights at
  /// once as it makes before the time `left` is over or it meets another wall, or somewhat fewer:
  /// or the smallest bounces would take longest. Returns how many.
  ///
  /// With the normal velocity u after the first impact and the tangential one v, flight n = 1, 2...
  /// takes alpha^(n-1) 2u/g and leads (alpha beta)^(n-1) v 2u/g along the wall. The sum S_n of n
  /// terms of such a series with the quotient q is doubled by S_2n = S_n (1 + q^n).
  KOKKOS_INLINE_FUNCTION std::int64_t bounce_many_times(Motion<Real>& disc, Real& left,
                                                        Real pull) const
  {
    auto& [p, v] = disc;
    Real const u = fabs(v.y);
    bool const is_low = u * u < 2 * pull * high.y; // it rises to the middle of the box at most
    if (!(pull > 0 && is_low))
      return 0;
    Real const room = v.x > 0 ? high.x - p.x : high.x + p.x;
    std::int64_t n = 1;
    Real normal = wall.alpha, tangential = wall.beta; // to the power of n
    Real time = 2 * u / pull, way = time * fabs(v.x);
    auto const fits = [&](Real factor_of_time, Real factor_of_way) {
      return factor_of_time * time < left && factor_of_way * way <= room;
    };
    if (!fits(1, 1))
      return 0;
    while (fits(1 + normal, 1 + normal * tangential)) {
      time = time * (1 + normal);
      way = way * (1 + normal * tangential);
      normal = normal * normal;
      tangential = tangential * tangential;
      n = 2 * n;
    }
    left = left - time;
    p.x = v.x > 0 ? p.x + way : p.x - way;
    v = {tangential * v.x, normal * v.y};
    return n;
  }

  KOKKOS_INLINE_FUNCTION void enter(std::int64_t hits, Motion<Real> const& before,
                                    Motion<Real> const& after, Books& books) const
  {
    books.wall_hits += hits;
    books.lost_walls.add(kinetic_energy(before.velocity) - kinetic_energy(after.velocity),
                         scales.energy);
    double const lifted = static_cast<double>(after.place.y) - static_cast<double>(before.place.y);
    if (lifted != 0)
      books.numerical.add(static_cast<double>(g) * lifted, scales.energy);
  }

  /// A disc that rounding has put beyond a wall is at it.
  KOKKOS_INLINE_FUNCTION static Real ahead(Real gap) { return gap > 0 ? gap : Real(0); }
  KOKKOS_INLINE_FUNCTION Vec2<Real> inside(Vec2<Real> p) const
  {
    return {clamped(p.x, high.x), clamped(p.y, high.y)};
  }
};

/// Takes a disc through a step of length dt: along its parabola
///   x' = x + v dt - g dt^2/2,   v' = v - g dt
/// unless it meets walls. `walls` and `periodic` say whether any axis of the box has or is that.
template <class Space, class Real, bool gravity, bool walls, bool periodic>
struct FlyAlone {
  Discs<Space, Real> discs;
  Domain<Real, periodic> domain;
  Real dt;
  Real fall;          ///< g dt^2/2
  Real velocity_gain; ///< g dt
  Vec2<Real> high;    ///< as in Bounces
  Bounces<Real, periodic> bounces;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Books& books) const
  {
    auto const p = discs.position(i), v = discs.velocity(i);
    auto const straight = p + dt * v;
    auto end = straight;
    if constexpr (gravity)
      end.y = end.y - fall;
    if constexpr (walls)
      if (!stays_inside(straight, end)) {
        auto const own = bounces; // see RICOCHET_APART
        own(discs.x.data(), discs.y.data(), discs.vx.data(), discs.vy.data(), i, books);
        return;
      }
    discs.set_position(i, domain.wrapped(end));
    if constexpr (gravity)
      discs.vy(i) = v.y - velocity_gain;
  }

 private:
  /// Neither end of an arc is its highest point when it first rises, against the fall; the end
  /// without the fall is higher.
  KOKKOS_INLINE_FUNCTION bool stays_inside(Vec2<Real> straight, Vec2<Real> end) const
  {
    bool const is_inside = fabs(end.x) < high.x && fabs(end.y) < high.y;
    if constexpr (gravity)
      return is_inside && fabs(straight.y) < high.y;
    else
      return is_inside;
  }
};

/// Engines `toi` and `events` where discs do not meet each other. A step may have any length, so
/// one from frame to frame is enough.
template <class Space, class Real>
class FreeFlight : public Engine {
  static_assert(Kokkos::SpaceAccessibility<Space, typename Space::memory_space>::accessible,
                "the kernels must be able to access the discs they are given");

 public:
  FreeFlight(Model const& model, Method const& method, std::vector<DiscState> const& initial);

  void advance(std::int64_t steps) override;
  void start_measuring() override { books_.start_measuring(space_); }
  Report report() override { return books_.report(space_, discs_); }
  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  Checkpoint checkpoint() override { return save(space_, discs_, numbers()); }
  void restore(Checkpoint const& checkpoint) override
  {
    ricochet::restore(space_, discs_, numbers(), checkpoint);
  }
  std::vector<std::string> warnings() const override { return {}; }
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  auto numbers()
  {
    return [this](auto const& visit) { books_.visit_numbers(space_, visit); };
  }

 public: // nvcc takes launches only from public functions
  template <bool gravity, bool walls, bool periodic>
  void fly();

 private:
  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  Discs<Space, Real> discs_;
  RunBooks<Space> books_;
  BooksView<Space> part_; ///< of one kernel
};

template <class Space, class Real>
FreeFlight<Space, Real>::FreeFlight(Model const& model, Method const& method,
                                    std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    books_(model, method.dt, initial),
    part_("ricochet::part_of_books")
{
  require_no_contraction(space_);
  if (is_periodic(model_.box))
    wrap_all(space_, discs_, Domain<Real, true>(model_.box));
  books_.begin(space_, discs_);
  Inspection<Space, Real>(model).require_inside(space_, discs_, method);
  require_fine_enough<Real>(model, method, books_.report(space_, discs_).temperature);
}

template <class Space, class Real>
void FreeFlight<Space, Real>::advance(std::int64_t steps)
{
  for (std::int64_t k = 0; k < steps; ++k) {
    ProfilingRegion const region("ricochet::step");
    with_terms(model_,
               [&](auto gravity, auto walls, auto periodic) { fly<gravity, walls, periodic>(); });
    books_.count_steps(1);
  }
}

template <class Space, class Real>
template <bool gravity, bool walls, bool periodic>
void FreeFlight<Space, Real>::fly()
{
  auto const dt = static_cast<Real>(dt_), g = static_cast<Real>(model_.gravity);
  auto const high = centre_limits<Real>(model_);
  WallRule<Real, true> const wall{static_cast<Real>(model_.contact.restitution),
                                  static_cast<Real>(model_.contact.friction)};
  Range<Space> const all(space_, 0, discs_.count());
  Domain<Real, periodic> const domain(model_.box);
  FlyAlone<Space, Real, gravity, walls, periodic> const fly_alone{
      discs_,
      domain,
      dt,
      g * dt * dt / 2,
      g * dt,
      high,
      {domain, dt, g, high, wall, books_.scales()}};
  Kokkos::parallel_reduce("ricochet::fly_alone", all, fly_alone, Merge<Books, Space>(part_));
  enter<Space>(space_, books_.view(), part_);
}

} // namespace ricochet
