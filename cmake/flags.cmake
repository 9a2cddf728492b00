# Compile options that belong to the whole project.
include(CheckCXXCompilerFlag)

# Contraction (a*b+c rounded once) is what differs most between compilers and backends, so it is off
# wherever a kernel is compiled: PUBLIC, because headers with arithmetic are compiled into users too.
# nvcc_wrapper calls itself GNU; that Kokkos was built by nvcc tells.
function(ricochet_reproducible_arithmetic target)
  set(by_nvcc FALSE)
  if("CUDA" IN_LIST Kokkos_DEVICES AND Kokkos_CXX_COMPILER_ID STREQUAL "NVIDIA")
    set(by_nvcc TRUE)
  endif()
  target_compile_options(${target} PUBLIC
    $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang,IntelLLVM>:-ffp-contract=off>
    $<$<AND:$<COMPILE_LANGUAGE:CXX>,$<BOOL:${by_nvcc}>>:--fmad=false>
    "$<$<COMPILE_LANG_AND_ID:CUDA,NVIDIA>:--fmad=false;-Xcompiler=-ffp-contract=off>")
  if(by_nvcc)
    # Calling a host function from a kernel is only a warning to nvcc.
    target_compile_options(${target} PRIVATE
      $<$<COMPILE_LANGUAGE:CXX>:-Werror=cross-execution-space-call>)
  endif()
  if(NOT "OPENMP" IN_LIST Kokkos_DEVICES AND NOT "HIP" IN_LIST Kokkos_DEVICES AND NOT by_nvcc)
    # `#pragma omp simd` without the OpenMP backend; otherwise it is ignored, with a warning. (hipcc
    # would take the option for device code as well, which then does not link.)
    target_compile_options(${target} PUBLIC
      $<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang>:-fopenmp-simd>)
  endif()
endfunction()

# The instruction set. x86-64-v3 (AVX2) and not `native`: g++ 12 makes slower code for AVX-512, and
# the program runs on any processor since about 2013. Left alone where Kokkos already chooses one, and
# for devices. A directory option and not one of the library's interface: everything built here
# agrees on it, while a program that uses the installed library chooses for itself. (It can: nothing
# passes between the two whose layout depends on the instruction set, and results do not either.)
set(ricochet_default_arch "")
if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$" AND NOT Kokkos_ARCH
   AND NOT "CUDA" IN_LIST Kokkos_DEVICES AND NOT "HIP" IN_LIST Kokkos_DEVICES)
  check_cxx_compiler_flag(-march=x86-64-v3 ricochet_knows_x86_64_v3)
  if(ricochet_knows_x86_64_v3)
    set(ricochet_default_arch x86-64-v3)
  endif()
endif()
set(ricochet_ARCH "${ricochet_default_arch}" CACHE STRING
  "Value of -march for everything built here; empty: the compiler's default")
if(ricochet_ARCH)
  string(MAKE_C_IDENTIFIER "ricochet_accepts_march_${ricochet_ARCH}" ricochet_accepts)
  check_cxx_compiler_flag("-march=${ricochet_ARCH}" ${ricochet_accepts})
  if(NOT ${ricochet_accepts})
    message(FATAL_ERROR "${CMAKE_CXX_COMPILER} does not know -march=${ricochet_ARCH} (ricochet_ARCH).")
  endif()
  add_compile_options("-march=${ricochet_ARCH}")
endif()

# Compiles a source file for the oldest processor of its family and without sanitizers, whatever the
# rest is compiled for: it runs before it is known that the rest can.
function(ricochet_baseline_source source)
  set(options "")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
    list(APPEND options -march=x86-64 -mno-sse3) # the second also revokes -mavx2 and the like
  endif()
  if(ricochet_SANITIZE)
    list(APPEND options -fno-sanitize=all)
  endif()
  set_source_files_properties("${source}" PROPERTIES COMPILE_OPTIONS "${options}")
endfunction()

if(ricochet_SANITIZE)
  add_compile_options("-fsanitize=${ricochet_SANITIZE}" -fno-sanitize-recover=all -fno-omit-frame-pointer)
  add_link_options("-fsanitize=${ricochet_SANITIZE}")
  # A pointer checked at each use once more than by `address` costs a third of the time to compile
  # the kernels.
  if(ricochet_SANITIZE MATCHES "address" AND ricochet_SANITIZE MATCHES "undefined")
    add_compile_options(-fno-sanitize=null,alignment,object-size,vptr)
  endif()
endif()
