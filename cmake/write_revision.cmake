# Writes ${folder}/revision.cpp, which has the revision of the sources in
# ${root} under ${name}, and revision.d naming what it depends on: git's present
# commit, and every tracked file.
cmake_minimum_required(VERSION 3.25)

# Output of git, nothing if it fails or is not there.
function(physinv_git result)
  execute_process(COMMAND git -C ${root} -c core.quotepath=off ${ARGN}
    OUTPUT_VARIABLE text OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
    RESULT_VARIABLE status)
  if(NOT status EQUAL 0)
    set(text)
  endif()
  set(${result} "${text}" PARENT_SCOPE)
endfunction()

# An unpacked archive may lie in somebody's repository, which is not its own.
physinv_git(tracked ls-files)
set(revision)
if(tracked)
  physinv_git(revision describe --always --dirty=+dirty --abbrev=40 --exclude=*)
endif()

if(revision)
  physinv_git(branch symbolic-ref -q HEAD)
  set(places HEAD logs/HEAD packed-refs ${branch})
  list(TRANSFORM places PREPEND "--git-path;")
  physinv_git(places rev-parse --path-format=absolute ${places})
  string(REPLACE "\n" ";" places "${places}")
  set(files)
  foreach(place IN LISTS places)
    if(EXISTS ${place})
      string(APPEND files "${place}\n")
    endif()
  endforeach()
  # Names that git quotes, or with a $ or #, come through no depfile.
  string(REGEX REPLACE "\n[^\n]*[\"$#][^\n]*" "" tracked "\n${tracked}")
  string(REPLACE "\n" "\n${root}/" tracked "${tracked}")
  string(APPEND files "${tracked}")
else()
  set(revision unknown)
  set(files ${root})  # where a repository would appear
endif()
string(REPLACE " " "\\ " files "${files}")
string(REGEX REPLACE "\n+" " \\\\\n  " files "${files}")
file(WRITE ${folder}/revision.d "${folder}/revision.cpp: ${files}\n")

file(CONFIGURE OUTPUT ${folder}/revision.cpp @ONLY CONTENT [[
#include "suite/harness/revision.h"

namespace {
const bool kTold = physinv::register_revision("@name@", "@revision@");
}
]])
