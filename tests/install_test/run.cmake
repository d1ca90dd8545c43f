# Installs ${build} into ${work}, builds and runs the consumer there, then moves
# the tree and runs the programs: they use what was installed alone. A
# tree in which nothing is built is refused.
# Usage: cmake -D source=... -D build=... -D work=... -D compiler=...
#   -D kernels=... -P run.cmake
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${work})
file(MAKE_DIRECTORY ${work})
file(REAL_PATH ${work} work)  # as programs name it
function(run)
  execute_process(COMMAND ${ARGV} COMMAND_ERROR_IS_FATAL ANY)
endfunction()
run(${CMAKE_COMMAND} --install ${build} --prefix ${work}/prefix)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G Ninja
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${compiler}
  -D CMAKE_PREFIX_PATH=${work}/prefix)
run(${CMAKE_COMMAND} --build ${work}/build)
run(${work}/build/consumer)

file(RENAME ${work}/prefix ${work}/moved)
set(bench ${work}/moved/bin/physinv-bench)
set(published ${work}/moved/share/physinv/published)
unset(ENV{PHYSINV_PUBLISHED_DIR})
run(${bench} --profile=smoke --filter=robotic-arm/bfgs --out=${work}/results)
run(${bench} report ${work}/results)
if(kernels)
  run(${bench} kernels --benchmark_list_tests)
endif()

# The sources are still there; a reader would notice nothing.
file(WRITE ${published}/jpo.json "{}")
execute_process(COMMAND ${bench} report ${work}/results
  RESULT_VARIABLE status ERROR_VARIABLE message)
string(FIND "${message}" ${published}/jpo.json place)
if(status EQUAL 0 OR place EQUAL -1)
  message(FATAL_ERROR "report does not read ${published}: ${message}")
endif()

set(empty ${work}/empty)
run(${CMAKE_COMMAND} -S ${source} -B ${empty} -G Ninja
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${compiler}
  -D PHYSINV_TESTS=OFF)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${empty} --prefix ${work}/no
  RESULT_VARIABLE status ERROR_VARIABLE message)
string(FIND "${message}" "Nothing is built yet" place)
if(status EQUAL 0 OR place EQUAL -1 OR EXISTS ${work}/no)
  message(FATAL_ERROR "an empty tree is installed: ${message}")
endif()
