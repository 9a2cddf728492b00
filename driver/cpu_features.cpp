// Compiled with the flags of the rest of the program, which is the point: the compiler says here
// what those allow it to use. A constant and no code, so it is safe to read on any processor.
#include "cpu_features.hpp"

namespace ricochet::driver {

unsigned const cpu_features_required = 0u
#ifdef __SSE3__
                                       | cpu_sse3
#endif
#ifdef __SSSE3__
                                       | cpu_ssse3
#endif
#ifdef __SSE4_1__
                                       | cpu_sse4_1
#endif
#ifdef __SSE4_2__
                                       | cpu_sse4_2
#endif
#ifdef __POPCNT__
                                       | cpu_popcnt
#endif
#ifdef __AVX__
                                       | cpu_avx
#endif
#ifdef __AVX2__
                                       | cpu_avx2
#endif
#ifdef __FMA__
                                       | cpu_fma
#endif
#ifdef __BMI__
                                       | cpu_bmi
#endif
#ifdef __BMI2__
                                       | cpu_bmi2
#endif
#ifdef __AVX512F__
                                       | cpu_avx512f
#endif
#ifdef __AVX512CD__
                                       | cpu_avx512cd
#endif
#ifdef __AVX512BW__
                                       | cpu_avx512bw
#endif
#ifdef __AVX512DQ__
                                       | cpu_avx512dq
#endif
#ifdef __AVX512VL__
                                       | cpu_avx512vl
#endif
    ;

} // namespace ricochet::driver
