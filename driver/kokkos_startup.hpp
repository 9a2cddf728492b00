// Starting Kokkos with the user's wishes, whatever the version of Kokkos calls them.
//
// Only this part of the program and the one that paints discs see Kokkos.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace ricochet::driver {

/// What the command line says about Kokkos.
struct KokkosOptions {
  std::vector<std::string> flags; ///< those that begin with --kokkos-
  std::optional<int> threads;     ///< of the host
  bool quiet = false;             ///< no warnings
};

/// Kokkos is initialised while one of these lives. All engines must be gone before.
class KokkosSession {
 public:
  /// Throws Failure: Exit::usage for a flag that Kokkos does not know, Exit::failed if the build
  /// needs a device that is not there.
  explicit KokkosSession(KokkosOptions const& options);
  ~KokkosSession();
  KokkosSession(KokkosSession const&) = delete;
  KokkosSession& operator=(KokkosSession const&) = delete;
};

/// Kokkos' own description of its options, on standard output.
void print_kokkos_help();

/// Waits for the work on all backends.
void fence();

/// Version such as "3.4.1"; needs no session.
std::string kokkos_version();

/// Default backend and host backend, such as "OpenMP" or "Cuda, OpenMP"; needs no session.
std::string kokkos_backends();

/// What Kokkos was built with and runs on.
std::string kokkos_configuration();

} // namespace ricochet::driver
