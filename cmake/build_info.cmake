# physinv_build_info: what this build is made of (suite/harness/build_info.h),
# with hash and #include lines of every source that numbers can come from, read
# at build time by physinv-sources. The file is rewritten only when its content
# changes, which comments and formatting do not.
# The bits of exp and sin are SLEEF's, whose version stands in its header.
set(physinv_sleef)
foreach(part MAJOR MINOR PATCHLEVEL)
  file(STRINGS ${SLEEF_INCLUDE_DIR}/sleef.h line
    REGEX "^#define SLEEF_VERSION_${part} ")
  string(REGEX REPLACE "[^0-9]+" "" line "${line}")
  list(APPEND physinv_sleef ${line})
endforeach()
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
# A directory's options may hang on the compiler: -fpch-preprocess, which is
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
file(CONFIGURE OUTPUT ${physinv_info}/values.cmake @ONLY CONTENT [[
set(compiler "@CMAKE_CXX_COMPILER_ID@")
set(compiler_version "@CMAKE_CXX_COMPILER_VERSION@")
set(flags "@physinv_flags_text@")
set(bit_flags "@physinv_bit_flags@")
set(build_type "@CMAKE_BUILD_TYPE@")
set(instruction_set "@physinv_arch@")
set(version "@PROJECT_VERSION@")
set(eigen "@Eigen3_VERSION@")
set(sleef "@physinv_sleef@")
set(hdf5 "@HDF5_VERSION@")
set(json "@nlohmann_json_VERSION@")
set(fmt "@fmt_VERSION@")
set(cli11 "@CLI11_VERSION@")
set(libc "@physinv_libc@")
set(emulator "@CMAKE_CROSSCOMPILING_EMULATOR@")
]])

add_executable(physinv-sources cmake/sources.cpp suite/core/hash.cpp)
target_include_directories(physinv-sources PRIVATE ${PROJECT_SOURCE_DIR})
target_link_libraries(physinv-sources PRIVATE fmt::fmt)

add_custom_command(
  OUTPUT ${physinv_info}/build_info.cpp
  BYPRODUCTS ${physinv_info}/physinv-build.cmake
  DEPFILE ${physinv_info}/build_info.d
  DEPENDS physinv-sources ${physinv_info}/values.cmake
    ${CMAKE_CURRENT_LIST_DIR}/write_build_info.cmake
  COMMAND ${CMAKE_COMMAND} -D source_dir=${PROJECT_SOURCE_DIR}
    -D info=${physinv_info} -D scanner=$<TARGET_FILE:physinv-sources>
    -P ${CMAKE_CURRENT_LIST_DIR}/write_build_info.cmake
  COMMENT "Sources of the numerics"
  VERBATIM)
physinv_layer(build_info SOURCES ${physinv_info}/build_info.cpp)
