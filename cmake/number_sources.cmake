# physinv_sort_sources(<prefix> <sources>): what the sources of experiments are,
# by their names. experiment.cpp and ..._experiment.cpp register
# (<prefix>_registrations), claims.cpp, figures.cpp and quantities.cpp, or
# ..._claims.cpp and so on, state and draw what was recorded (<prefix>_claims).
# Every other one computes numbers (<prefix>_numbers).
function(physinv_sort_sources prefix)
  foreach(kind numbers claims registrations)
    set(${kind} ${ARGN})
  endforeach()
  list(FILTER numbers EXCLUDE REGEX "[/_](experiment|claims|figures|quantities)\\.cpp$")
  list(FILTER claims INCLUDE REGEX "[/_](claims|figures|quantities)\\.cpp$")
  list(FILTER registrations INCLUDE REGEX "[/_]experiment\\.cpp$")
  foreach(kind numbers claims registrations)
    set(${prefix}_${kind} ${${kind}} PARENT_SCOPE)
  endforeach()
endfunction()

# What the experiments of one paper share states and draws, too.
function(physinv_refuse_numbers)
  set(metrics ${ARGN})
  list(FILTER metrics INCLUDE REGEX "[/_]metrics\\.cpp$")
  if(metrics)
    message(FATAL_ERROR "${metrics}: metrics compute numbers, so they must be in the "
      "folder of an experiment, not in the folder shared by a paper")
  endif()
endfunction()
