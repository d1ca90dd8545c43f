# physinv_find_library(<namespace>::<library> <header> [REQUIRED]): an imported
# target for a library whose Debian package has no CMake files.
function(physinv_find_library target header)
  string(REGEX REPLACE ".*::" "" name ${target})
  string(TOUPPER ${name} upper)
  find_path(${upper}_INCLUDE_DIR ${header} ${ARGN})
  find_library(${upper}_LIBRARY ${name} ${ARGN})
  mark_as_advanced(${upper}_INCLUDE_DIR ${upper}_LIBRARY)
  if(${upper}_INCLUDE_DIR AND ${upper}_LIBRARY AND NOT TARGET ${target})
    add_library(${target} UNKNOWN IMPORTED)
    set_target_properties(${target} PROPERTIES
      IMPORTED_LOCATION "${${upper}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${${upper}_INCLUDE_DIR}")
  endif()
endfunction()

# What every program of the suite takes of these.
macro(physinv_find_libraries)
  physinv_find_library(SLEEF::sleef sleef.h ${ARGN})
  find_package(re2 CONFIG QUIET)  # later packages have them
  if(NOT TARGET re2::re2)
    physinv_find_library(re2::re2 re2/re2.h ${ARGN})
  endif()
endmacro()
