// Where this program comes from and what it runs on.
#pragma once

#include <string>

namespace ricochet::driver {

/// Version of this program, such as "0.1.0".
std::string version();

/// The commit it was built from, with "-dirty" if files were changed; "unknown" outside git.
std::string git_state();

/// Name of this machine.
std::string host_name();

std::string compiler();
std::string hdf5_version();

/// Version, git state, Kokkos, HDF5, backends and compiler, one a line.
std::string version_text();

/// version_text() with the machine and the time.
std::string provenance_text();

} // namespace ricochet::driver
