# Writes ${output}: what folders of suite/cases add to the registry, each by a
# function that stands in a table, folders() of suite/cases/tables.h; of one
# folder, register_all, for a program over it alone.
# Usage: cmake -D cases=suite/cases -D folders=jpo/billiards -D output=... -P ...
set(declared)
set(functions)
set(table)
foreach(folder IN LISTS folders)
  string(MAKE_C_IDENTIFIER add_${folder} function)
  string(APPEND table "    {\"${folder}\", ${function}},\n")
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
list(LENGTH folders count)
set(all)
if(count EQUAL 1)
  set(all "void register_all(Registry& r) {\n  name_quantities();\n  ${function}(r);\n}\n")
endif()
file(CONFIGURE OUTPUT ${output} @ONLY CONTENT [[
#include "suite/cases/tables.h"

namespace physinv {

@declared@
namespace {
@functions@}  // namespace

std::vector<CaseFolder> folders() {
  return {
@table@  };
}
@all@
}  // namespace physinv
]])
