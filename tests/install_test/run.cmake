# Installs ${build} into ${work}, builds and runs the consumer there, then moves
# the tree and runs the programs: they use what was installed alone. Then the
# same of a tree in which ./bench built nothing but physinv-run.
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

# The sources are still there; whoever read them would notice nothing.
file(WRITE ${published}/jpo.json "{}")
execute_process(COMMAND ${bench} report ${work}/results
  RESULT_VARIABLE status ERROR_VARIABLE message)
string(FIND "${message}" ${published}/jpo.json place)
if(status EQUAL 0 OR place EQUAL -1)
  message(FATAL_ERROR "report does not read ${published}: ${message}")
endif()

set(alone ${work}/alone)
run(${CMAKE_COMMAND} -S ${source} -B ${alone} -G Ninja
  -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${compiler}
  -D PHYSINV_TESTS=OFF)
execute_process(COMMAND ${CMAKE_COMMAND} --install ${alone} --prefix ${work}/no
  RESULT_VARIABLE status ERROR_VARIABLE message)
string(FIND "${message}" "Nothing is built yet" place)
if(status EQUAL 0 OR place EQUAL -1 OR EXISTS ${work}/no)
  message(FATAL_ERROR "an empty tree is installed: ${message}")
endif()
execute_process(COMMAND ninja -C ${alone} -t inputs physinv-run
  OUTPUT_VARIABLE inputs COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL
  "[^\n ]*(libphysinv_[^\n ]*[.]a|physinv_main[^\n ]*[.]o)" libraries "${inputs}")
foreach(path physinv-run physinv-sources build_info/physinv-build.cmake ${libraries})
  cmake_path(GET path PARENT_PATH folder)
  file(COPY ${build}/${path} DESTINATION ${alone}/${folder})
endforeach()
run(${CMAKE_COMMAND} --install ${alone} --prefix ${work}/runs
  --component programs)
if(EXISTS ${work}/runs/include OR EXISTS ${work}/runs/bin/physinv-bench)
  message(FATAL_ERROR "the programs are more than was built")
endif()
run(${CMAKE_COMMAND} --install ${alone} --prefix ${work}/runs)
run(${work}/runs/bin/physinv-run --profile=smoke --filter=robotic-arm/bfgs
  --out=${work}/runs/results)
run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build_of_runs
  -G Ninja -D CMAKE_BUILD_TYPE=Release -D CMAKE_CXX_COMPILER=${compiler}
  -D CMAKE_PREFIX_PATH=${work}/runs)
run(${CMAKE_COMMAND} --build ${work}/build_of_runs)
run(${work}/build_of_runs/consumer)
