# Fails if a step of the engines takes more instructions than the same step by hand, and more than
# 5 % and one a disc: 5 % of the shortest step are less than one.
# Takes valgrind, program and scratch (a folder).
cmake_minimum_required(VERSION 3.22)
file(REMOVE_RECURSE "${scratch}")
file(MAKE_DIRECTORY "${scratch}")
execute_process(
  COMMAND "${valgrind}" --tool=callgrind --instr-atstart=no --combine-dumps=yes
    "--callgrind-out-file=${scratch}/counts" "${program}"
  RESULT_VARIABLE failed OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(failed)
  message(FATAL_ERROR "${program} under ${valgrind} failed (${failed}):\n${output}")
endif()

file(STRINGS "${scratch}/counts" lines REGEX "^(desc: Trigger: Client Request: |totals: )")
set(disc_steps 100000) # 20,000 discs, 5 steps
set(compared 0)
foreach(line IN LISTS lines)
  if(line MATCHES "^desc: Trigger: Client Request: (engine|by hand): (.*)")
    set(whose "${CMAKE_MATCH_1}")
    set(scene "${CMAKE_MATCH_2}")
  elseif(line MATCHES "^totals: ([0-9]+)")
    if(whose STREQUAL "engine")
      set(of_engine "${CMAKE_MATCH_1}")
    elseif(whose STREQUAL "by hand")
      math(EXPR most "${CMAKE_MATCH_1} + ${CMAKE_MATCH_1} / 20 + ${disc_steps}")
      math(EXPR per_mille "1000 * ${of_engine} / ${CMAKE_MATCH_1}")
      message(NOTICE "${scene}: ${of_engine} instructions, ${CMAKE_MATCH_1} by hand, ${per_mille} per mille")
      if(of_engine GREATER most)
        message(SEND_ERROR "${scene}: more than ${most}")
      endif()
      math(EXPR compared "${compared} + 1")
    endif()
    set(whose "")
  endif()
endforeach()
if(NOT compared EQUAL 8)
  message(FATAL_ERROR "${compared} scenes compared, not 8")
endif()
