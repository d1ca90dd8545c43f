# What sources of experiments are by their names: the function on names of a
# tree that does not exist, and what it made of this one.
# Usage: cmake -D source=... -D numbers=... -P run.cmake
cmake_minimum_required(VERSION 3.25)
include(${source}/cmake/number_sources.cmake)
separate_arguments(numbers UNIX_COMMAND "${numbers}")

function(same what made expected)
  if(NOT "${made}" STREQUAL "${expected}")
    message(SEND_ERROR "${what}: '${made}' is not '${expected}'")
  endif()
endfunction()

# A new experiment, whose names are in no list.
set(new sip/new)
physinv_sort_sources(made
  ${new}/claims.cpp ${new}/drift.cpp ${new}/experiment.cpp ${new}/figures.cpp
  ${new}/grid_experiment.cpp ${new}/late_claims.cpp ${new}/late_metrics.cpp
  ${new}/metrics.cpp ${new}/experiments.cpp ${new}/disclaims.cpp)
same("numbers" "${made_numbers}" "${new}/drift.cpp;${new}/late_metrics.cpp;\
${new}/metrics.cpp;${new}/experiments.cpp;${new}/disclaims.cpp")
same("claims" "${made_claims}"
  "${new}/claims.cpp;${new}/figures.cpp;${new}/late_claims.cpp")
same("registrations" "${made_registrations}"
  "${new}/experiment.cpp;${new}/grid_experiment.cpp")

# Every source there is computes numbers, unless its name says otherwise.
file(GLOB sources RELATIVE ${source}/suite/cases
  ${source}/suite/cases/*/*/*.cpp)
list(FILTER sources EXCLUDE REGEX "/common/")
list(LENGTH sources count)
if(count LESS 80)
  message(SEND_ERROR "${count} sources in ${source}/suite/cases")
endif()
foreach(path IN LISTS sources)
  string(REGEX MATCH "(experiment|claims|figures|quantities)\\.cpp$" record "${path}")
  if(record)
    continue()
  endif()
  if(NOT path IN_LIST numbers)
    message(SEND_ERROR "${path} is compiled without the flags of numbers")
  endif()
endforeach()

# Numbers among what experiments share: nothing is configured.
execute_process(COMMAND ${CMAKE_COMMAND} -D source=${source}
  -P ${CMAKE_CURRENT_LIST_DIR}/common.cmake
  RESULT_VARIABLE status ERROR_VARIABLE message)
string(FIND "${message}" "sip/common/metrics.cpp: metrics compute numbers" at)
if(status EQUAL 0 OR at EQUAL -1)
  message(SEND_ERROR "metrics in common are taken: ${message}")
endif()
