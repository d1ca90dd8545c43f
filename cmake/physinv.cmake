# Programs are at the top of the build tree, where the launchers look.
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR})

find_program(PHYSINV_CCACHE ccache)
if(PHYSINV_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  # What ccache asks for where headers are precompiled; with comments, as the
  # compiler knows a precompiled header again by all of its bytes.
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env
    CCACHE_SLOPPINESS=pch_defines,time_macros CCACHE_COMMENTS=1
    ${CMAKE_CURRENT_LIST_DIR}/cached.sh ${PHYSINV_CCACHE})
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>)
endif()

# Flags every target shares. They change Eigen's alignment and the bits of the
# results, so they are part of the ABI and travel with the exported target.
# Bits are a property of the source: no -ffast-math, and products and sums fuse
# where the source says fma and nowhere else. Left to itself, GCC fuses
# a * b + c as inlining and vectorizing offer it, so that two copies of one
# template round differently and the linker takes whichever comes first.
add_library(physinv_flags INTERFACE)
#
# Registers of 256 bits (x86-64-v3) or of 512 (v4) or two of 128 (aarch64): what
# this machine has, as the bits are the same. Samples and columns are what fills a
# register, and sums have an order of their own, Eigen's too, which sees no
# registers at all.
set(PHYSINV_ARCH "" CACHE STRING
  "x86-64-v3, x86-64-v4 or aarch64; empty: the highest that this machine has")
set_property(CACHE PHYSINV_ARCH PROPERTY STRINGS "" x86-64-v3 x86-64-v4 aarch64)
include(processor)
physinv_find_processor(physinv_arch "${PHYSINV_ARCH}")
set(physinv_narrow_march x86-64-v3)
set(physinv_march ${physinv_arch})
if(physinv_arch STREQUAL aarch64)
  # Checksums by the processor: all but the first of them have crc.
  set(physinv_march armv8-a+crc)
  set(physinv_narrow_march ${physinv_march})
  # Else clang schedules for a core that runs in order, loads early and spills.
  set(physinv_tune -mtune=neoverse-n1)
  # GCC says of pairs of doubles that they were passed otherwise before GCC 10.
  add_compile_options($<$<CXX_COMPILER_ID:GNU>:-Wno-psabi>)
endif()
target_compile_options(physinv_flags INTERFACE -march=${physinv_march}
  ${physinv_tune})
set(physinv_two_widths OFF)
if(physinv_arch STREQUAL x86-64-v4)
  target_compile_definitions(physinv_flags INTERFACE PHYSINV_AVX512)
  # A test runs what computes numbers with either width (physinv_layer).
  if(PHYSINV_TESTS AND NOT PHYSINV_SANITIZE AND CMAKE_BUILD_TYPE STREQUAL Release)
    set(physinv_two_widths ON)
  endif()
endif()
add_library(physinv_flags_v3 INTERFACE)
target_compile_options(physinv_flags_v3 INTERFACE -march=${physinv_narrow_march})
foreach(flags physinv_flags physinv_flags_v3)
  target_compile_features(${flags} INTERFACE cxx_std_20)
  target_compile_options(${flags} INTERFACE -ffp-contract=off)
  target_compile_definitions(${flags} INTERFACE
    EIGEN_DONT_PARALLELIZE EIGEN_DONT_VECTORIZE EIGEN_MAX_ALIGN_BYTES=32)
endforeach()
# Words and records compute nothing, so they take no wide registers: a program
# whose numbers are from the build for AVX2 then runs under valgrind, which
# knows no AVX-512. Linked last, as the last -march counts.
add_library(physinv_narrow INTERFACE)
target_compile_options(physinv_narrow INTERFACE
  -march=${physinv_narrow_march} -UPHYSINV_AVX512)
# Nor do they take long optimizing. A header that is compiled with -O3 would
# bring -O3 along.
add_library(physinv_records INTERFACE)
target_compile_options(physinv_records INTERFACE $<$<CONFIG:Release>:-O1>)
# Designated initializers name what they set; the rest is default on purpose.
set(PHYSINV_WARNINGS -Wall -Wextra -Wshadow -Wno-missing-field-initializers)

# The compiler collects its garbage less often: a tenth of its time for a tenth
# more memory.
add_compile_options("$<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=400000 --param ggc-min-expand=200>")

