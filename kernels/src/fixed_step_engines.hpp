// Engines that are compiled apart from each other, so that a build can use several processors.
#pragma once

#include "ricochet/engine.hpp"

namespace ricochet {

/// A fixed-step engine with state and arithmetic in `Real`: on one thread of the host, or on the
/// default backend. The arguments were checked.
template <class Real>
std::unique_ptr<Engine> make_fixed_step(Model const& model, Method const& method,
                                        std::vector<DiscState> const& initial, bool one_thread);

extern template std::unique_ptr<Engine>
make_fixed_step<double>(Model const&, Method const&, std::vector<DiscState> const&, bool);
extern template std::unique_ptr<Engine> make_fixed_step<float>(Model const&, Method const&,
                                                               std::vector<DiscState> const&, bool);

} // namespace ricochet
