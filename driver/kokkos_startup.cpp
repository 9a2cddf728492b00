#include "kokkos_startup.hpp"

#include "exit_codes.hpp"

#include <Kokkos_Core.hpp>

#if defined(KOKKOS_ENABLE_OPENMP)
#include <omp.h>
#endif

#include <cstdlib>
#include <iostream>
#include <sched.h>
#include <sstream>
#include <type_traits>
#include <unistd.h>

namespace ricochet::driver {

namespace {

// Kokkos 3.7 renamed its start-up options; before, unknown ones are ignored without a word.
#if KOKKOS_VERSION < 30700
constexpr bool old_names = true;
#else
constexpr bool old_names = false;
#endif

std::string configuration; // only the thread that starts Kokkos can ask for it

struct Flag {
  char const* name;
  char const* old_name; ///< before 3.7; empty: not available
  bool has_value;
};

constexpr Flag known_flags[] = {
    {"--kokkos-help", "--kokkos-help", false},
    {"--kokkos-num-threads", "--kokkos-threads", true},
    {"--kokkos-device-id", "--kokkos-device-id", true},
    {"--kokkos-map-device-id-by", "", true},
    {"--kokkos-print-configuration", "--kokkos-print-configuration", false},
    {"--kokkos-disable-warnings", "--kokkos-disable-warnings", false},
    {"--kokkos-tune-internals", "--kokkos-tune-internals", false},
    {"--kokkos-tools-libs", "--kokkos-tools-library", true},
    {"--kokkos-tools-args", "--kokkos-tools-args", true},
    {"--kokkos-tools-help", "--kokkos-tools-help", false},
};

[[noreturn]] void refuse(std::string const& flag, std::string const& why)
{
  throw Failure(Exit::usage, flag + ": " + why);
}

// `flag` as the Kokkos of this build spells it.
std::string translated(std::string const& flag)
{
  std::size_t const equals = flag.find('=');
  std::string const name = flag.substr(0, equals);
  std::string const value = equals == std::string::npos ? "" : flag.substr(equals);
  for (Flag const& known : known_flags) {
    if (name != known.name && name != known.old_name)
      continue;
    if (known.has_value && value.size() < 2)
      refuse(name, "no value (write " + name + "=VALUE)");
    std::string const spelling = old_names ? known.old_name : known.name;
    if (spelling.empty())
      refuse(name, "Kokkos " + kokkos_version() + " does not have this option");
    return spelling + value;
  }
  refuse(name, "unknown Kokkos option (--kokkos-help lists them)");
}

bool is_on(char const* variable)
{
  char const* const value = std::getenv(variable);
  std::string const text = value ? value : "";
  return !(text.empty() || text == "0" || text == "no" || text == "off" || text == "false");
}

void translate_environment(KokkosOptions const& options)
{
  // Some versions refuse to start if the variable and the option differ; the option wins.
  if (options.threads)
    ::unsetenv("KOKKOS_NUM_THREADS");
  if (old_names)
    if (char const* const tools = std::getenv("KOKKOS_TOOLS_LIBS"))
      ::setenv("KOKKOS_PROFILE_LIBRARY", tools, 0);
}

// A GPU build on a node without GPU is told so in a sentence; Kokkos itself would abort.
void require_device()
{
#if defined(KOKKOS_ENABLE_CUDA)
  int devices = 0;
  auto const status = cudaGetDeviceCount(&devices);
  if (status != cudaSuccess || devices == 0)
    throw Failure(Exit::failed,
                  std::string("this program was built for NVIDIA GPUs and finds none here (") +
                      (status != cudaSuccess ? cudaGetErrorString(status) : "no device") +
                      "); run it on a node with a GPU, or build the preset openmp");
#elif defined(KOKKOS_ENABLE_HIP)
  int devices = 0;
  auto const status = hipGetDeviceCount(&devices);
  if (status != hipSuccess || devices == 0)
    throw Failure(Exit::failed,
                  std::string("this program was built for AMD GPUs and finds none here (") +
                      (status != hipSuccess ? hipGetErrorString(status) : "no device") +
                      "); run it on a node with a GPU, or build the preset openmp");
#endif
}

void initialise(std::vector<std::string> arguments)
{
  arguments.insert(arguments.begin(), "ricochet");
  std::vector<char*> argv;
  for (std::string& argument : arguments)
    argv.push_back(argument.data());
  argv.push_back(nullptr);
  int argc = static_cast<int>(arguments.size());
  Kokkos::initialize(argc, argv.data());
}

} // namespace

KokkosSession::KokkosSession(KokkosOptions const& options)
{
  std::vector<std::string> arguments;
  // Kokkos would print it on standard output, which is for results.
  bool print = is_on("KOKKOS_PRINT_CONFIGURATION");
  ::unsetenv("KOKKOS_PRINT_CONFIGURATION");
  for (std::string const& flag : options.flags) {
    std::string const own = translated(flag);
    if (own == "--kokkos-print-configuration")
      print = true;
    else
      arguments.push_back(own);
  }
  if (options.threads)
    arguments.push_back(translated("--kokkos-num-threads=" + std::to_string(*options.threads)));
  if (options.quiet || !::isatty(STDERR_FILENO))
    arguments.push_back("--kokkos-disable-warnings");

  require_device();
  translate_environment(options);
#if defined(KOKKOS_ENABLE_OPENMP)
  if (options.threads)
    omp_set_num_threads(*options.threads); // or Kokkos starts all there could be, to count them
#endif
  try {
    initialise(std::move(arguments));
  } catch (std::exception const& error) {
    throw Failure(Exit::failed, std::string("Kokkos does not start: ") + error.what());
  }
  std::ostringstream text;
  Kokkos::print_configuration(text, true);
  configuration = text.str();
  if (print)
    std::cerr << configuration;
}

KokkosSession::~KokkosSession()
{
  Kokkos::finalize();
}

void print_kokkos_help()
{
  initialise({"--kokkos-help", "--kokkos-disable-warnings"});
  Kokkos::finalize();
}

void fence()
{
  Kokkos::fence();
}

int host_threads()
{
  using Device = Kokkos::DefaultExecutionSpace;
  using Host = Kokkos::DefaultHostExecutionSpace;
  bool const one = !std::is_same_v<Device, Host> || Kokkos::Profiling::profileLibraryLoaded();
#if defined(KOKKOS_ENABLE_OPENMP)
  return one ? 1 : Host().concurrency();
#else
  static_cast<void>(one);
  return 1;
#endif
}

// The threads are those of OpenMP, which are bound to processors as the user wants it, and in which
// the little that Kokkos does by its default backend whatever is asked for runs in place.
void on_host_threads(int count, std::function<void(int)> const& work)
{
#if defined(KOKKOS_ENABLE_OPENMP)
  int const threads = host_threads();
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads) if (threads > 1)
#endif
  for (int i = 0; i < count; ++i)
    work(i);
}

void share_processors()
{
#if defined(KOKKOS_ENABLE_OPENMP) && defined(__linux__)
  cpu_set_t all;
  CPU_ZERO(&all);
  for (int place = 0; place < omp_get_num_places(); ++place) { // none if threads are not bound
    std::vector<int> processors(static_cast<std::size_t>(omp_get_place_num_procs(place)));
    omp_get_place_proc_ids(place, processors.data());
    for (int const processor : processors)
      CPU_SET(processor, &all);
  }
  if (CPU_COUNT(&all) > 0)
    ::sched_setaffinity(0, sizeof all, &all); // without it, all goes on as it is
#endif
}

std::string kokkos_version()
{
  return std::to_string(KOKKOS_VERSION / 10000) + "." + std::to_string(KOKKOS_VERSION / 100 % 100) +
         "." + std::to_string(KOKKOS_VERSION % 100);
}

std::string kokkos_backends()
{
  std::string const device = Kokkos::DefaultExecutionSpace::name();
  std::string const host = Kokkos::DefaultHostExecutionSpace::name();
  return device == host ? device : device + ", " + host;
}

std::string kokkos_configuration()
{
  return configuration;
}

} // namespace ricochet::driver
