// Included by one source file for each number format.
#pragma once

#include "compiled_engines.hpp"

#include "ricochet/free_flight.hpp"
#include "ricochet/spaces.hpp"

namespace ricochet {

template <class Real>
std::unique_ptr<Engine> make_free_flight(Model const& model, Method const& method,
                                         std::vector<DiscState> const& initial, bool one_thread)
{
  return with_space(one_thread, [&](auto tag) -> std::unique_ptr<Engine> {
    using Space = typename decltype(tag)::type;
    return std::make_unique<FreeFlight<Space, Real>>(model, method, initial);
  });
}

} // namespace ricochet
