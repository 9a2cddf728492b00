// The instruction sets that a build can require, one bit each.
#pragma once

namespace ricochet::driver {

enum CpuFeature : unsigned {
  cpu_sse3 = 1u << 0,
  cpu_ssse3 = 1u << 1,
  cpu_sse4_1 = 1u << 2,
  cpu_sse4_2 = 1u << 3,
  cpu_popcnt = 1u << 4,
  cpu_avx = 1u << 5,
  cpu_avx2 = 1u << 6,
  cpu_fma = 1u << 7,
  cpu_bmi = 1u << 8,
  cpu_bmi2 = 1u << 9,
  cpu_avx512f = 1u << 10,
  cpu_avx512cd = 1u << 11,
  cpu_avx512bw = 1u << 12,
  cpu_avx512dq = 1u << 13,
  cpu_avx512vl = 1u << 14
};

/// Those that the rest of the program was compiled for.
extern unsigned const cpu_features_required;

} // namespace ricochet::driver