if(PHYSINV_SANITIZE)
  add_compile_options(-fsanitize=${PHYSINV_SANITIZE}
    -fno-sanitize-recover=all -fno-omit-frame-pointer)
  if(PHYSINV_SANITIZE MATCHES undefined)
    # They take 40 % of the build; null pointers trap by themselves.
    add_compile_options(-fno-sanitize=null,alignment,vptr)
  endif()
  add_link_options(-fsanitize=${PHYSINV_SANITIZE})
endif()

# The archives also become part of shared objects (plug-ins load into a program,
# the Python module). No program replaces their functions, so calls stay
# direct: the same bits and the same speed as without.
add_compile_options(-fPIC -fno-semantic-interposition)

# What everybody includes is read once, and JSON is compiled once (physinv_json).
# The preset `clang` goes without all this, so that a missing #include cannot
# hide.
option(PHYSINV_PRECOMPILE "Precompiled headers, joined sources" ON)
function(physinv_precompile name flags)
  add_library(${name} OBJECT ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/precompiled.cpp)
  target_link_libraries(${name} PRIVATE ${flags} Eigen3::Eigen fmt::fmt)
  target_compile_options(${name} PRIVATE ${PHYSINV_WARNINGS})
  physinv_precompile_headers(${name} ${ARGN})
endfunction()
function(physinv_precompile_headers name)
  target_precompile_headers(${name} PRIVATE <Eigen/Core> <fmt/format.h>
    <algorithm> <functional> <map> <memory> <optional> <span> <string>
    <variant> <vector> ${ARGN})
