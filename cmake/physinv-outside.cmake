# What find_package(physinv) gives in addition to its libraries (docs/extending.md):
#
#   physinv_add_program(<name> SOURCES <source>...)
#     a program with all verbs of physinv-bench over what SOURCES register
#   physinv_add_plugin(<name> SOURCES <source>...)
#     <name>.so, the same for physinv-bench --plugin=<name>.so
#   physinv_add_contract_tests(<name>)
#     <name>_contract_test, also a test of ctest: the suite's contract tests over
#     what SOURCES of a program or plug-in register
#
# SOURCES and the headers that they include enter the content keys: an edit makes
# stale what is computed from them, and nothing else.

include(${CMAKE_CURRENT_LIST_DIR}/revision.cmake)

# physinv_own_sources(<target> <plugin: true | false> <source>...)
function(physinv_own_sources target plugin)
  set(sources ${ARGN})
  list(FILTER sources EXCLUDE REGEX "^\\$<")
  list(TRANSFORM sources PREPEND "${CMAKE_CURRENT_SOURCE_DIR}/"
    REGEX "^[^/]")
  string(REGEX REPLACE "[^A-Za-z0-9_.-]" "_" project "${PROJECT_NAME}")
  set(info ${CMAKE_CURRENT_BINARY_DIR}/physinv_${target})
  file(GENERATE OUTPUT ${info}/values.cmake CONTENT
"set(target \"${target}\")
set(project \"${project}\")
set(plugin ${plugin})
set(root \"${PROJECT_SOURCE_DIR}\")
set(binary \"${PROJECT_BINARY_DIR}\")
set(headers \"${PHYSINV_HEADERS}\")
set(package \"${PHYSINV_PACKAGE}\")
set(data \"${PHYSINV_DATA}\")
set(sources \"${sources}\")
set(include_folders \"$<TARGET_PROPERTY:${target},INCLUDE_DIRECTORIES>\")
")
  add_custom_command(
    OUTPUT ${info}/sources.cpp
    DEPFILE ${info}/sources.d
    DEPENDS ${info}/values.cmake ${sources}
      ${PHYSINV_PACKAGE}/outside_sources.cmake
      ${PHYSINV_PACKAGE}/physinv-build.cmake
    COMMAND ${CMAKE_COMMAND} -D info=${info}
      -P ${PHYSINV_PACKAGE}/outside_sources.cmake
    COMMENT "Sources of ${target}"
    VERBATIM)
  target_sources(${target} PRIVATE ${info}/sources.cpp)
  physinv_revision(${target} ${target} ${PROJECT_SOURCE_DIR} ${info})
  # Designated initializers name what they set; the rest is default on purpose.
  target_compile_options(${target} PRIVATE -Wno-missing-field-initializers)
endfunction()

function(physinv_check_sources function target sources rest)
  if(NOT sources OR rest)
    message(FATAL_ERROR "${function}(${target} ${rest}): expected "
      "${function}(<name> SOURCES <source>...)")
  endif()
endfunction()

function(physinv_add_program name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES")
  physinv_check_sources(physinv_add_program ${name} "${ARG_SOURCES}"
    "${ARG_UNPARSED_ARGUMENTS}")
  add_executable(${name} ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES ENABLE_EXPORTS ON)
  physinv_own_sources(${name} false ${ARG_SOURCES})
  set_property(TARGET ${name} PROPERTY physinv_sources ${ARG_SOURCES})
  target_sources(${name} PRIVATE $<TARGET_OBJECTS:physinv::main>)
  target_link_libraries(${name} PRIVATE physinv::app physinv::physinv)
endfunction()

# The suite's functions are those of the program that loads it.
function(physinv_add_plugin name)
  cmake_parse_arguments(PARSE_ARGV 1 ARG "" "" "SOURCES")
  physinv_check_sources(physinv_add_plugin ${name} "${ARG_SOURCES}"
    "${ARG_UNPARSED_ARGUMENTS}")
  set(compiler "${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION}")
  include(${PHYSINV_PACKAGE}/physinv-build.cmake)
  if(NOT compiler STREQUAL physinv_compiler)
    message(FATAL_ERROR "physinv_add_plugin(${name}): the suite was built with "
      "${physinv_compiler}, this is ${compiler}; use the same for a plug-in")
  endif()
  add_library(${name} MODULE ${ARG_SOURCES})
  set_target_properties(${name} PROPERTIES PREFIX "")
  physinv_own_sources(${name} true ${ARG_SOURCES})
  set_property(TARGET ${name} PROPERTY physinv_sources ${ARG_SOURCES})
  target_include_directories(${name} SYSTEM PRIVATE ${PHYSINV_HEADERS})
  target_link_libraries(${name} PRIVATE physinv::flags Eigen3::Eigen
    SLEEF::sleef fmt::fmt nlohmann_json::nlohmann_json)
endfunction()

# Of the objects of the program or plug-in and with its libraries: what it says
# of itself is in one of its own.
function(physinv_add_contract_tests name)
  if(ARGN OR NOT TARGET ${name})
    message(FATAL_ERROR "physinv_add_contract_tests(${name} ${ARGN}): "
      "expected the name of a program or plug-in of physinv")
  endif()
  if(NOT TARGET physinv::contract)
    message(FATAL_ERROR "physinv_add_contract_tests(${name}): libgtest-dev is "
      "missing, or the suite was installed from a tree without contract tests; "
      "'./bench conformance --help' builds them there")
  endif()
  set(target ${name}_contract_test)
  get_target_property(sources ${name} physinv_sources)
  set(others ${sources})
  list(FILTER others INCLUDE REGEX "^\\$<")
  set(objects $<TARGET_OBJECTS:${name}>)
  set(of_its_own /physinv_${name}/[a-z]*.cpp)
  add_executable(${target} $<FILTER:${objects},EXCLUDE,${of_its_own}> ${others}
    $<TARGET_OBJECTS:physinv::conformance>)
  physinv_own_sources(${target} false ${sources})
  foreach(property INCLUDE_DIRECTORIES COMPILE_DEFINITIONS)
    set_property(TARGET ${target} PROPERTY ${property}
      $<TARGET_PROPERTY:${name},${property}>)
  endforeach()
  set(libraries $<TARGET_PROPERTY:${name},LINK_LIBRARIES>)
  target_link_libraries(${target} PRIVATE
    $<FILTER:${libraries},EXCLUDE,^physinv::>
    $<LINK_LIBRARY:WHOLE_ARCHIVE,physinv::contract>
    physinv::app_run physinv::physinv)
  add_test(NAME ${target} COMMAND ${target})
endfunction()
