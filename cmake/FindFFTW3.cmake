# FFTW3::fftw3 (double), FFTW3::fftw3f (float) and FFTW3_VERSION. Debian's
# package has no CMake files; the version stands in its pkg-config file.
find_path(FFTW3_INCLUDE_DIR fftw3.h)
find_library(FFTW3_LIBRARY fftw3)
find_library(FFTW3F_LIBRARY fftw3f)
mark_as_advanced(FFTW3_INCLUDE_DIR FFTW3_LIBRARY FFTW3F_LIBRARY)

get_filename_component(fftw3_lib_dir "${FFTW3_LIBRARY}" DIRECTORY)
if(EXISTS ${fftw3_lib_dir}/pkgconfig/fftw3.pc)
  file(STRINGS ${fftw3_lib_dir}/pkgconfig/fftw3.pc fftw3_line REGEX "^Version:")
  string(REGEX REPLACE "^Version: *" "" FFTW3_VERSION "${fftw3_line}")
endif()

include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(FFTW3
  REQUIRED_VARS FFTW3_LIBRARY FFTW3F_LIBRARY FFTW3_INCLUDE_DIR
  VERSION_VAR FFTW3_VERSION)

foreach(name fftw3 fftw3f)
  if(FFTW3_FOUND AND NOT TARGET FFTW3::${name})
    string(TOUPPER ${name} fftw3_upper)
    add_library(FFTW3::${name} UNKNOWN IMPORTED)
    set_target_properties(FFTW3::${name} PROPERTIES
      IMPORTED_LOCATION "${${fftw3_upper}_LIBRARY}"
      INTERFACE_INCLUDE_DIRECTORIES "${FFTW3_INCLUDE_DIR}")
  endif()
endforeach()
