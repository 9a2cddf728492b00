#include "time_of_impact_engines.ipp"

namespace ricochet {

template std::unique_ptr<Engine> make_time_of_impact<float>(Model const&, Method const&,
                                                            std::vector<DiscState> const&, bool);

} // namespace ricochet
