# Writes ${output}: what folders of suite/cases add to the registry, each by a
# function that stands in a table, folders() of suite/cases/common/folders.h, and
# register_all over that table, for a program over these folders. The names of
# the experiments of all other folders (experiments.txt) are named as elsewhere.
# Usage: cmake -D cases=suite/cases -D folders=jpo/billiards -D output=... -P ...
cmake_minimum_required(VERSION 3.25)
set(declared)
set(functions)
set(table)
set(elsewhere)
file(STRINGS ${cases}/experiments.txt rows REGEX "^[^#]")
foreach(row IN LISTS rows)
  string(REGEX MATCH "^([^:]+):[^:]*:(.*)$" _ "${row}")
  set(folder ${CMAKE_MATCH_1})
  separate_arguments(names UNIX_COMMAND "${CMAKE_MATCH_2}")
  list(TRANSFORM names REPLACE "(.+)" "      \"\\1\",\n")
  string(JOIN "" names ${names})
  if(folder IN_LIST folders)
    string(MAKE_C_IDENTIFIER ${folder} name)
    set(experiments_${name} "${names}")
  else()
    string(APPEND elsewhere "${names}")
  endif()
endforeach()
foreach(folder IN LISTS folders)
  string(MAKE_C_IDENTIFIER ${folder} name)
  set(function add_${name})
  string(APPEND table "    {\"${folder}\", ${function}, {\n"
    "${experiments_${name}}    }},\n")
  string(APPEND functions "void ${function}(Registry& r) {\n")
  file(GLOB sources ${cases}/${folder}/*.cpp)
  foreach(source IN LISTS sources)
    file(STRINGS ${source} lines
      REGEX "^(namespace physinv::[a-z_:]+|void add_[a-z_]+\\(Registry&)")
    foreach(line IN LISTS lines)
      if(line MATCHES "^namespace physinv::([a-z_:]+)")
        set(space ${CMAKE_MATCH_1})
      elseif(line MATCHES "^void (add_[a-z_]+)")
        string(APPEND declared "namespace ${space} {\nAdd ${CMAKE_MATCH_1};\n}\n")
        string(APPEND functions "  ${space}::${CMAKE_MATCH_1}(r);\n")
      endif()
    endforeach()
  endforeach()
  string(APPEND functions "}\n")
endforeach()
file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
#include "suite/cases/common/folders.h"
#include "suite/harness/registry_errors.h"

namespace physinv {

@declared@
namespace {
@functions@}  // namespace

std::vector<CaseFolder> folders() {
  return {
@table@  };
}

void register_all(Registry& r) {
  name_quantities();
  name_elsewhere({
@elsewhere@  });
  for (const CaseFolder& folder : folders()) folder.add(r);
}

}  // namespace physinv
]])
