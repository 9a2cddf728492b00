// Included by one source file for each number format.
#pragma once

#include "fixed_step_engines.hpp"

#include "ricochet/fixed_step.hpp"
#include "ricochet/simultaneous.hpp"
#include "ricochet/spaces.hpp"
#include "ricochet/sweep.hpp"

namespace ricochet {

template <class Space, class Real>
std::unique_ptr<Engine> make_fixed_step_on(Model const& model, Method const& method,
                                           std::vector<DiscState> const& initial)
{
  using Sweep = FixedStep<Space, Real, OrderedPairs<Space, Real>>;
  using Simultaneous = FixedStep<Space, Real, SimultaneousPairs<Space, Real>>;
  if (method.engine == EngineKind::sweep)
    return std::make_unique<Sweep>(model, method, initial);
  return std::make_unique<Simultaneous>(model, method, initial);
}

template <class Real>
std::unique_ptr<Engine> make_fixed_step(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial, bool one_thread)
{
  if constexpr (has_two_spaces)
    if (one_thread)
      return make_fixed_step_on<SerialSpace, Real>(model, method, initial);
  return make_fixed_step_on<ParallelSpace, Real>(model, method, initial);
}

} // namespace ricochet
