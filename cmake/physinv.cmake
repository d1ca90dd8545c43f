# Flags every target shares. They change Eigen's alignment and the bits of the
# results, so they are part of the ABI and travel with the exported target.
add_library(physinv_flags INTERFACE)
if(PHYSINV_NATIVE)
  target_compile_options(physinv_flags INTERFACE -march=native)
else()
  target_compile_options(physinv_flags INTERFACE -march=x86-64-v3)
endif()
target_compile_features(physinv_flags INTERFACE cxx_std_20)
target_compile_definitions(physinv_flags INTERFACE EIGEN_DONT_PARALLELIZE)
set(PHYSINV_WARNINGS -Wall -Wextra -Wshadow)

# physinv_layer(<name> SOURCES ... DEPENDS ...): one target per layer.
function(physinv_layer name)
  cmake_parse_arguments(ARG "OBJECT" "" "SOURCES;DEPENDS" ${ARGN})
  set(kind STATIC)
  if(ARG_OBJECT)
    set(kind OBJECT)
  endif()
  add_library(physinv_${name} ${kind} ${ARG_SOURCES})
  target_include_directories(physinv_${name} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}> $<INSTALL_INTERFACE:include/physinv>)
  target_link_libraries(physinv_${name} PUBLIC physinv_flags ${ARG_DEPENDS})
  target_compile_options(physinv_${name} PRIVATE ${PHYSINV_WARNINGS})
endfunction()
