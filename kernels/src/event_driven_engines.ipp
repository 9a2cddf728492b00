// Included by one source file for each number format.
#pragma once

#include "event_driven_engines.hpp"

#include "ricochet/events.hpp"
#include "ricochet/spaces.hpp"

namespace ricochet {

template <class Real>
std::unique_ptr<Engine> make_event_driven(Model const& model, Method const& method,
                                          std::vector<DiscState> const& initial, bool one_thread)
{
  if constexpr (has_two_spaces)
    if (one_thread)
      return std::make_unique<EventDriven<SerialSpace, Real>>(model, method, initial);
  return std::make_unique<EventDriven<ParallelSpace, Real>>(model, method, initial);
}

} // namespace ricochet
