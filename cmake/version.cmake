# The header ricochet/version.hpp: version of the project and state of its source at *build* time.
#   target_link_libraries(mine PRIVATE ricochet_version)
# It is looked at in every build and rewritten only when it changes, so that a commit recompiles the
# files that include it and no others.
if(NOT CMAKE_SCRIPT_MODE_FILE)
  find_package(Git QUIET)
  set(ricochet_version_header "${PROJECT_BINARY_DIR}/generated/ricochet/version.hpp")
  add_custom_target(ricochet_version_header
    BYPRODUCTS "${ricochet_version_header}"
    COMMAND "${CMAKE_COMMAND}" "-Dheader=${ricochet_version_header}" "-Dsource=${PROJECT_SOURCE_DIR}"
            "-Dversion=${PROJECT_VERSION}" "-Dgit=${GIT_EXECUTABLE}" -P "${CMAKE_CURRENT_LIST_FILE}"
    COMMENT "" VERBATIM)
  add_library(ricochet_version INTERFACE)
  target_include_directories(ricochet_version INTERFACE "${PROJECT_BINARY_DIR}/generated")
  add_dependencies(ricochet_version ricochet_version_header)
  return()
endif()

# From here on: the script that the target above runs.
set(state "unknown")
if(git)
  # A source folder unpacked inside somebody else's repository must not take that one's commit.
  execute_process(COMMAND "${git}" -C "${source}" rev-parse --show-toplevel
                  OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  file(REAL_PATH "${source}" source)
  if(top)
    file(REAL_PATH "${top}" top)
  endif()
  if(top STREQUAL source)
    execute_process(
      COMMAND "${git}" --no-optional-locks -C "${source}" describe --always --dirty --abbrev=12
      OUTPUT_VARIABLE described OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
    if(NOT failed AND described)
      set(state "${described}")
    endif()
  endif()
endif()
set(text "// Written by the build.
#pragma once

namespace ricochet {

/// Version of the project.
inline constexpr char version[] = \"${version}\";

/// `git describe --always --dirty` of the source this was built from, or \"unknown\".
inline constexpr char git_state[] = \"${state}\";

} // namespace ricochet
")
set(old "")
if(EXISTS "${header}")
  file(READ "${header}" old)
endif()
if(NOT text STREQUAL old)
  file(WRITE "${header}" "${text}")
endif()
