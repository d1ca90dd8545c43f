# RESULTS.md and docs/results are what one command makes of the published
# campaigns.
set(LINES 120)
file(REMOVE_RECURSE ${work}/made)
file(COPY ${source}/reports/campaigns DESTINATION ${work}/made/reports)
execute_process(
  COMMAND ${bench} results
  WORKING_DIRECTORY ${work}/made
  COMMAND_ERROR_IS_FATAL ANY)

function(pages tree out)
  file(GLOB found RELATIVE ${tree} ${tree}/RESULTS.md ${tree}/docs/results/*)
  set(${out} "${found}" PARENT_SCOPE)
endfunction()
pages(${work}/made made)
pages(${source} kept)
if(NOT made STREQUAL kept)
  message(FATAL_ERROR "'./bench results' makes other pages than are there:\n"
    "${made}\nare made,\n${kept}\nare there")
endif()
foreach(page ${made})
  file(READ ${work}/made/${page} new)
  file(READ ${source}/${page} old)
  if(NOT new STREQUAL old)
    message(FATAL_ERROR "${page} differs from what './bench results' makes of "
      "reports/campaigns: ${work}/made/${page}")
  endif()
endforeach()

file(READ ${work}/made/RESULTS.md page)
string(REGEX MATCHALL "\n" ends "${page}")
list(LENGTH ends lines)
if(lines GREATER LINES)
  message(FATAL_ERROR "RESULTS.md has ${lines} lines, of ${LINES}")
endif()

# A page that the command did not write is not replaced.
file(WRITE ${work}/made/docs/results/jpo-billiards.md "notes of mine\n")
execute_process(
  COMMAND ${bench} results
  WORKING_DIRECTORY ${work}/made
  RESULT_VARIABLE code ERROR_VARIABLE error)
file(READ ${work}/made/docs/results/jpo-billiards.md notes)
if(NOT code EQUAL 9 OR NOT notes STREQUAL "notes of mine\n"
   OR NOT error MATCHES "docs/results/jpo-billiards.md is not a page written by")
  message(FATAL_ERROR "a page of the user's: exit ${code}, ${error}")
endif()
