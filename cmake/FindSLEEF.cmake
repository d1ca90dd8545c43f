# SLEEF::sleef and SLEEF_VERSION. Debian's package has no CMake files; the
# version stands in the header.
find_path(SLEEF_INCLUDE_DIR sleef.h)
find_library(SLEEF_LIBRARY sleef)
mark_as_advanced(SLEEF_INCLUDE_DIR SLEEF_LIBRARY)

if(SLEEF_INCLUDE_DIR)
  set(SLEEF_VERSION)
  foreach(part MAJOR MINOR PATCHLEVEL)
    file(STRINGS ${SLEEF_INCLUDE_DIR}/sleef.h sleef_line
      REGEX "^#define SLEEF_VERSION_${part} ")
    string(REGEX REPLACE "[^0-9]+" "" sleef_line "${sleef_line}")
    list(APPEND SLEEF_VERSION ${sleef_line})
  endforeach()
  list(JOIN SLEEF_VERSION "." SLEEF_VERSION)
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(SLEEF
  REQUIRED_VARS SLEEF_LIBRARY SLEEF_INCLUDE_DIR
  VERSION_VAR SLEEF_VERSION)

if(SLEEF_FOUND AND NOT TARGET SLEEF::sleef)
  add_library(SLEEF::sleef UNKNOWN IMPORTED)
  set_target_properties(SLEEF::sleef PROPERTIES
    IMPORTED_LOCATION "${SLEEF_LIBRARY}"
    INTERFACE_INCLUDE_DIRECTORIES "${SLEEF_INCLUDE_DIR}")
endif()
