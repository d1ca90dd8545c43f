# What physinv-sources makes of a little tree, and of edits to it.
# Usage: cmake -D source=... -D scanner=... -D work=... -P run.cmake
cmake_minimum_required(VERSION 3.25)
set(tree ${work}/tree)
file(REMOVE_RECURSE ${work})
file(WRITE ${work}/values.txt "compiler=GNU\nbit_flags=-O3 \"\\\n")
file(WRITE ${tree}/suite/harness/run_stage.cpp "int runs;\n")
file(WRITE ${tree}/suite/harness/run_stage.h "")
file(WRITE ${tree}/suite/core/rng.h "#include <cstdint>\n")
file(WRITE ${tree}/problems/heat/heat.h "#include \"suite/core/rng.h\"\n")
file(WRITE ${tree}/problems/heat/heat.cpp
  "#include \"problems/heat/heat.h\"\n  # include \"suite/core/rng.h\"\n")
file(WRITE ${tree}/problems/heat/kernels.cpp "")
file(WRITE ${tree}/suite/cases/heat/claims.cpp "int claims;\n")
file(WRITE ${tree}/reports/page.cpp "")

macro(make)
  execute_process(
    COMMAND ${scanner} --build-info ${tree} ${work}
    COMMAND_ERROR_IS_FATAL ANY)
  set(before_fingerprint ${fingerprint})
  set(before_foundation ${foundation})
  set(before_interfaces ${interfaces})
  file(READ ${work}/build_info.cpp made)
  foreach(name fingerprint foundation interfaces)
    string(REGEX MATCH "\\.${name} = \"([0-9a-f]+)\"" _ "${made}")
    set(${name} ${CMAKE_MATCH_1})
  endforeach()
endmacro()

function(same what a b)
  if(NOT "${a}" STREQUAL "${b}")
    message(SEND_ERROR "${what}: '${a}' is not '${b}'")
  endif()
endfunction()

function(differ what a b)
  if("${a}" STREQUAL "${b}")
    message(SEND_ERROR "${what}: both are '${a}'")
  endif()
endfunction()

# The hash of a source in the table, and what it includes.
function(entry path)
  string(REGEX MATCH "{\"${path}\", \"([0-9a-f]+)\",[ \n]+\"([^\"]*)\"}" _
    "${made}")
  set(hash "${CMAKE_MATCH_1}" PARENT_SCOPE)
  set(includes "${CMAKE_MATCH_2}" PARENT_SCOPE)
endfunction()

make()
string(FIND "${made}" "i.bit_flags = \"-O3 \\\"\\\\\";" at)
differ("values are texts of C++" "${at}" -1)
entry(problems/heat/heat.cpp)
same("both lines are read" "${includes}"
  "problems/heat/heat.h suite/core/rng.h ")
entry(suite/core/rng.h)
differ("it is in the table" "${hash}" "")
same("no header of a library counts" "${includes}" "")
entry(suite/cases/heat/claims.cpp)
set(claims "${hash}")
differ("cases are in the table" "${hash}" "")
foreach(path problems/heat/kernels.cpp reports/page.cpp
             suite/harness/run_stage.cpp)
  entry(${path})
  same("${path} is not" "${hash}" "")
endforeach()
file(READ ${work}/build_info.d dependencies)
foreach(path suite/core/rng.h suite/harness/run_stage.cpp problems problems/heat)
  string(FIND "${dependencies}" "${tree}/${path} " at)
  differ("${path} is watched" "${at}" -1)
endforeach()

file(TIMESTAMP ${work}/build_info.cpp first "%s")
execute_process(COMMAND ${CMAKE_COMMAND} -E sleep 1.1)
make()
file(TIMESTAMP ${work}/build_info.cpp second "%s")
same("unchanged sources leave the file" "${first}" "${second}")

# Comments and formatting change nothing.
file(WRITE ${tree}/problems/heat/heat.h
  "// which\n  #include /* why */ \"suite/core/rng.h\"  // generator\n\n")
file(WRITE ${tree}/suite/harness/run_stage.cpp "int /* what */\n  runs ;")
make()
file(TIMESTAMP ${work}/build_info.cpp second "%s")
same("edited comments leave it, too" "${first}" "${second}")

file(WRITE ${tree}/suite/cases/heat/claims.cpp "int other_claims;\n")
make()
entry(suite/cases/heat/claims.cpp)
differ("an edited case has another hash" "${hash}" "${claims}")
same("of the same build" "${fingerprint}" "${before_fingerprint}")

file(WRITE ${tree}/problems/heat/heat.h "constexpr int kConstant = 1;\n")
make()
differ("an edited problem is another build"
  "${fingerprint}" "${before_fingerprint}")
same("on the same foundation" "${foundation}" "${before_foundation}")

file(APPEND ${tree}/suite/harness/run_stage.cpp "int otherwise;\n")
make()
differ("what runs every stage is foundation"
  "${foundation}" "${before_foundation}")
file(APPEND ${work}/values.txt "bit_flags=-O2\n")
make()
differ("and so are flags" "${foundation}" "${before_foundation}")
file(APPEND ${work}/values.txt "instruction_set=x86-64-v4\n")
make()
same("registers are not" "${foundation}" "${before_foundation}")
file(APPEND ${work}/values.txt "compiler=Clang\n")
make()
same("nor is the compiler" "${foundation}" "${before_foundation}")
differ("a plug-in is built by the same" "${interfaces}"
  "${before_interfaces}")
file(WRITE ${tree}/suite/harness/case.h "struct WhatAPlugInSees;\n")
make()
differ("and with the same headers" "${interfaces}" "${before_interfaces}")
same("which are no numbers" "${fingerprint}" "${before_fingerprint}")
include(${work}/physinv-build.cmake)
same("programs outside know it" "${physinv_build}" "${interfaces}")
if(NOT "suite/core/rng.h" IN_LIST physinv_number_sources OR
   "suite/harness/case.h" IN_LIST physinv_number_sources)
  message(SEND_ERROR "sources of numbers: ${physinv_number_sources}")
endif()
