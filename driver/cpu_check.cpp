// Compiled for the oldest processor of the family (ricochet_baseline_source in the CMake files),
// unlike everything else. It therefore uses no inline function of any header: the linker might
// merge it with a copy that was compiled for a newer processor.
#include "cpu_check.hpp"

#include "cpu_features.hpp"

#include <unistd.h>

namespace ricochet::driver {

#if defined(__x86_64__) && defined(__GNUC__)

namespace {

// __builtin_cpu_supports takes only literals, and g++ and clang++ know these in common. The rest of
// an x86-64 level has come in the same processors as its members here.
#define RICOCHET_CPU_CHECK(bit, name, title)                                                       \
  if ((cpu_features_required & (bit)) != 0 && !__builtin_cpu_supports(name))                       \
  return title

char const* look()
{
  __builtin_cpu_init();
  RICOCHET_CPU_CHECK(cpu_sse3, "sse3", "SSE3");
  RICOCHET_CPU_CHECK(cpu_ssse3, "ssse3", "SSSE3");
  RICOCHET_CPU_CHECK(cpu_sse4_1, "sse4.1", "SSE4.1");
  RICOCHET_CPU_CHECK(cpu_sse4_2, "sse4.2", "SSE4.2");
  RICOCHET_CPU_CHECK(cpu_popcnt, "popcnt", "POPCNT");
  RICOCHET_CPU_CHECK(cpu_avx, "avx", "AVX");
  RICOCHET_CPU_CHECK(cpu_avx2, "avx2", "AVX2");
  RICOCHET_CPU_CHECK(cpu_fma, "fma", "FMA");
  RICOCHET_CPU_CHECK(cpu_bmi, "bmi", "BMI");
  RICOCHET_CPU_CHECK(cpu_bmi2, "bmi2", "BMI2");
  RICOCHET_CPU_CHECK(cpu_avx512f, "avx512f", "AVX-512F");
  RICOCHET_CPU_CHECK(cpu_avx512cd, "avx512cd", "AVX-512CD");
  RICOCHET_CPU_CHECK(cpu_avx512bw, "avx512bw", "AVX-512BW");
  RICOCHET_CPU_CHECK(cpu_avx512dq, "avx512dq", "AVX-512DQ");
  RICOCHET_CPU_CHECK(cpu_avx512vl, "avx512vl", "AVX-512VL");
  return nullptr;
}

#undef RICOCHET_CPU_CHECK

} // namespace

char const* missing_cpu_feature()
{
  return look();
}

// hipcc reads every file twice, once for the device.
#if defined(__linux__) && defined(__GLIBC__) && !defined(__HIP_DEVICE_COMPILE__)

namespace {

void say(char const* text)
{
  unsigned long length = 0;
  while (text[length] != '\0')
    ++length;
  // Nothing can be done about a closed stderr.
  [[maybe_unused]] auto const written = ::write(STDERR_FILENO, text, length);
}

void check_before_all_else(int /*argc*/, char** /*argv*/, char** /*environment*/)
{
  char const* const missing = look();
  if (missing == nullptr)
    return;
  say("ricochet: this program was compiled for processors with ");
  say(missing);
  say(", which this one lacks. Build it here, or with -Dricochet_ARCH=x86-64.\n");
  ::_exit(70);
}

// Entries of .preinit_array run before the initialisers of the program and of its shared libraries.
__attribute__((section(".preinit_array"),
               used)) void (*const run_first)(int, char**, char**) = check_before_all_else;

} // namespace

#endif

#else

char const* missing_cpu_feature()
{
  return nullptr;
}

#endif

} // namespace ricochet::driver
