// Included by one source file for each number format.
#pragma once

#include "compiled_engines.hpp"

#include "ricochet/fixed_step.hpp"
#include "ricochet/simultaneous.hpp"
#include "ricochet/spaces.hpp"
#include "ricochet/sweep.hpp"

namespace ricochet {

template <class Real>
std::unique_ptr<Engine> make_fixed_step(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial, bool one_thread)
{
  return with_space(one_thread, [&](auto tag) -> std::unique_ptr<Engine> {
    using Space = typename decltype(tag)::type;
    using Sweep = FixedStep<Space, Real, OrderedPairs<Space, Real>>;
    using Simultaneous = FixedStep<Space, Real, SimultaneousPairs<Space, Real>>;
    if (method.engine == EngineKind::sweep)
      return std::make_unique<Sweep>(model, method, initial);
    return std::make_unique<Simultaneous>(model, method, initial);
  });
}

} // namespace ricochet
