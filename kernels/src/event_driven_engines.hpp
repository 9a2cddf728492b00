// Engine `events`, compiled apart from the others, so that a build can use several processors.
#pragma once

#include "ricochet/engine.hpp"

namespace ricochet {

/// The event-driven engine with state and arithmetic in `Real`: on one thread of the host, or on
/// the default backend. The model, the numbers and the step were checked; throws
/// std::invalid_argument if discs overlap or are partly outside.
template <class Real>
std::unique_ptr<Engine> make_event_driven(Model const& model, Method const& method,
                                          std::vector<DiscState> const& initial, bool one_thread);

extern template std::unique_ptr<Engine>
make_event_driven<double>(Model const&, Method const&, std::vector<DiscState> const&, bool);
extern template std::unique_ptr<Engine>
make_event_driven<float>(Model const&, Method const&, std::vector<DiscState> const&, bool);

} // namespace ricochet
