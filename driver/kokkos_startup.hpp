// Starting Kokkos with the user's wishes, whatever the version of Kokkos calls them.
//
// Only this part of the program and the one that paints discs see Kokkos.
#pragma once

#include <functional>
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

/// How many threads of the host can use engines of Placement::serial at the same time: none beside
/// the first in a build for a device, which is for one engine at a time, in one without OpenMP, and
/// where a tool of Kokkos is loaded.
int host_threads();

/// Calls work(0)...work(count - 1) on host_threads() threads, in any order. `work` may not throw.
void on_host_threads(int count, std::function<void(int)> const& work);

/// Lets the calling thread run on all processors that OpenMP has. A thread inherits the binding of
/// the one that made it, and would have to share that one's processor.
void share_processors();

/// Version such as "3.4.1"; needs no session.
std::string kokkos_version();

/// Default backend and host backend, such as "OpenMP" or "Cuda, OpenMP"; needs no session.
std::string kokkos_backends();

/// What Kokkos was built with and runs on, as of the start of the session.
std::string kokkos_configuration();

} // namespace ricochet::driver
