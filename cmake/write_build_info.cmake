# Writes ${info}/build_info.cpp, and build_info.d naming every source that it
# hashed. A header that is new comes in with the changed file that includes it.
include(${info}/values.cmake)

set(sources)
foreach(directory suite/core suite/nn problems optimizers baselines
        suite/diagnostics)
  file(GLOB_RECURSE found RELATIVE ${source_dir}
    ${source_dir}/${directory}/*.h ${source_dir}/${directory}/*.cpp)
  list(APPEND sources ${found})
endforeach()
list(FILTER sources EXCLUDE REGEX "/kernels\\.(cpp|h)$")
list(SORT sources)

string(CONCAT content "${compiler} ${compiler_version} ${flags} "
  "${instruction_set} ${libc} ${eigen} ${fftw} ${hdf5}\n")
set(files ${info}/build_info.cpp:)
foreach(source IN LISTS sources)
  file(SHA256 "${source_dir}/${source}" hash)
  string(APPEND content "${source} ${hash}\n")
  list(APPEND files ${source_dir}/${source})
endforeach()
list(TRANSFORM files REPLACE " " "\\\\ ")
list(JOIN files " \\\n  " depfile)
file(WRITE ${info}/build_info.d "${depfile}\n")
string(SHA256 fingerprint "${content}")
string(SUBSTRING ${fingerprint} 0 16 fingerprint)

# In the order of the struct's members.
set(members)
foreach(member compiler compiler_version flags build_type instruction_set
               fingerprint version eigen fftw hdf5 json fmt cli11)
  string(REPLACE "\"" "\\\"" value "${${member}}")
  string(APPEND members "    .${member} = \"${value}\",\n")
endforeach()
file(CONFIGURE OUTPUT ${info}/build_info.cpp @ONLY CONTENT [[
#include "suite/harness/build_info.h"

namespace physinv {

const BuildInfo& build_info() {
  static constexpr BuildInfo kInfo{
@members@  };
  return kInfo;
}

}  // namespace physinv
]])
