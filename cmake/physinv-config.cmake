include(CMakeFindDependencyMacro)
enable_language(C)  # FindHDF5 asks the C compiler
find_dependency(Eigen3 3.4)
find_dependency(fmt)
find_dependency(nlohmann_json)
find_dependency(CLI11)
find_dependency(Threads)
find_dependency(HDF5 COMPONENTS C)
find_dependency(ZLIB)
find_dependency(PNG)
include(${CMAKE_CURRENT_LIST_DIR}/libraries.cmake)
physinv_find_libraries()
foreach(library SLEEF::sleef re2::re2)
  if(NOT TARGET ${library})
    set(${CMAKE_FIND_PACKAGE_NAME}_FOUND FALSE)
    set(${CMAKE_FIND_PACKAGE_NAME}_NOT_FOUND_MESSAGE "${library} is missing")
    return()
  endif()
endforeach()
include(${CMAKE_CURRENT_LIST_DIR}/physinv-targets.cmake)

# Where things are, seen from here: an installed tree may move.
set(PHYSINV_PACKAGE ${CMAKE_CURRENT_LIST_DIR})
get_target_property(PHYSINV_HEADERS physinv::core INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER PHYSINV_HEADERS INCLUDE REGEX "/include/physinv$")
list(GET PHYSINV_HEADERS 0 PHYSINV_HEADERS)
cmake_path(SET PHYSINV_DATA NORMALIZE
  "${PHYSINV_HEADERS}/../../share/physinv")
# The contract tests, where they were built (./bench conformance, ./check) and no
# build stopped on the way.
file(GLOB physinv_contract
  ${CMAKE_CURRENT_LIST_DIR}/../../libphysinv_contract.a)
file(GLOB physinv_conformance
  ${CMAKE_CURRENT_LIST_DIR}/../../physinv/objects-*/physinv_conformance/*.o)
if(physinv_contract AND physinv_conformance)
  find_package(GTest QUIET)
  if(GTest_FOUND)
    include(${CMAKE_CURRENT_LIST_DIR}/physinv-contract-targets.cmake)
  endif()
endif()
include(${CMAKE_CURRENT_LIST_DIR}/physinv-outside.cmake)
