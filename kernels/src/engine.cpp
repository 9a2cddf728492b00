#include "ricochet/engine.hpp"

#include "compiled_engines.hpp"
#include "ricochet/spaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace ricochet {
namespace {

/// With fewer discs than this a second thread costs more than it helps: waking it for each kernel
/// of a step costs as much as the work on about 600 discs on an idle machine and several times that
/// on a busy one, and the rows of `sweep`, half of the work, are one thread's in any case.
constexpr std::size_t worth_two_threads = 10000;

bool prefers_one_thread(Placement placement, std::size_t discs)
{
  if (placement != Placement::automatic)
    return placement == Placement::serial;
  if (parallel_is_device)
    return false;
  return discs < worth_two_threads || ParallelSpace().concurrency() == 1;
}

std::string line(Problem const& problem)
{
  return "\n  " + problem.quantity + " is " + problem.found + "; allowed: " + problem.allowed;
}

void require_valid(Model const& model, Method const& method, std::vector<DiscState> const& initial)
{
  std::string message;
  for (auto const& problem : problems(model))
    message += line(problem);
  if (!(std::isfinite(method.dt) && method.dt > 0))
    message += line({"run.dt", std::to_string(method.dt), "a finite number above 0"});
  if (initial.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / 2))
    message += line({"discs", std::to_string(initial.size()), "fewer than 2^30"});
  auto const bad_discs = problems(model, initial);
  constexpr std::size_t shown = 20;
  for (std::size_t k = 0; k < std::min(bad_discs.size(), shown); ++k)
    message += "\n  disc " + std::to_string(bad_discs[k].disc) + ":" +
               line(bad_discs[k].problem).substr(2);
  if (bad_discs.size() > shown)
    message += "\n  and " + std::to_string(bad_discs.size() - shown) + " more";
  if (!message.empty())
    throw std::invalid_argument("this scene cannot be simulated:" + message);
}

} // namespace

std::unique_ptr<Engine> make_engine(Model const& model, Method const& method,
                                    std::vector<DiscState> const& initial)
{
  require_valid(model, method, initial);
  bool const one_thread = prefers_one_thread(method.placement, initial.size());
  auto const make = [&](auto real) {
    using Real = decltype(real);
    bool const is_toi = method.engine == EngineKind::toi;
    if (!is_toi && method.engine != EngineKind::events)
      return make_fixed_step<Real>(model, method, initial, one_thread);
    if (!model.contact.pairs)
      return make_free_flight<Real>(model, method, initial, one_thread);
    return is_toi ? make_time_of_impact<Real>(model, method, initial, one_thread)
                  : make_event_driven<Real>(model, method, initial, one_thread);
  };
  return method.precision == Precision::single_ ? make(float{}) : make(double{});
}

char const* name(EngineKind engine)
{
  switch (engine) {
  case EngineKind::sweep:
    return "sweep";
  case EngineKind::simultaneous:
    return "simultaneous";
  case EngineKind::toi:
    return "toi";
  case EngineKind::events:
    return "events";
  }
  return "";
}

char const* name(Law law)
{
  return law == Law::swap_scale ? "swap_scale" : "restitution";
}

char const* name_of_law(Contact const& contact)
{
  return contact.pairs ? name(contact.law) : "none";
}

char const* name(Precision precision)
{
  return precision == Precision::single_ ? "single" : "double";
}

std::vector<EngineKind> const& engine_kinds()
{
  static std::vector<EngineKind> const all{EngineKind::sweep, EngineKind::simultaneous,
                                           EngineKind::toi, EngineKind::events};
  return all;
}

} // namespace ricochet
