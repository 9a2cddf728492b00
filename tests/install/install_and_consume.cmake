function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE failed)
  if(failed)
    list(JOIN ARGV " " command)
    message(FATAL_ERROR "failed (${failed}): ${command}")
  endif()
endfunction()

file(REMOVE_RECURSE "${scratch}/prefix" "${scratch}/consumer")
set(flags "")
if(sanitize)
  set(flags "-DCMAKE_CXX_FLAGS=-fsanitize=${sanitize}")
endif()
run("${CMAKE_COMMAND}" --install "${build}" --prefix "${scratch}/prefix" --config "${config}")
run("${CMAKE_COMMAND}" -G "${generator}" -S "${source}" -B "${scratch}/consumer"
    "-DCMAKE_BUILD_TYPE=${config}" "-DCMAKE_CXX_COMPILER=${compiler}"
    "-Dricochet_ROOT=${scratch}/prefix" ${flags})
run("${CMAKE_COMMAND}" --build "${scratch}/consumer" --config "${config}")
find_program(consumer consumer PATHS "${scratch}/consumer" "${scratch}/consumer/${config}"
             NO_DEFAULT_PATH REQUIRED)
run("${consumer}")
message(NOTICE "consumer finished")
