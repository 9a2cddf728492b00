# How the Kokkos and Kokkos Kernels of the per-user cache are built: an initial cache, read with
#   cmake -Dflavour=openmp|serial|debug -C kokkos_options.cmake -S <source> …
# The name of the cached folder holds a checksum of this file, so an edit here makes a new build.

set(CMAKE_INSTALL_LIBDIR lib CACHE STRING "")
set(CMAKE_POSITION_INDEPENDENT_CODE ON CACHE BOOL "") # static archives that a shared ricochet can hold
set(CMAKE_CXX_EXTENSIONS OFF CACHE BOOL "")
set(Kokkos_CXX_STANDARD 17 CACHE STRING "")
set(Kokkos_ENABLE_SERIAL ON CACHE BOOL "")
set(Kokkos_ENABLE_LAUNCH_COMPILER OFF CACHE BOOL "")
set(Kokkos_ENABLE_TESTS OFF CACHE BOOL "")

if(flavour STREQUAL "serial")
  set(CMAKE_BUILD_TYPE Release CACHE STRING "")
elseif(flavour STREQUAL "openmp")
  set(CMAKE_BUILD_TYPE Release CACHE STRING "")
  set(Kokkos_ENABLE_OPENMP ON CACHE BOOL "")
elseif(flavour STREQUAL "debug")
  set(CMAKE_BUILD_TYPE Debug CACHE STRING "")
  set(Kokkos_ENABLE_OPENMP ON CACHE BOOL "")
  set(Kokkos_ENABLE_DEBUG_BOUNDS_CHECK ON CACHE BOOL "")
else()
  message(FATAL_ERROR "flavour '${flavour}' is not one of openmp, serial, debug")
endif()

# Kokkos Kernels without ready-made instantiations: what is used is compiled where it is used.
set(KokkosKernels_ADD_DEFAULT_ETI OFF CACHE BOOL "")
set(KokkosKernels_ENABLE_TPL_BLAS OFF CACHE BOOL "")
foreach(kind IN ITEMS LAYOUTLEFT LAYOUTRIGHT DOUBLE ORDINAL_INT OFFSET_INT OFFSET_SIZE_T)
  set(KokkosKernels_INST_${kind} OFF CACHE BOOL "")
endforeach()
