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
include(${CMAKE_CURRENT_LIST_DIR}/physinv-targets.cmake)

# Where things are, seen from here: an installed tree may move.
set(PHYSINV_PACKAGE ${CMAKE_CURRENT_LIST_DIR})
get_target_property(PHYSINV_HEADERS physinv::core INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER PHYSINV_HEADERS INCLUDE REGEX "/include/physinv$")
list(GET PHYSINV_HEADERS 0 PHYSINV_HEADERS)
cmake_path(SET PHYSINV_DATA NORMALIZE
  "${PHYSINV_HEADERS}/../../share/physinv")
# The contract tests, where they were built (./bench conformance, ./check).
file(GLOB physinv_contract
  ${CMAKE_CURRENT_LIST_DIR}/../../libphysinv_contract.a)
if(physinv_contract)
  find_package(GTest QUIET)
  if(GTest_FOUND)
    include(${CMAKE_CURRENT_LIST_DIR}/physinv-contract-targets.cmake)
  endif()
endif()
include(${CMAKE_CURRENT_LIST_DIR}/physinv-outside.cmake)
