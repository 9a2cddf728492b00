// Engines that are compiled apart from each other, so that a build can use several processors.
#pragma once

#include "ricochet/engine.hpp"

namespace ricochet {

/// An engine of one kind with state and arithmetic in `Real`: on one thread of the host, or on the
/// default backend. The arguments were checked. For engines toi and events discs must be separate
/// and inside the walls, or it throws std::invalid_argument.
template <class Real>
std::unique_ptr<Engine> make_fixed_step(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial, bool one_thread);
template <class Real>
std::unique_ptr<Engine> make_free_flight(Model const& model, Method const& method,
                                         std::vector<DiscState> const& initial, bool one_thread);
template <class Real>
std::unique_ptr<Engine> make_time_of_impact(Model const& model, Method const& method,
                                            std::vector<DiscState> const& initial, bool one_thread);
template <class Real>
std::unique_ptr<Engine> make_event_driven(Model const& model, Method const& method,
                                          std::vector<DiscState> const& initial, bool one_thread);

} // namespace ricochet
