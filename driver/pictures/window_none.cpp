// In a build without SDL2.
#include "exit_codes.hpp"
#include "pictures/window.hpp"

namespace ricochet::driver {

bool has_window()
{
  return false;
}

std::unique_ptr<Window> open_window(std::string const&, int, int)
{
  throw Failure(Exit::failed, "this program was built without windows (install the package "
                              "libsdl2-dev and build it again)");
}

} // namespace ricochet::driver
