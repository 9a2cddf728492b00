# Warnings for our own code; Kokkos and other libraries are included as system headers.
# ricochet_warnings(target): -Wall -Wextra and what has paid in numerical code besides.
function(ricochet_warnings target)
  set(both
    -Wall -Wextra -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual -Wformat=2 -Wcast-align
    -Wfloat-conversion)   # double to float unasked: the single precision engines round where they say
  set(gnu
    -Wdouble-promotion    # and float to double: they compute in float (clang warns of conversions asked for too)
    -Wduplicated-cond -Wduplicated-branches -Wlogical-op)
  if(NOT "CUDA" IN_LIST Kokkos_DEVICES)
    list(APPEND both -Wmissing-declarations -Wextra-semi) # not true of what nvcc makes of the source
  endif()
  if(ricochet_WARNINGS_AS_ERRORS)
    list(APPEND both -Werror)
  endif()
  target_compile_options(${target} PRIVATE
    "$<$<COMPILE_LANG_AND_ID:CXX,GNU,Clang,AppleClang,IntelLLVM>:${both}>"
    "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:${gnu}>")
endfunction()
