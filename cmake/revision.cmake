# physinv_revision(<target> <name> <root> <folder>): gives the target a source
# that says from which revision of the sources in <root> it is linked, under a
# name (suite/harness/revision.h). <folder>/revision.cpp is looked at when git
# moved or a tracked file was written, and rewritten only when its content
# changes: a commit compiles this source and links, nothing else.
function(physinv_revision target name root folder)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/write_revision.cmake)
  add_custom_command(
    OUTPUT ${folder}/revision.cpp
    DEPFILE ${folder}/revision.d
    DEPENDS ${script}
    COMMAND ${CMAKE_COMMAND} -D "name=${name}" -D root=${root}
      -D folder=${folder} -P ${script}
    COMMENT "Revision of ${target}"
    VERBATIM)
  target_sources(${target} PRIVATE ${folder}/revision.cpp)
endfunction()
