// The time step of the original model, shared by the engines that follow it.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/contacts.hpp"
#include "ricochet/flight.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"
#include "ricochet/walls.hpp"

#include <cmath>
#include <variant>

namespace ricochet {

/// A disc's motion through a step, and then its walls.
template <class Space, class Real, class Flight, class Walls>
struct FlyThenBounce {
  Discs<Space, Real> discs;
  Flight fly;
  Walls bounce;

  KOKKOS_INLINE_FUNCTION void operator()(int i, Books& books) const
  {
    auto const disc = fly(discs.motion(i));
    auto const p = bounce.domain.wrapped(disc.place);
    discs.set_position(i, p);
    if constexpr (Flight::accelerates)
      discs.vy(i) = disc.velocity.y;
    if (bounce.hits(p)) {
      auto const own = bounce; // see RICOCHET_APART
      own(discs.x.data(), discs.y.data(), discs.vx.data(), discs.vy.data(), i, books);
    }
  }
};

/// An engine that advances all discs by the same fixed step: contacts, then motion, then walls.
///
/// `PairStep` resolves the contacts of a state whose overlaps were found. All work is queued on one
/// execution space instance; only report(), states() and state_hash() wait for it.
template <class Space, class Real, class PairStep>
class FixedStep : public Engine {
  static_assert(Kokkos::SpaceAccessibility<Space, typename Space::memory_space>::accessible,
                "the kernels must be able to access the discs they are given");

 public:
  FixedStep(Model const& model, Method const& method, std::vector<DiscState> const& initial)
    : model_(model),
      dt_(method.dt),
      diameter_(static_cast<Real>(2) * static_cast<Real>(model.radius)),
      law_(contact_law<Real>(model.contact)),
      discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
      grid_(model, model.contact.pairs ? discs_.count() : 0),
      pairs_(grid_, 2 * model.radius, method.execution, model.contact.pairs ? discs_.count() : 0),
      books_(model, method.dt, initial),
      part_("ricochet::part_of_books")
  {
    require_no_contraction(space_);
    with_boundaries(
        [&](auto periodic) { wrap_all(space_, discs_, Domain<Real, periodic>(model_.box)); });
    books_.begin(space_, discs_);
    note_warnings(method.engine);
  }

  void advance(std::int64_t steps) override
  {
    for (std::int64_t k = 0; k < steps; ++k)
      step();
  }

  void start_measuring() override { books_.start_measuring(space_); }
  Report report() override;

  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  Checkpoint checkpoint() override { return save(space_, discs_, numbers()); }
  void restore(Checkpoint const& checkpoint) override
  {
    ricochet::restore(space_, discs_, numbers(), checkpoint);
  }
  std::vector<std::string> warnings() const override { return warnings_; }
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  auto numbers()
  {
    return [this](auto const& visit) {
      books_.visit_numbers(space_, visit);
      pairs_.visit_numbers(visit);
    };
  }

  void step()
  {
    ProfilingRegion const region("ricochet::step");
    if (model_.contact.pairs) {
      grid_.sort(space_, discs_);
      resolve_contacts();
    }
    fly_and_bounce_off_walls();
    enter<Space>(space_, books_.view(), part_);
    books_.count_steps(1);
  }

 public: // nvcc takes device lambdas and launches only from public functions
  void resolve_contacts();
  void fly_and_bounce_off_walls();
  void look_at_start();

 private:
  /// Calls use(periodic) with a compile-time answer to whether any axis of the box is periodic.
  template <class Use>
  void with_boundaries(Use const& use) const
  {
    if (is_periodic(model_.box))
      use(std::true_type{});
    else
      use(std::false_type{});
  }

  template <bool periodic>
  PairState<Space, Real, periodic> pair_state() const
  {
    auto spare = grid_.spare();
    spare.id = discs_.id;
    return {
        discs_,     spare,     grid_.cell(),   grid_.cells(),   Domain<Real, periodic>(model_.box),
        model_.box, diameter_, model_.gravity, books_.scales(), books_.view()};
  }

  void note_warnings(EngineKind engine);

  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  Real diameter_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  CellGrid<Space, Real> grid_;
  PairStep pairs_;
  RunBooks<Space> books_;
  BooksView<Space> part_; ///< of one kernel
  std::vector<std::string> warnings_;
};

template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::resolve_contacts()
{
  ProfilingRegion const region("ricochet::resolve_contacts");
  with_boundaries([&](auto periodic) {
    std::visit([&](auto const& law) { pairs_.resolve(space_, pair_state<periodic>(), law); }, law_);
  });
}

/// Motion and walls in one kernel: either alone does little more than wait for memory.
template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::fly_and_bounce_off_walls()
{
  with_flight<Real>(model_.gravity, dt_, [&](auto const& fly) {
    with_walls<Real>(model_, books_.scales(), [&](auto const& bounce) {
      Kokkos::parallel_reduce(
          "ricochet::fly_and_bounce_off_walls", Range<Space>(space_, 0, discs_.count()),
          FlyThenBounce<Space, Real, std::decay_t<decltype(fly)>, std::decay_t<decltype(bounce)>>{
              discs_, fly, bounce},
          Merge<Books, Space>(part_));
    });
  });
}

/// Enters the extremes of the initial state in the books.
template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::look_at_start()
{
  Range<Space> const all(space_, 0, discs_.count());
  Outside const outside(model_);
  auto const discs = discs_;
  Kokkos::parallel_reduce(
      "ricochet::find_outside", all,
      KOKKOS_LAMBDA(int i, Books& books) { outside.enter(discs.position(i), books.max_outside); },
      Merge<Books, Space>(part_));
  enter<Space>(space_, books_.view(), part_);
  if (!model_.contact.pairs)
    return;
  grid_.sort(space_, discs_);
  with_boundaries([&](auto periodic) {
    auto const state = pair_state<periodic>();
    Kokkos::parallel_reduce("ricochet::find_deepest_overlap", all,
                            EnterOverlaps<Space, Real, periodic>{state, state.neighbours()},
                            Merge<Books, Space>(part_));
  });
  enter<Space>(space_, books_.view(), part_);
}

template <class Space, class Real, class PairStep>
void FixedStep<Space, Real, PairStep>::note_warnings(EngineKind engine)
{
  if (engine == EngineKind::simultaneous)
    warnings_.push_back("engine simultaneous gains energy wherever discs stay in contact, at any "
                        "step length; it exists to reproduce the original's parallel variant");
  look_at_start();
  Books const books = books_.entries(space_);
  auto const percent = [](double share) { return std::to_string(std::lround(100 * share)) + " %"; };
  if (books.max_overlap > 0)
    warnings_.push_back("discs overlap at the start, by up to " + percent(books.max_overlap) +
                        " of a diameter");
  double const packing = packing_fraction(model_, static_cast<std::size_t>(discs_.count()));
  if (packing > densest_packing)
    warnings_.push_back("the discs cover " + percent(packing) +
                        " of the box; without overlaps at most 90.69 % is possible");
  if (books.max_outside > 0)
    warnings_.push_back("discs reach beyond a wall at the start, by up to " +
                        percent(books.max_outside) + " of a diameter");
}

template <class Space, class Real, class PairStep>
Report FixedStep<Space, Real, PairStep>::report()
{
  auto report = books_.report(space_, discs_);
  report.executions = pairs_.executions();
  report.energy.numerical += static_cast<double>(report.steps) * static_cast<double>(report.discs) *
                             flight_error<Real>(model_.gravity, dt_);
  return report;
}

} // namespace ricochet
