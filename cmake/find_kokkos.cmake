# Which installed Kokkos serves this build: decided by reading its files, before any find_package(),
# because a second find_package(Kokkos) in one configuration is an error, and because a plain one
# silently takes Debian's libtrilinos-kokkos-dev, which has the Serial backend only (that package
# has no KokkosConfigCommon.cmake and is passed over here).
#
# Included by kokkos.cmake; run by `setup` as a script:
#   cmake -Dbackend=openmp -Dbounds_checks=OFF -Dcompiler=GNU-12.2.0 [-Dskip_cache=ON] -P find_kokkos.cmake
# which prints the folder of KokkosConfig.cmake, or nothing.

cmake_minimum_required(VERSION 3.22)

set(ricochet_kokkos_options_file "${CMAKE_CURRENT_LIST_DIR}/kokkos_options.cmake")

# The prefix of the Kokkos that `setup` builds. `flavour`: openmp, serial or debug; `compiler`: id
# and version, since archives of different compilers call different OpenMP runtimes.
function(ricochet_cached_kokkos out flavour compiler)
  set(root "$ENV{XDG_CACHE_HOME}")
  if(root STREQUAL "")
    set(root "$ENV{HOME}/.cache")
  endif()
  cmake_host_system_information(RESULT machine QUERY OS_PLATFORM)
  file(SHA256 "${ricochet_kokkos_options_file}" options)
  string(SUBSTRING "${options}" 0 8 options)
  set(${out} "${root}/ricochet/kokkos-3.4.1-${flavour}-${compiler}-${machine}-${options}" PARENT_SCOPE)
endfunction()

# Why the Kokkos in folder `dir` does not serve; empty if it does.
function(ricochet_kokkos_misfit out dir backend bounds_checks)
  set(${out} "" PARENT_SCOPE)
  file(STRINGS "${dir}/KokkosConfigVersion.cmake" version REGEX "^ *set\\(PACKAGE_VERSION " LIMIT_COUNT 1)
  string(REGEX REPLACE ".*\"(.*)\".*" "\\1" version "${version}")
  if(version VERSION_LESS 3.4 OR version VERSION_GREATER_EQUAL 6)
    set(${out} "it is version ${version}; 3.4 up to 5.x are supported" PARENT_SCOPE)
    return()
  endif()

  file(STRINGS "${dir}/KokkosConfigCommon.cmake" lines REGEX "^ *(SET|set)\\(Kokkos_(DEVICES|OPTIONS) ")
  set(devices "")
  set(options "")
  # file(STRINGS) escapes the semicolons inside a line, so this walks over lines.
  foreach(line IN LISTS lines)
    if(line MATCHES "Kokkos_DEVICES ([^)]*)")
      string(TOUPPER "${CMAKE_MATCH_1}" devices)
    elseif(line MATCHES "Kokkos_OPTIONS ([^)]*)")
      string(TOUPPER "${CMAKE_MATCH_1}" options)
    endif()
  endforeach()

  string(TOUPPER "${backend}" backend)
  if(backend STREQUAL "SERIAL")
    set(others "${devices}")
    list(REMOVE_ITEM others SERIAL)
    if(others OR NOT "SERIAL" IN_LIST devices)
      set(${out} "its backends are ${devices}; wanted is one with Serial alone" PARENT_SCOPE)
      return()
    endif()
  elseif(backend AND NOT backend IN_LIST devices)
    set(${out} "its backends are ${devices}; ${backend} is not among them" PARENT_SCOPE)
    return()
  endif()
  if(bounds_checks AND NOT "DEBUG_BOUNDS_CHECK" IN_LIST options)
    set(${out} "it was built without Kokkos_ENABLE_DEBUG_BOUNDS_CHECK" PARENT_SCOPE)
  endif()
endfunction()

# Sets `out` to the folder of a KokkosConfig.cmake that serves, or to nothing, and `out`_report to
# a line for each one that was looked at and refused. A Kokkos that the user named (Kokkos_ROOT,
# Kokkos_DIR) is the only candidate. Then come the usual prefixes, then the per-user cache.
function(ricochet_find_kokkos out backend bounds_checks compiler)
  set(named "")
  if(NOT "${Kokkos_ROOT}$ENV{Kokkos_ROOT}" STREQUAL "")
    set(named ${Kokkos_ROOT} $ENV{Kokkos_ROOT})
  elseif(EXISTS "${Kokkos_DIR}/KokkosConfig.cmake")
    set(named "${Kokkos_DIR}") # also what an earlier configuration of this tree decided
  endif()

  if(named)
    set(prefixes ${named})
  else()
    string(REPLACE ":" ";" from_environment "$ENV{CMAKE_PREFIX_PATH}")
    set(prefixes ${CMAKE_PREFIX_PATH} ${from_environment} ${CMAKE_SYSTEM_PREFIX_PATH} /usr/local /usr)
    if(NOT skip_cache)
      set(flavour openmp)
      if(bounds_checks)
        set(flavour debug)
      elseif(backend MATCHES "^[Ss][Ee][Rr]")
        set(flavour serial)
      endif()
      ricochet_cached_kokkos(cached ${flavour} "${compiler}")
      list(APPEND prefixes "${cached}")
    endif()
  endif()
  list(REMOVE_DUPLICATES prefixes)
  cmake_host_system_information(RESULT machine QUERY OS_PLATFORM)

  set(report "")
  foreach(prefix IN LISTS prefixes)
    foreach(suffix IN ITEMS "" /lib/cmake/Kokkos /lib64/cmake/Kokkos
                            /lib/${machine}-linux-gnu/cmake/Kokkos)
      set(dir "${prefix}${suffix}")
      if(NOT EXISTS "${dir}/KokkosConfigCommon.cmake")
        continue()
      endif()
      ricochet_kokkos_misfit(misfit "${dir}" "${backend}" "${bounds_checks}")
      if(misfit STREQUAL "")
        set(${out} "${dir}" PARENT_SCOPE)
        set(${out}_report "" PARENT_SCOPE)
        return()
      endif()
      string(APPEND report "\n  ${prefix}: ${misfit}.")
    endforeach()
  endforeach()
  if(named AND report STREQUAL "")
    list(JOIN named ", " named)
    string(APPEND report "\n  ${named}: no lib/cmake/Kokkos/KokkosConfigCommon.cmake is there.")
  endif()
  set(${out} "" PARENT_SCOPE)
  set(${out}_report "${report}" PARENT_SCOPE)
endfunction()

if(CMAKE_SCRIPT_MODE_FILE STREQUAL CMAKE_CURRENT_LIST_FILE)
  if(prefix_of)
    ricochet_cached_kokkos(answer "${prefix_of}" "${compiler}")
  else()
    ricochet_find_kokkos(answer "${backend}" "${bounds_checks}" "${compiler}")
    if(answer_report)
      message("passed over:${answer_report}")
    endif()
  endif()
  execute_process(COMMAND "${CMAKE_COMMAND}" -E echo "${answer}")
endif()
