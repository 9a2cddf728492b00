#include "free_flight_engines.ipp"

namespace ricochet {

template std::unique_ptr<Engine> make_free_flight<double>(Model const&, Method const&,
                                                          std::vector<DiscState> const&, bool);

} // namespace ricochet
