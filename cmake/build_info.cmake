# physinv_build_info: what this build is made of (suite/harness/build_info.h),
# with hash and #include lines of every source that numbers can come from, read
# at build time by physinv-sources (sources.cpp). The file is rewritten only when
# its content changes, which comments and formatting do not.
# The bits of exp and sin are SLEEF's, whose version is in its header.
file(STRINGS ${SLEEF_INCLUDE_DIR}/sleef.h lines
  REGEX "^#define SLEEF_VERSION_(MAJOR|MINOR|PATCHLEVEL) ")
string(REGEX MATCHALL "[0-9]+" physinv_sleef "${lines}")
list(JOIN physinv_sleef "." physinv_sleef)
include(${CMAKE_CURRENT_LIST_DIR}/libc.cmake)
physinv_libc_version(physinv_libc)

string(TOUPPER ${CMAKE_BUILD_TYPE} physinv_config)
get_target_property(physinv_options physinv_flags INTERFACE_COMPILE_OPTIONS)
get_directory_property(physinv_directory_options COMPILE_OPTIONS)
list(JOIN physinv_options " " physinv_options)
list(JOIN physinv_directory_options " " physinv_directory_options)
string(CONCAT physinv_flags_text "${CMAKE_CXX_FLAGS} "
  "${CMAKE_CXX_FLAGS_${physinv_config}} ${physinv_options} "
  "${physinv_directory_options}")
# A directory's options may depend on the compiler: -fpch-preprocess, which is
# there with ccache alone. No result depends on it.
string(GENEX_STRIP "${physinv_flags_text}" physinv_flags_text)
string(REGEX REPLACE " +" " " physinv_flags_text "${physinv_flags_text}")
string(STRIP "${physinv_flags_text}" physinv_flags_text)
# Those that may decide about bits. Optimization, registers, sanitizers and the
# compiler itself do not (the tests of bits hold it), nor does where a cross
# compiler finds the other machine's libraries.
string(REGEX REPLACE
  "(^| )-(O[0-3]|g|DNDEBUG|m(arch|cpu|tune)=[^ ]*|-(target|sysroot)=[^ ]*|Wno-psabi|fpch-preprocess|fno-omit-frame-pointer|fPIC|fno-semantic-interposition|f(no-)?sanitize[^ ]*)" ""
  physinv_bit_flags "${physinv_flags_text}")
string(REGEX REPLACE " +" " " physinv_bit_flags "${physinv_bit_flags}")
string(STRIP "${physinv_bit_flags}" physinv_bit_flags)

set(physinv_info ${PROJECT_BINARY_DIR}/build_info)
file(CONFIGURE OUTPUT ${physinv_info}/values.txt @ONLY CONTENT
"compiler=@CMAKE_CXX_COMPILER_ID@
compiler_version=@CMAKE_CXX_COMPILER_VERSION@
flags=@physinv_flags_text@
bit_flags=@physinv_bit_flags@
build_type=@CMAKE_BUILD_TYPE@
instruction_set=@physinv_arch@
version=@PROJECT_VERSION@
eigen=@Eigen3_VERSION@
sleef=@physinv_sleef@
hdf5=@HDF5_VERSION@
json=@nlohmann_json_VERSION@
fmt=@fmt_VERSION@
cli11=@CLI11_VERSION@
libc=@physinv_libc@
")

add_executable(physinv-sources cmake/sources.cpp suite/core/hash.cpp)
target_include_directories(physinv-sources PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(physinv-sources PRIVATE fmt::fmt re2::re2)
add_custom_command(
  OUTPUT ${physinv_info}/build_info.cpp
  BYPRODUCTS ${physinv_info}/physinv-build.cmake
  DEPFILE ${physinv_info}/build_info.d
  DEPENDS physinv-sources ${physinv_info}/values.txt
  COMMAND physinv-sources --build-info ${PROJECT_SOURCE_DIR} ${physinv_info}
  COMMENT "Sources of the numerics"
  VERBATIM)
physinv_layer(build_info SOURCES ${physinv_info}/build_info.cpp)
