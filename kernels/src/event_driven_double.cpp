#include "event_driven_engines.ipp"

namespace ricochet {

template std::unique_ptr<Engine> make_event_driven<double>(Model const&, Method const&,
                                                           std::vector<DiscState> const&, bool);

} // namespace ricochet
