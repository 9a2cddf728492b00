# Kokkos and Kokkos Kernels: found as the backend asks, or fetched where that was asked for.

include("${CMAKE_CURRENT_LIST_DIR}/find_kokkos.cmake")

function(ricochet_no_kokkos report)
  if(ricochet_BACKEND STREQUAL "serial")
    set(what "the Serial backend alone")
  elseif(ricochet_BACKEND)
    set(what "backend ${ricochet_BACKEND}")
  else()
    set(what "a supported version (3.4 up to 5.x)")
  endif()
  if(ricochet_BOUNDS_CHECKS)
    string(APPEND what " and bounds checks")
  endif()
  set(flavour ${ricochet_BACKEND})
  if(ricochet_BOUNDS_CHECKS)
    set(flavour debug)
  endif()
  set(advice "pass -DKokkos_ROOT=PREFIX of your own, or -Dricochet_FETCH_KOKKOS=ON to download and build one")
  if(NOT flavour MATCHES "cuda|hip")
    string(PREPEND advice "Run `cmake/setup deps ${flavour}` (Debian 12), or ")
  else()
    string(PREPEND advice "Build one as cmake/README.md says and ")
  endif()
  message(FATAL_ERROR "No Kokkos with ${what} was found.${report}\n${advice}.")
endfunction()

if(ricochet_FETCH_KOKKOS)
  include("${CMAKE_CURRENT_LIST_DIR}/fetch_kokkos.cmake")
else()
  ricochet_find_kokkos(ricochet_kokkos "${ricochet_BACKEND}" "${ricochet_BOUNDS_CHECKS}"
                       "${CMAKE_CXX_COMPILER_ID}-${CMAKE_CXX_COMPILER_VERSION}")
  if(NOT ricochet_kokkos)
    ricochet_no_kokkos("${ricochet_kokkos_report}")
  endif()

  # Kokkos_DIR, not PATHS: an entry left by an earlier configuration would be taken first.
  set(Kokkos_DIR "${ricochet_kokkos}" CACHE PATH "Folder of KokkosConfig.cmake" FORCE)
  find_package(Kokkos CONFIG REQUIRED)

  if(ricochet_KOKKOS_KERNELS)
    # Beside the Kokkos found; else where the user points. The system's own folders are left out:
    # what is there belongs to another Kokkos.
    cmake_path(GET Kokkos_DIR PARENT_PATH ricochet_beside)
    find_package(KokkosKernels CONFIG QUIET HINTS "${ricochet_beside}"
                 NO_CMAKE_SYSTEM_PATH NO_SYSTEM_ENVIRONMENT_PATH NO_CMAKE_PACKAGE_REGISTRY)
    if(NOT KokkosKernels_FOUND OR NOT TARGET Kokkos::kokkoskernels)
      message(FATAL_ERROR
        "No Kokkos Kernels was found beside the Kokkos in ${Kokkos_DIR}.\n"
        "Install the same version there, or pass -DKokkosKernels_ROOT=PREFIX; "
        "-Dricochet_KOKKOS_KERNELS=OFF leaves out what needs it.")
    endif()
    if(KokkosKernels_VERSION)
      string(REGEX MATCH "^[0-9]+\\.[0-9]+" ricochet_kokkos_release "${Kokkos_VERSION}")
      string(REGEX MATCH "^[0-9]+\\.[0-9]+" ricochet_kernels_release "${KokkosKernels_VERSION}")
      if(NOT ricochet_kokkos_release STREQUAL ricochet_kernels_release)
        message(WARNING "Kokkos is ${Kokkos_VERSION} but Kokkos Kernels is ${KokkosKernels_VERSION} "
                        "(${KokkosKernels_DIR}); they are meant to be of one version.")
      endif()
    endif()
  endif()
endif()

list(JOIN Kokkos_DEVICES " + " ricochet_devices)
message(STATUS "Kokkos ${Kokkos_VERSION} (${ricochet_devices}) in ${Kokkos_DIR}")

# g++ 12.2-12.4 can skip the constructor of a View's reference count in Kokkos before 4.7.1 whose
# View is built on mdspan: the first View of a program then crashes it. Whether it does depends on
# how Kokkos was configured, so it is tried.
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12.2
   AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 12.5 AND Kokkos_VERSION VERSION_GREATER_EQUAL 3.5
   AND Kokkos_VERSION VERSION_LESS 4.7.1 AND NOT ricochet_FETCH_KOKKOS AND NOT CMAKE_CROSSCOMPILING)
  if(NOT "${ricochet_VIEW_PROBE}" STREQUAL "passed with ${Kokkos_DIR}")
    try_run(ricochet_view_ran ricochet_view_compiled "${CMAKE_BINARY_DIR}/view_probe"
            "${CMAKE_CURRENT_LIST_DIR}/view_probe.cpp" LINK_LIBRARIES Kokkos::kokkos
            CXX_STANDARD 17 CXX_STANDARD_REQUIRED ON
            COMPILE_OUTPUT_VARIABLE ricochet_view_output)
    if(NOT ricochet_view_compiled)
      message(FATAL_ERROR "A program with one Kokkos::View does not compile:\n${ricochet_view_output}")
    elseif(ricochet_view_ran EQUAL 127)
      message(STATUS "A first View could not be tried here: its program does not start (no device driver?)")
    elseif(NOT ricochet_view_ran EQUAL 0)
      unset(ricochet_view_ran CACHE)
      unset(ricochet_view_compiled CACHE)
      message(FATAL_ERROR
        "g++ ${CMAKE_CXX_COMPILER_VERSION} miscompiles the Views of Kokkos ${Kokkos_VERSION}: a program "
        "that only makes one crashes.\nUse Kokkos 3.4 or at least 4.7.1, or clang++, or build that Kokkos with "
        "-DKokkos_ENABLE_IMPL_VIEW_LEGACY=ON.")
    endif()
    set(ricochet_VIEW_PROBE "passed with ${Kokkos_DIR}" CACHE INTERNAL "")
  endif()
endif()
