# RESULTS.md is what the command makes of the published campaigns.
execute_process(
  COMMAND ${bench} results --campaigns ${source}/reports/campaigns
    --out ${work}/RESULTS.md
  COMMAND_ERROR_IS_FATAL ANY)
file(READ ${work}/RESULTS.md made)
file(READ ${source}/RESULTS.md kept)
if(NOT made STREQUAL kept)
  message(FATAL_ERROR "RESULTS.md differs from what './bench results' makes of "
    "reports/campaigns: ${work}/RESULTS.md")
endif()
