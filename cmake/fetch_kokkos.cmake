# Downloads Kokkos and Kokkos Kernels and builds them as part of this build (option
# ricochet_FETCH_KOKKOS, for machines with internet). Chosen: the newest pair that is C++17, free of
# the g++ 12 trouble of its predecessors, and fit for CUDA 13.
include(FetchContent)

set(ricochet_kokkos_release 4.7.01 CACHE STRING "Release of Kokkos and Kokkos Kernels to fetch")
mark_as_advanced(ricochet_kokkos_release)

set(Kokkos_ENABLE_SERIAL ON CACHE BOOL "")
if(ricochet_BACKEND MATCHES "^(openmp|cuda|hip)$")
  string(TOUPPER "${ricochet_BACKEND}" ricochet_upper)
  set(Kokkos_ENABLE_${ricochet_upper} ON CACHE BOOL "")
elseif(NOT ricochet_BACKEND)
  set(Kokkos_ENABLE_OPENMP ON CACHE BOOL "")
endif()
set(Kokkos_ENABLE_DEBUG_BOUNDS_CHECK ${ricochet_BOUNDS_CHECKS} CACHE BOOL "")
if(ricochet_BACKEND STREQUAL "hip")
  set(Kokkos_ENABLE_ROCTHRUST OFF CACHE BOOL "")
endif()
set(KokkosKernels_ADD_DEFAULT_ETI OFF CACHE BOOL "")
set(KokkosKernels_ENABLE_TPL_BLAS OFF CACHE BOOL "")
set(KokkosKernels_ENABLE_TPL_LAPACK OFF CACHE BOOL "")
foreach(kind IN ITEMS LAYOUTLEFT LAYOUTRIGHT DOUBLE ORDINAL_INT OFFSET_INT OFFSET_SIZE_T)
  set(KokkosKernels_INST_${kind} OFF CACHE BOOL "")
endforeach()

message(STATUS "Fetching Kokkos ${ricochet_kokkos_release}")
FetchContent_Declare(kokkos
  GIT_REPOSITORY https://github.com/kokkos/kokkos.git
  GIT_TAG ${ricochet_kokkos_release} GIT_SHALLOW ON)
FetchContent_MakeAvailable(kokkos)
if(ricochet_KOKKOS_KERNELS)
  FetchContent_Declare(kokkoskernels
    GIT_REPOSITORY https://github.com/kokkos/kokkos-kernels.git
    GIT_TAG ${ricochet_kokkos_release} GIT_SHALLOW ON)
  FetchContent_MakeAvailable(kokkoskernels)
endif()
get_directory_property(Kokkos_DEVICES DIRECTORY "${kokkos_SOURCE_DIR}" DEFINITION KOKKOS_ENABLED_DEVICES)
get_directory_property(Kokkos_CXX_COMPILER_ID DIRECTORY "${kokkos_SOURCE_DIR}" DEFINITION KOKKOS_CXX_COMPILER_ID)
set(Kokkos_VERSION ${ricochet_kokkos_release})
set(Kokkos_DIR "${kokkos_BINARY_DIR}")
