// The engine `toi`: fixed step, contacts at their time of impact inside it.
#pragma once

#include "ricochet/checkpoint.hpp"
#include "ricochet/line_search.hpp"
#include "ricochet/reproducible.hpp"
#include "ricochet/run_books.hpp"
#include "ricochet/toi_contacts.hpp"

#include <variant>

namespace ricochet {

/// Engine `toi`. The state after a step is a function of the state before it: how often discs are
/// sorted, and how far is searched, changes the cost and not a bit.
template <class Space, class Real>
class TimeOfImpact : public Engine {
  static_assert(Kokkos::SpaceAccessibility<Space, typename Space::memory_space>::accessible,
                "the kernels must be able to access the discs they are given");

 public:
  TimeOfImpact(Model const& model, Method const& method, std::vector<DiscState> const& initial);

  void advance(std::int64_t steps) override
  {
    for (std::int64_t k = 0; k < steps; ++k)
      if (is_periodic(model_.box))
        step<true>();
      else
        step<false>();
  }

  Report report() override;
  void start_measuring() override { books_.start_measuring(space_); }

  void states(DiscState* out) override { copy_states(space_, discs_, out); }
  std::uint64_t state_hash() override { return ricochet::state_hash(space_, discs_); }
  Checkpoint checkpoint() override { return save(space_, discs_, numbers()); }
  void restore(Checkpoint const& checkpoint) override
  {
    ricochet::restore(space_, discs_, numbers(), checkpoint);
    search_.forget();
  }
  std::vector<std::string> warnings() const override { return {}; }
  std::string backend() const override { return Space::name(); }
  int threads() const override { return space_.concurrency(); }

 private:
  /// After so many rounds in a step contacts are left to the next one: discs at rest on each other
  /// would go on for ever.
  static constexpr int most_rounds = 32;
  auto numbers()
  {
    return [this](auto const& visit) {
      books_.visit_numbers(space_, visit);
      inspection_.visit_numbers(visit);
    };
  }

  template <bool periodic>
  void step()
  {
    ProfilingRegion const region("ricochet::step");
    search_.template prepare<periodic>(space_, discs_, inspection_, dt_);
    find_contacts<periodic>();
    resolve_contacts<periodic>();
    fly();
    search_.end(dt_, has_left_contacts_);
    books_.count_steps(1);
  }

  template <bool periodic>
  void find_contacts()
  {
    search_.template find<periodic>(space_, discs_, books_.view(), dt_, [&](auto const& lines) {
      return BeginWith<Space, Real, periodic>{{lines, memory_}};
    });
  }

  template <bool periodic>
  void resolve_contacts()
  {
    ProfilingRegion const region("ricochet::resolve_contacts");
    has_left_contacts_ = false;
    for (int round = 1; round <= most_rounds; ++round) {
      int const called = search_.list_called(space_, round);
      if (called == 0)
        return;
      execute_round<periodic>(round, called);
    }
    search_.read_counts(space_); // of the last round
    has_left_contacts_ = true;   // discs that must be kept inside the box now leave their lines
  }

 public: // nvcc takes device lambdas and launches only from public functions
  template <bool periodic>
  void execute_round(int round, int called);
  void fly();

 private:
  Space space_ = own_instance<Space>();
  Model model_;
  double dt_;
  AnyLaw<Real> law_;
  Discs<Space, Real> discs_;
  LineSearch<Space, Real> search_;
  ContactMemory<Space, Real> memory_;
  RunBooks<Space> books_;
  Inspection<Space, Real> inspection_;
  bool has_left_contacts_ = false; ///< to the next step
};

template <class Space, class Real>
TimeOfImpact<Space, Real>::TimeOfImpact(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial)
  : model_(model),
    dt_(method.dt),
    law_(contact_law<Real>(model.contact)),
    discs_(discs_from<Space, Real>(space_, initial.data(), static_cast<int>(initial.size()))),
    search_(model, discs_.count(), discs_.count()),
    memory_(discs_.count()),
    books_(model, method.dt, initial),
    inspection_(model)
{
  require_no_contraction(space_);
  if (is_periodic(model_.box))
    wrap_all(space_, discs_, Domain<Real, true>(model_.box));
  books_.begin(space_, discs_);
  inspection_.require_separate(space_, search_.grid(), discs_, method);
  require_fine_enough<Real>(model, method, books_.report(space_, discs_).temperature);
}

template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::execute_round(int round, int called)
{
  ToiStep<Space, Real, periodic> const step(search_.template lines<periodic>(discs_, dt_, 1.5),
                                            memory_);
  WallRule<Real, true> const wall{static_cast<Real>(model_.contact.restitution),
                                  static_cast<Real>(model_.contact.friction)};
  Kokkos::parallel_for("ricochet::choose_next", Range<Space>(space_, 0, called),
                       ChooseNext<Space, Real, periodic>{step, round});
  std::visit(
      [&](auto const& law) {
        Kokkos::parallel_reduce("ricochet::resolve_contacts", Range<Space>(space_, 0, called),
                                ResolveContacts<Space, Real, periodic, std::decay_t<decltype(law)>>{
                                    step, law, wall, books_.scales(), round},
                                Merge<Happened, Space>(search_.happened()));
      },
      law_);
  search_.enter_happened(space_, books_.view());
  Kokkos::parallel_for("ricochet::find_new_contacts", Range<Space>(space_, 0, called),
                       FindNewContacts<Space, Real, periodic>{step, round});
}

template <class Space, class Real>
void TimeOfImpact<Space, Real>::fly()
{
  ProfilingRegion const region("ricochet::fly");
  auto const& m = search_.memory();
  with_landing(discs_, model_, dt_, [&](auto const& land) {
    Kokkos::parallel_reduce("ricochet::settle", Range<Space>(space_, 0, m.blocks()),
                            Settle<Space, Real, std::decay_t<decltype(land)>>{
                                m, memory_, land, Outside(model_), model_.gravity, books_.scales()},
                            Merge<Happened, Space>(search_.happened()));
    Kokkos::parallel_for("ricochet::fly", Range<Space>(space_, 0, discs_.count()), land);
  });
  search_.enter_happened(space_, books_.view());
}

template <class Space, class Real>
Report TimeOfImpact<Space, Real>::report()
{
  search_.inspect(space_, discs_, inspection_, dt_);
  auto report = books_.report(space_, discs_);
  inspection_.enter(report);
  return report;
}

} // namespace ricochet
