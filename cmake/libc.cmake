# physinv_libc_version(RESULT): "glibc 2.36" as the headers state it that the
# compiler sees, for a key that is the same from a cross compiler; what getconf
# says is of the machine that builds. Empty for another C library.
function(physinv_libc_version result)
  set(source ${CMAKE_CURRENT_BINARY_DIR}/build_info/libc.cpp)
  file(WRITE ${source}
    "#include <features.h>\nlibc __GLIBC__ __GLIBC_MINOR__\n")
  separate_arguments(flags UNIX_COMMAND "${CMAKE_CXX_FLAGS}")
  if(CMAKE_SYSROOT)
    list(APPEND flags --sysroot=${CMAKE_SYSROOT})
  endif()
  if(CMAKE_CXX_COMPILER_TARGET AND CMAKE_CXX_COMPILER_ID MATCHES Clang)
    list(APPEND flags --target=${CMAKE_CXX_COMPILER_TARGET})
  endif()
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} ${flags} -E -P ${source}
    OUTPUT_VARIABLE text ERROR_QUIET)
  string(REGEX MATCH "libc ([0-9]+) ([0-9]+)" found "${text}")
  set(version "")
  if(found)
    set(version "glibc ${CMAKE_MATCH_1}.${CMAKE_MATCH_2}")
  endif()
  set(${result} "${version}" PARENT_SCOPE)
endfunction()
