# Run at build time: writes ${info}/sources.cpp, which registers a program or a
# plug-in with path, hash and #include lines of its sources and of the headers
# that they include (suite/harness/outside.h), and sources.d naming all of them.
# Paths begin with the project's name. A header stands for what is compiled under
# its name: it "includes" pendulum.cpp, wherever that is.
cmake_minimum_required(VERSION 3.25)
include(${info}/values.cmake)
include(${package}/physinv-build.cmake)

# The path that names a file.
function(physinv_name result path)
  set(${result} "" PARENT_SCOPE)
  cmake_path(IS_PREFIX headers "${path}" of_suite)
  cmake_path(IS_PREFIX binary "${path}" generated)
  cmake_path(IS_PREFIX root "${path}" own)
  if(of_suite)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${headers})
    set(${result} ${path} PARENT_SCOPE)
    return()
  elseif(generated)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${binary})
    set(path generated/${path})
  else()
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${root})
  endif()
  if(path MATCHES " ")
    message(FATAL_ERROR "${path}: a path of sources must not have spaces; rename it")
  endif()
  foreach(name ${path} ${project}/${path})
    if(name IN_LIST physinv_number_sources)
      message(FATAL_ERROR "${path}: the suite already has a source with this path; "
        "choose another folder or name")
    endif()
  endforeach()
  set(${result} ${project}/${path} PARENT_SCOPE)
endfunction()

# The file that an #include line of `from` means, "" for a library's.
function(physinv_find result from quote name)
  set(folders ${include_folders} ${headers})
  if(quote STREQUAL "\"")
    cmake_path(GET from PARENT_PATH folder)
    list(PREPEND folders ${folder})
  endif()
  foreach(folder IN LISTS folders)
    cmake_path(APPEND folder ${name} OUTPUT_VARIABLE path)
    cmake_path(NORMAL_PATH path)
    if(EXISTS ${path})
      cmake_path(IS_PREFIX headers "${path}" of_suite)
      cmake_path(IS_PREFIX root "${path}" own)
      if(of_suite OR own OR quote STREQUAL "\"")
        set(${result} ${path} PARENT_SCOPE)
        return()
      endif()
    endif()
  endforeach()
  set(${result} "" PARENT_SCOPE)
endfunction()

# Sets `included` to the paths that a file's lines name, `words` if one is a header of
# the suite that holds no numbers, and adds the project's own to `waiting`.
function(physinv_read file)
  set(line "^[ \t]*#[ \t]*include[ \t]*([<\"])([^>\"]+)[>\"]")
  file(STRINGS ${file} lines REGEX "${line}")
  set(included)
  set(words OFF)
  foreach(text IN LISTS lines)
    string(REGEX MATCH "${line}" _ "${text}")
    physinv_find(path ${file} "${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}")
    if(NOT path)
      continue()
    endif()
    physinv_name(name ${path})
    cmake_path(IS_PREFIX headers "${path}" of_suite)
    if(NOT of_suite)
      list(APPEND waiting ${path})
    elseif(NOT name IN_LIST physinv_number_sources)
      set(words ON)
      continue()
    endif()
    list(APPEND included ${name})
  endforeach()
  set(included ${included} PARENT_SCOPE)
  set(words ${words} PARENT_SCOPE)
  set(waiting ${waiting} PARENT_SCOPE)
endfunction()

# Sets `included` to it and the compiled sources of a header's name.
function(physinv_add_implementations header)
  cmake_path(GET header STEM LAST_ONLY stem)
  foreach(source IN LISTS sources)
    cmake_path(GET source STEM LAST_ONLY other)
    if(other STREQUAL stem)
      physinv_name(name ${source})
      list(APPEND included ${name})
    endif()
  endforeach()
  set(included ${included} PARENT_SCOPE)
endfunction()

list(FILTER sources EXCLUDE REGEX "\\.(h|hh|hpp|hxx)$")
set(waiting ${sources})
set(seen)
set(table)
set(computing)
set(count 0)
while(waiting)
  list(POP_FRONT waiting file)
  if(file IN_LIST seen)
    continue()
  endif()
  list(APPEND seen ${file})
  physinv_name(name ${file})
  physinv_read(${file})
  if(NOT file IN_LIST sources)
    physinv_add_implementations(${file})
  elseif(NOT words)
    string(APPEND computing "    \"${name}\",\n")
    math(EXPR count "${count} + 1")
  endif()
  execute_process(COMMAND ${package}/physinv-sources ${file}
    OUTPUT_VARIABLE hash COMMAND_ERROR_IS_FATAL ANY)
  string(REGEX REPLACE ".*, \"([0-9a-f]+)\".*" "\\1" hash "${hash}")
  list(JOIN included " " included)
  string(APPEND table
    "    {\"${name}\", \"${hash}\",\n     \"${included} \"},\n")
endwhile()

list(TRANSFORM seen REPLACE " " "\\\\ ")
list(PREPEND seen ${info}/sources.cpp:)
list(JOIN seen " \\\n  " depfile)
file(WRITE ${info}/sources.d "${depfile}\n")

# A plug-in is loaded by a program that has one.
set(register_all)
if(NOT plugin)
  set(register_all [[

namespace physinv {
class Registry;
/// The sources register what there is when the program is loaded.
void register_all(Registry&) {}
}  // namespace physinv
]])
endif()

file(CONFIGURE OUTPUT ${info}/sources.cpp @ONLY CONTENT [=[
#include <array>

#include "suite/harness/outside.h"
@register_all@
namespace {

constexpr physinv::SourceFile kSources[] = {
@table@};

constexpr std::array<std::string_view, @count@> kComputing = {
@computing@};

// What a program reads before it loads a plug-in.
[[gnu::used]] const char kMark[] = "physinv plug-in of build @physinv_build@";

const bool kRegistered = physinv::register_outside({
    .name = "@target@",
    .project = "@project@",
    .root = "@root@",
    .data = "@data@",
    .build = "@physinv_build@",
    .plugin = @plugin@,
    .sources = kSources,
    .computing = kComputing,
});

}  // namespace
]=])
