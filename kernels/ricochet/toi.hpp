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
  static constexpr int most_rounds = CalledInRounds::most_rounds;

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

  /// As many rounds as the step before took, or one less where to read is cheaper than a round in
  /// vain, are queued without waiting for what comes of them; then the host reads whether there are
  /// more. They are planned for speeds up to that of the fastest disc: if one has become faster,
  /// the rest of them does nothing, and is queued again.
  template <bool periodic>
  void resolve_contacts()
  {
    ProfilingRegion const region("ricochet::resolve_contacts");
    has_left_contacts_ = false;
    int const queued =
        std::min(executed_rounds() - (shares_host_memory<Space> ? 1 : 0), most_rounds - 1);
    double fastest2 = search_.speed() * search_.speed();
    for (int round = 1; round <= most_rounds; ++round) {
      list_called(round, fastest2);
      if (round > queued) {
        double const speed2 = read_counts().speed2;
        if (speed2 > fastest2) {
          fastest2 = speed2;
          round = executed_rounds();
          continue;
        }
        if (called_.in_round[round] == 0)
          return;
      }
      execute_round<periodic>(round);
    }
    read_counts();
    has_left_contacts_ = true; // discs that must be kept inside the box now leave their lines
  }

  /// Lists the discs that are called up for a round, as none if one is faster than expected.
  void list_called(int round, double fastest2)
  {
    auto const& m = search_.memory();
    ricochet::list_called(space_, m, round, 0,
                          CountCalled<Space>{m, memory_.called_in(round), fastest2});
  }

  typename LineSearch<Space, Real>::Counts const& read_counts()
  {
    auto const& counts = search_.read_counts(space_);
    called_ = value_after(space_, memory_.called);
    for (int round = 1; round <= executed_rounds(); ++round)
      expected_.in_round[round] = called_.in_round[round];
    return counts;
  }

  /// Rounds of this step, or of the one before, that were executed, as far as the host knows.
  int executed_rounds() const
  {
    int rounds = 0;
    while (rounds < most_rounds && called_.in_round[rounds + 1] > 0)
      ++rounds;
    return rounds;
  }

 public: // nvcc takes device lambdas and launches only from public functions
  template <bool periodic>
  void execute_round(int round);
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
  CalledInRounds called_;          ///< as the host last saw it
  CalledInRounds expected_;        ///< the latest of each round that there were
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

/// The host need not know how many discs are called up for it, but had better expect so many.
template <class Space, class Real>
template <bool periodic>
void TimeOfImpact<Space, Real>::execute_round(int round)
{
  int const items = std::max(expected_.in_round[round], 1);
  int const* const called = memory_.called_in(round);
  Range<Space> const range(space_, 0, items);
  ToiStep<Space, Real, periodic> const step(search_.template lines<periodic>(discs_, dt_, 1.5),
                                            memory_);
  WallRule<Real, true> const wall{static_cast<Real>(model_.contact.restitution),
                                  static_cast<Real>(model_.contact.friction)};
  using Choose = ChooseNext<Space, Real, periodic>;
  Kokkos::parallel_for("ricochet::choose_next", range,
                       ForListed<Choose>{{step, round}, called, items});
  std::visit(
      [&](auto const& law) {
        using Resolve = ResolveContacts<Space, Real, periodic, std::decay_t<decltype(law)>>;
        Kokkos::parallel_reduce(
            "ricochet::resolve_contacts", range,
            ForListed<Resolve, Happened>{{step, law, wall, books_.scales(), round}, called, items},
            Merge<Happened, Space>(search_.happened()));
      },
      law_);
  search_.enter_happened(space_, books_.view());
  using Find = FindNewContacts<Space, Real, periodic>;
  Kokkos::parallel_for("ricochet::find_new_contacts", range,
                       ForListed<Find>{{step, round}, called, items});
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
  search_.inspect(space_, discs_, inspection_);
  auto report = books_.report(space_, discs_);
  inspection_.enter(report);
  return report;
}

} // namespace ricochet
