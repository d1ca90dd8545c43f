# A program names the revision that it was linked from, wherever the sources are
# by then; a commit compiles one source. Last the suite's own program. Usage:
# cmake -D source=... -D compiler=... -D work=... -D program=...
#   -D told=... -P run.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${work})
set(tree "${work}/a tree")
set(build ${work}/build)
file(WRITE ${tree}/CMakeLists.txt "
cmake_minimum_required(VERSION 3.25)
project(little LANGUAGES CXX)
include(${source}/cmake/revision.cmake)
add_executable(little main.cpp other.cpp)
target_include_directories(little PRIVATE ${source})
physinv_revision(little little \"\${CMAKE_SOURCE_DIR}\" \${CMAKE_BINARY_DIR})
")
file(WRITE ${tree}/main.cpp [[
#include <cstdio>

#include "suite/harness/revision.h"

bool physinv::register_revision(std::string_view name, std::string_view of) {
  return std::printf("%s %s", name.data(), of.data()) > 0;
}
int main() {}
]])
file(WRITE ${tree}/other.cpp "")
file(WRITE "${tree}/\$name #1.txt" "")
file(WRITE "${tree}/a name.txt" "one\n")

function(run)
  execute_process(COMMAND ${ARGN} OUTPUT_VARIABLE output
    OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
  set(output "${output}" PARENT_SCOPE)
endfunction()
macro(git)
  run(git -C ${tree} -c user.name=a -c user.email=a@b.c ${ARGN})
endmacro()
# How many sources it compiled.
macro(build)
  run(ninja -v -C ${build})
  string(REGEX MATCHALL " -c [^\n]*[.]cpp" compiled "${output}")
  list(LENGTH compiled compiled)
endmacro()
function(expect what is expected)
  if(NOT "${is}" STREQUAL "${expected}")
    message(SEND_ERROR "${what}: '${is}', not '${expected}'")
  endif()
endfunction()
macro(expect_revision what expected)
  run(${build}/little)
  expect("${what}" "${output}" "little ${expected}")
endmacro()

run(${CMAKE_COMMAND} -S ${tree} -B ${build} -G Ninja
  -D CMAKE_CXX_COMPILER=${compiler})
build()
expect_revision("sources that the repository around them does not have" unknown)

git(init -q)
git(add .)
git(commit -q -m One)
git(rev-parse HEAD)
set(first ${output})
build()
expect("the first commit compiles" ${compiled} 1)
expect_revision("the first commit" ${first})

file(WRITE "${tree}/a name.txt" "two\n")
git(commit -q -a -m Two)
git(rev-parse HEAD)
set(second ${output})
expect_revision("the tree moved, the program did not" ${first})
build()
expect("the second commit compiles" ${compiled} 1)
expect_revision("the second commit" ${second})
build()
string(FIND "${output}" "no work to do" at)
if(at EQUAL -1)
  message(SEND_ERROR "built again, though nothing changed:\n${output}")
endif()

file(WRITE "${tree}/a name.txt" "three\n")
build()
expect_revision("a tracked file differs" ${second}+dirty)
git(checkout -q --force ${first})
build()
expect_revision("back at the first" ${first})

# No program asks git.
run(${CMAKE_COMMAND} -E env PATH=/nowhere ${program} --profile=smoke --no-report
  --out=${work}/results)
file(READ ${work}/results/plan.json plan)
string(JSON revision GET "${plan}" context git_revision)
string(JSON dirty GET "${plan}" context git_dirty)
if(dirty)
  string(APPEND revision "+dirty")
endif()
file(READ ${told} text)
string(REGEX MATCH "\"\", \"([^\"]+)\"" _ "${text}")
expect("the suite's program" "${revision}" "${CMAKE_MATCH_1}")
