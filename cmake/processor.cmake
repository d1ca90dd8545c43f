# physinv_find_processor(<result> <chosen>): <chosen>, if the processor that
# programs are built for has such an instruction set; if empty, the widest that
# this machine has. Or an error that says what is missing.
function(physinv_find_processor result chosen)
  if(CMAKE_SYSTEM_PROCESSOR STREQUAL aarch64)
    set(sets aarch64)
  elseif(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64)$")
    set(sets x86-64-v3 x86-64-v4)
  else()
    message(FATAL_ERROR "${CMAKE_SYSTEM_PROCESSOR} is not supported (x86-64 with "
      "AVX2 and aarch64 are): the bits need SLEEF's functions, which Debian 12 "
      "lacks for riscv64, and Random123's 64-bit Philox, which needs 128-bit "
      "integers.")
  endif()
  if(chosen AND NOT chosen IN_LIST sets)
    list(JOIN sets " and " sets)
    message(FATAL_ERROR "PHYSINV_ARCH is ${chosen}; "
      "${CMAKE_SYSTEM_PROCESSOR} has ${sets}.")
  endif()
  if(NOT chosen)
    physinv_widest(chosen ${sets})
  endif()
  set(${result} ${chosen} PARENT_SCOPE)
endfunction()

# The last of these that this machine has.
function(physinv_widest result)
  list(POP_BACK ARGN widest)
  if(widest STREQUAL x86-64-v4 AND EXISTS /proc/cpuinfo)
    file(STRINGS /proc/cpuinfo flags REGEX "^flags" LIMIT_COUNT 1)
    foreach(feature avx512f avx512bw avx512cd avx512dq avx512vl)
      if(NOT "${flags} " MATCHES " ${feature} ")
        set(widest x86-64-v3)
      endif()
    endforeach()
    if(NOT "${flags} " MATCHES " avx2 ")
      message(FATAL_ERROR "This processor lacks AVX2 (x86-64-v3).")
    endif()
  elseif(widest STREQUAL x86-64-v4)
    set(widest x86-64-v3)
  endif()
  set(${result} ${widest} PARENT_SCOPE)
endfunction()