endfunction()
if(PHYSINV_PRECOMPILE)
  add_library(physinv_json OBJECT ${CMAKE_CURRENT_LIST_DIR}/json_once.cpp)
  target_include_directories(physinv_json PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(physinv_json PRIVATE
    physinv_flags physinv_narrow physinv_records)
  physinv_precompile(physinv_precompiled physinv_flags)
  physinv_precompile(physinv_precompiled_records
    "physinv_flags;physinv_narrow;physinv_records"
    ${PROJECT_SOURCE_DIR}/cmake/json_once.h)
  if(physinv_two_widths)
    physinv_precompile(physinv_precompiled_v3 physinv_flags_v3)
    set_target_properties(physinv_precompiled_v3 PROPERTIES
      EXCLUDE_FROM_ALL ON)
  endif()
endif()

# physinv_join(<target> <mode> [<sources per compilation>]): for sources whose
# compilation is mostly headers. A name of an unnamed namespace then stands for
# one thing in the whole target. What a stage's numbers depend on is read from
# the #include lines source by source: the preset `clang` compiles each alone, so
# that none can lean on a neighbour's.
function(physinv_join name mode)
  if(PHYSINV_PRECOMPILE)
    set_target_properties(${name} PROPERTIES UNITY_BUILD ON
      UNITY_BUILD_MODE ${mode} UNITY_BUILD_BATCH_SIZE "${ARGN}")
    # A source's own types are in no header here either.
    target_compile_options(${name} PRIVATE
      $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
  endif()
endfunction()

# physinv_layer(<name> [OBJECT] [NUMBERS | RECORDS] [PRECOMPILE headers]
# SOURCES a.cpp "b.cpp c.cpp" ... DEPENDS ...): one target per layer. Sources
# between quotes are compiled as one; so a new one compiles no other batch again.
# OBJECT keeps the linker from dropping registrations that nothing uses. NUMBERS
# computes what is recorded: physinv_<name>_v3 is the same for AVX2, where that is
# another build. PRECOMPILE: headers of the project that nearly every source of
# the layer includes, or a layer that has them precompiled. RECORDS handles
# numbers and makes none: narrow, as it serves both widths, hardly optimized.
function(physinv_layer name)
  cmake_parse_arguments(ARG "OBJECT;NUMBERS;RECORDS"
    "" "SOURCES;DEPENDS;PRECOMPILE" ${ARGN})
  set(kind STATIC)
  if(ARG_OBJECT)
    set(kind OBJECT)
  endif()
  set(sources)
  set(batches 0)
  foreach(batch IN LISTS ARG_SOURCES)
    if(NOT IS_ABSOLUTE "${batch}")
      separate_arguments(batch UNIX_COMMAND "${batch}")
    endif()
    list(LENGTH batch count)
    if(count GREATER 1)
      set_source_files_properties(${batch} PROPERTIES UNITY_GROUP ${batches})
      math(EXPR batches "${batches} + 1")
    endif()
    list(APPEND sources ${batch})
  endforeach()
  add_library(physinv_${name} ${kind} ${sources})
  set_target_properties(physinv_${name} PROPERTIES EXPORT_NAME ${name})
  target_include_directories(physinv_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}>
    $<INSTALL_INTERFACE:include/physinv>)
  target_link_libraries(physinv_${name} PUBLIC physinv_flags ${ARG_DEPENDS})
  target_compile_options(physinv_${name} PRIVATE ${PHYSINV_WARNINGS})
  set(precompiled physinv_precompiled)
  if(ARG_RECORDS)
    set(precompiled physinv_precompiled_records)
    target_link_libraries(physinv_${name} PRIVATE
      $<BUILD_INTERFACE:physinv_narrow> $<BUILD_INTERFACE:physinv_records>)
  endif()
  if(PHYSINV_PRECOMPILE)
    target_link_libraries(physinv_${name} PRIVATE Eigen3::Eigen fmt::fmt)
    if(TARGET "${ARG_PRECOMPILE}")
      set(precompiled ${ARG_PRECOMPILE})
      set(ARG_PRECOMPILE)
    endif()
    if(ARG_PRECOMPILE)
      list(TRANSFORM ARG_PRECOMPILE PREPEND ${PROJECT_SOURCE_DIR}/)
      physinv_precompile_headers(physinv_${name} ${ARG_PRECOMPILE})
    else()
      target_precompile_headers(physinv_${name}
        REUSE_FROM ${precompiled})
    endif()
  endif()
  if(batches)
    physinv_join(physinv_${name} GROUP)
  endif()
  if(ARG_NUMBERS)
    set_property(GLOBAL APPEND PROPERTY physinv_numbers ${name})
  endif()
  if(ARG_NUMBERS AND physinv_two_widths)
    physinv_layer_v3(${name} ${kind} "${sources}" "${ARG_DEPENDS}")
    if(batches)
      physinv_join(physinv_${name}_v3 GROUP)
    endif()
  endif()
endfunction()

# Built on request.
function(physinv_layer_v3 name kind sources depends)
  list(FILTER depends EXCLUDE REGEX "^physinv_")
  add_library(physinv_${name}_v3 ${kind} EXCLUDE_FROM_ALL ${sources})
  target_include_directories(physinv_${name}_v3 PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(physinv_${name}_v3 PRIVATE
    physinv_flags_v3 Eigen3::Eigen fmt::fmt ${depends})
  target_compile_options(physinv_${name}_v3 PRIVATE ${PHYSINV_WARNINGS}
    -Wno-maybe-uninitialized)
  if(PHYSINV_PRECOMPILE)
    target_precompile_headers(physinv_${name}_v3
      REUSE_FROM physinv_precompiled_v3)
  endif()
endfunction()

# physinv_refuse_unlisted(<layer>...): every source in this folder is of one of
# these layers, but for kernels.cpp and the folder `libraries`.
function(physinv_refuse_unlisted)
  file(GLOB_RECURSE found CONFIGURE_DEPENDS
    RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  list(FILTER found EXCLUDE REGEX "(^|/)kernels\\.cpp$|^libraries/")
  foreach(layer IN LISTS ARGN)
    get_target_property(listed physinv_${layer} SOURCES)
    list(REMOVE_ITEM found ${listed})
  endforeach()
  if(found)
    list(JOIN found ", " found)
    message(FATAL_ERROR "${CMAKE_CURRENT_SOURCE_DIR}/CMakeLists.txt does not "
      "list ${found}; add it to the SOURCES of a layer")
  endif()
endfunction()

# physinv_layers(<name> <layer>...): one name for several, for targets that use
# them all.
function(physinv_layers name)
  add_library(physinv_${name} INTERFACE)
  set_target_properties(physinv_${name} PROPERTIES EXPORT_NAME ${name})
  list(TRANSFORM ARGN PREPEND physinv_)
  target_link_libraries(physinv_${name} INTERFACE ${ARGN})
endfunction()
