# The launchers on a little project, by its path and through a symbolic link: one
# build serves both.
# Usage: cmake -D source=... -D compiler=... -D work=... -P run.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work}/checkout/cmake)
file(REAL_PATH ${work}/checkout checkout)
file(COPY ${source}/bench ${source}/check ${source}/CMakePresets.json
  DESTINATION ${checkout})
file(COPY ${source}/cmake/launcher.sh ${source}/cmake/folder_of.sh
  ${source}/cmake/plugin_of.sh DESTINATION ${checkout}/cmake)
file(COPY ${source}/suite/cases/common/experiments.def
  DESTINATION ${checkout}/suite/cases/common)
file(WRITE ${checkout}/apt-packages.txt "[bench]\n[test]\n[dev]\n[libraries]\n")
file(WRITE ${checkout}/main.cpp "int main() {}\n")
file(WRITE ${checkout}/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(little LANGUAGES CXX)
add_executable(physinv-jpo-billiards ${CMAKE_SOURCE_DIR}/main.cpp)
add_executable(physinv-bench ${CMAKE_SOURCE_DIR}/main.cpp)
if(PHYSINV_TESTS)
  enable_testing()
  add_test(NAME where COMMAND ${CMAKE_COMMAND} -E echo at ${CMAKE_BINARY_DIR})
endif()
]])
file(WRITE ${checkout}/baselines/libraries/CMakeLists.txt [[
cmake_minimum_required(VERSION 3.25)
project(libraries LANGUAGES CXX)
add_library(libraries MODULE ${CMAKE_SOURCE_DIR}/../../main.cpp)
file(WRITE ${CMAKE_SOURCE_DIR}/../../build/compiler ${CMAKE_CXX_COMPILER})
set_target_properties(libraries PROPERTIES PREFIX "")
]])
file(CREATE_LINK ${checkout} ${work}/link SYMBOLIC)

