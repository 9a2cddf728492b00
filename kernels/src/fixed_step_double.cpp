#include "fixed_step_engines.ipp"

namespace ricochet {

template std::unique_ptr<Engine> make_fixed_step<double>(Model const&, Method const&,
                                                         std::vector<DiscState> const&, bool);

} // namespace ricochet
