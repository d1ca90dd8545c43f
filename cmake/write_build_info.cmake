# Writes ${info}/build_info.cpp, and build_info.d naming every source that it
# hashed and the folders they are in, so that a new one is seen. What programs
# and plug-ins on the installed suite need to know goes to physinv-build.cmake.
include(${info}/values.cmake)

function(physinv_sources result)
  set(all)
  foreach(directory IN LISTS ARGN)
    file(GLOB_RECURSE found RELATIVE ${source_dir}
      ${source_dir}/${directory}/*.h ${source_dir}/${directory}/*.cpp)
    list(APPEND all ${found})
  endforeach()
  # No number comes from those.
  list(FILTER all EXCLUDE REGEX "/(kernels|kernels_libraries|real_fft|array_table)\\.(cpp|h)$")
  list(SORT all)
  set(${result} ${all} PARENT_SCOPE)
endfunction()

physinv_sources(numerics suite/core suite/linalg suite/nn problems optimizers
  baselines suite/diagnostics)
physinv_sources(cases suite/cases)  # for the metrics among them
set(everywhere suite/harness/run_stage.cpp suite/harness/run_stage.h)
set(sources ${numerics} ${cases} ${everywhere})

# What a plug-in sees of the suite.
file(GLOB_RECURSE interfaces RELATIVE ${source_dir} ${source_dir}/suite/*.h
  ${source_dir}/problems/*.h ${source_dir}/optimizers/*.h
  ${source_dir}/baselines/*.h)
list(FILTER interfaces EXCLUDE REGEX "^suite/(app|cases)/|/(kernels|real_fft)\\.h$")
list(SORT interfaces)
list(APPEND sources ${interfaces})
list(REMOVE_DUPLICATES sources)

# A line for each source: path, hash of its tokens, the headers that it includes.
function(physinv_scan result)
  execute_process(COMMAND ${emulator} ${scanner} ${ARGN} WORKING_DIRECTORY ${source_dir}
    OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL ANY)
  set(${result} "${lines}" PARENT_SCOPE)
endfunction()

# Text of 16 digits over texts and scanned sources.
function(physinv_digest result text lines)
  string(SHA256 digest "${text}\n${lines}")
  string(SUBSTRING ${digest} 0 16 digest)
  set(${result} ${digest} PARENT_SCOPE)
endfunction()

physinv_scan(everywhere_lines ${everywhere})
physinv_scan(numerics_lines ${numerics})
physinv_scan(cases_lines ${cases})
physinv_scan(interfaces_lines ${interfaces})
physinv_digest(foundation "${bit_flags} ${libc} ${eigen} ${sleef}"
  "${everywhere_lines}")
physinv_digest(fingerprint ${foundation} "${numerics_lines}")
physinv_digest(interfaces "${compiler} ${compiler_version} ${flags}"
  "${interfaces_lines}")
set(table "${numerics_lines}${cases_lines}")

set(files)
foreach(source IN LISTS sources)
  list(APPEND files ${source_dir}/${source})
  # Its folder, and those above it up to the project's.
  cmake_path(GET source PARENT_PATH folder)
  while(folder)
    list(APPEND files ${source_dir}/${folder})
    cmake_path(GET folder PARENT_PATH folder)
  endwhile()
endforeach()
list(REMOVE_DUPLICATES files)
list(TRANSFORM files REPLACE " " "\\\\ ")
list(PREPEND files ${info}/build_info.cpp:)
list(JOIN files " \\\n  " depfile)
file(WRITE ${info}/build_info.d "${depfile}\n")

# In the order of the struct's members.
set(members)
foreach(member compiler compiler_version flags bit_flags build_type
               instruction_set fingerprint interfaces foundation version eigen sleef hdf5 json fmt cli11)
  string(REPLACE "\"" "\\\"" value "${${member}}")
  string(APPEND members "    .${member} = \"${value}\",\n")
endforeach()
file(CONFIGURE OUTPUT ${info}/build_info.cpp @ONLY CONTENT [[
#include "suite/harness/build_info.h"

namespace physinv {
namespace {

constexpr SourceFile kSources[] = {
@table@};

}  // namespace

const BuildInfo& build_info() {
  static constexpr BuildInfo kInfo{
@members@    .sources = kSources,
  };
  return kInfo;
}

}  // namespace physinv
]])
file(CONFIGURE OUTPUT ${info}/physinv-build.cmake @ONLY CONTENT [[
set(physinv_build "@interfaces@")
set(physinv_compiler "@compiler@ @compiler_version@")
set(physinv_number_sources "@numerics@")
]])