# The launcher, run in a folder as a shell would.
function(launch folder)
  list(JOIN ARGN " " command)
  execute_process(
    COMMAND bash -c "cd '${folder}' && CXX='${compiler}' ./${command} 2>&1"
    OUTPUT_VARIABLE output RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${command} in ${folder}: ${status}\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

set(program ${checkout}/build/release/physinv-jpo-billiards)
macro(expect_one_build how)
  string(FIND "${output}" "building" at)
  if(NOT at EQUAL -1)
    message(SEND_ERROR "${how}: built again\n${output}")
  endif()
endmacro()

launch(${checkout} bench --filter=billiards)
if(NOT EXISTS ${program})
  message(FATAL_ERROR "no ${program}")
endif()
if(EXISTS ${checkout}/build/release/physinv-bench)
  message(SEND_ERROR "a run of billiards builds all experiments")
endif()
launch(${checkout} bench run)
if(NOT EXISTS ${checkout}/build/release/physinv-bench)
  message(SEND_ERROR "a run of all does not build all")
endif()
launch(${work}/link bench run)
expect_one_build("the link after the path")
# Its plug-in is built for a filter of experiments that it has alone.
set(plugin ${checkout}/build/release/libraries.so)
if(EXISTS ${plugin})
  message(SEND_ERROR "a run of all builds the plug-in of other libraries")
endif()
launch(${checkout} bench "'--filter=^libraries/'")
if(NOT EXISTS ${plugin})
  message(SEND_ERROR "a run of other libraries does not build their plug-in")
endif()
launch(${work}/link bench --filter=libraries)
expect_one_build("other libraries, through the link")
# By the compiler of the suite, whatever the environment names now and another
# one has left.
file(WRITE ${work}/another "#!/bin/sh\nexec '${compiler}' \"$@\"\n")
file(CHMOD ${work}/another PERMISSIONS OWNER_READ OWNER_EXECUTE)
file(REMOVE_RECURSE ${plugin} ${checkout}/build/release/plugins)
execute_process(COMMAND ${CMAKE_COMMAND} -S ${checkout}/baselines/libraries
  -B ${checkout}/build/release/plugins/libraries -G Ninja
  -DCMAKE_CXX_COMPILER=${work}/another OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND bash -c
  "cd '${checkout}' && CXX='${work}/another' ./bench --filter=^studies/whose-bfgs")
file(READ ${checkout}/build/compiler used)
if(NOT EXISTS ${plugin} OR NOT used STREQUAL compiler)
  message(SEND_ERROR "the plug-in is built by ${used}, not by ${compiler}")
endif()
launch(${work}/link check -V)  # configures again, with tests
expect_one_build("tests through the link")
string(FIND "${output}" "at ${checkout}/build/release" at)
if(at EQUAL -1)
  message(SEND_ERROR "tests see the link's path:\n${output}")
endif()
launch(${checkout} check)
expect_one_build("tests by the path")

# What nothing changed starts no ninja; an edit, a new file, another revision, a
# tree configured again and a lost program each do.
file(WRITE ${work}/no_ninja/ninja "#!/bin/sh\necho asked\nexit 1\n")
file(CHMOD ${work}/no_ninja/ninja PERMISSIONS OWNER_READ OWNER_EXECUTE)
function(expect_ninja asked what)
  execute_process(COMMAND bash -c
    "cd '${work}/link' && PATH='${work}/no_ninja':$PATH ./bench run 2>&1"
    OUTPUT_VARIABLE output RESULT_VARIABLE status)
  set(expected 0)
  if(asked)
    set(expected 9)
  endif()
  if(NOT status EQUAL expected)
    message(SEND_ERROR "${what}: ${status}, not ${expected}\n${output}")
  endif()
  if(asked)
    launch(${checkout} bench run)
  endif()
endfunction()
if(EXISTS /var/lib/dpkg/status)
  file(MAKE_DIRECTORY ${checkout}/.git/logs)
  launch(${checkout} bench run)
  expect_ninja(NO "nothing changed")
  file(MAKE_DIRECTORY ${checkout}/results/quick)
  launch(${checkout} bench run)
  file(WRITE ${checkout}/results/quick/results.json "")
  expect_ninja(NO "results")
  file(TOUCH ${checkout}/main.cpp)
  expect_ninja(YES "an edit")
  file(WRITE ${checkout}/cmake/new.cmake "")
  expect_ninja(YES "a new file")
  file(WRITE ${checkout}/.git/HEAD "")
  expect_ninja(YES "another revision")
  file(TOUCH ${checkout}/build/release/build.ninja)
  expect_ninja(YES "a tree configured anew")
  file(REMOVE ${checkout}/build/release/physinv-bench)
  expect_ninja(YES "a lost program")
  expect_ninja(NO "the last build is noted")
endif()

# On ARM the program is built by clang, and by GCC elsewhere.
foreach(processor aarch64 x86_64)
  execute_process(
    COMMAND bash -c "HOSTTYPE=${processor} root='${checkout}'
      source '${source}/cmake/launcher.sh'
      packages_of bench; echo \"\${packages[*]}\""
    OUTPUT_VARIABLE ${processor} OUTPUT_STRIP_TRAILING_WHITESPACE)
endforeach()
if(NOT aarch64 STREQUAL clang OR NOT x86_64 STREQUAL "")
  message(SEND_ERROR
    "packages of [bench]: '${aarch64}' on ARM, '${x86_64}' elsewhere")
endif()

# The libraries for ARM are unpacked by users other than root, too, and where nothing
# was installed before.
file(WRITE ${work}/fake/mmdebstrap "#!/bin/sh\necho \"fake $@\"\nexit 1\n")
file(CHMOD ${work}/fake/mmdebstrap PERMISSIONS OWNER_READ OWNER_EXECUTE)
execute_process(
  COMMAND bash -c "cd '${checkout}' && PATH='${work}/fake':$PATH ./check --arm64"
  ERROR_VARIABLE said RESULT_VARIABLE status)
if(NOT status EQUAL 9 OR NOT said MATCHES "fake --mode=chrootless .*cannot unpack the libraries")
  message(SEND_ERROR "unpacking for ARM: ${status}\n${said}")
endif()

# Sets of another processor, and processors without any, end in words.
function(expect_processor processor chosen words)
  file(WRITE ${work}/processor.cmake "cmake_minimum_required(VERSION 3.25)
    include(${source}/cmake/processor.cmake)
    physinv_find_processor(found \"${chosen}\")
    message(NOTICE \"it is \${found}\")")
  execute_process(ERROR_VARIABLE said COMMAND ${CMAKE_COMMAND}
    -D CMAKE_SYSTEM_PROCESSOR=${processor} -P ${work}/processor.cmake)
  string(REGEX REPLACE "[ \n]+" " " said "${said}")
  if(NOT said MATCHES "${words}")
    message(SEND_ERROR "'${chosen}' on ${processor}: ${said}")
  endif()
endfunction()
expect_processor(aarch64 "" "^it is aarch64")
expect_processor(aarch64 x86-64-v3 "PHYSINV_ARCH is x86-64-v3.*aarch64 has aarch64")
expect_processor(x86_64 x86-64-v4 "^it is x86-64-v4")
expect_processor(x86_64 aarch64 "PHYSINV_ARCH is aarch64")
expect_processor(riscv64 x86-64-v3 "riscv64.*SLEEF")
