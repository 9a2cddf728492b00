#include "provenance.hpp"

#include "kokkos_startup.hpp"
#include "progress.hpp"
#include "ricochet/version.hpp"

#include <fmt/format.h>
#include <hdf5.h>

#include <unistd.h>

namespace ricochet::driver {

std::string host_name()
{
  char name[256] = "";
  return ::gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

std::string version()
{
  return ricochet::version;
}

std::string git_state()
{
  return ricochet::git_state;
}

std::string compiler()
{
#if defined(__clang__)
  return fmt::format("clang {}", __clang_version__);
#elif defined(__GNUC__)
  return fmt::format("g++ {}", __VERSION__);
#else
  return "unknown";
#endif
}

std::string hdf5_version()
{
  return fmt::format("{}.{}.{}", H5_VERS_MAJOR, H5_VERS_MINOR, H5_VERS_RELEASE);
}

std::string version_text()
{
  return fmt::format(
      "ricochet {}\ngit      {}\nKokkos   {}\nbackend  {}\nHDF5     {}\ncompiler {}\n", version(),
      git_state(), kokkos_version(), kokkos_backends(), hdf5_version(), compiler());
}

std::string provenance_text()
{
  return fmt::format("{}host     {}\nstarted  {}\n", version_text(), host_name(), utc_now());
}

} // namespace ricochet::driver
