# Component `programs`: physinv-bench; component `kernels`: its kernel benchmarks
# and contract tests, where they are built. physinv-bench has every layer of the
# component `development`: find_package(physinv) gives physinv::physinv, all
# below the cases, with the flags that they were built with, and physinv::app,
# the verbs.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(CODE "
  if(NOT EXISTS \"${PROJECT_BINARY_DIR}/physinv-bench\")
    message(FATAL_ERROR \"Nothing is built yet that could be installed. Run \"
      \"./bench list or cmake --build ${PROJECT_BINARY_DIR} first.\")
  endif()" ALL_COMPONENTS)

add_library(physinv INTERFACE)
set_target_properties(physinv_flags PROPERTIES EXPORT_NAME flags)
set(layers ${physinv_numbers} decompositions nn problems optimizers store results
  evidence build_info harness)
list(FILTER layers EXCLUDE REGEX "_numbers$")  # of experiments
list(TRANSFORM layers PREPEND physinv_)
target_link_libraries(physinv INTERFACE ${layers})

set(physinv_package ${CMAKE_INSTALL_LIBDIR}/cmake/physinv)
install(TARGETS physinv physinv_flags ${layers}
  physinv_app_run physinv_app_end physinv_app
  physinv_gate physinv_compare physinv_planning physinv_reports
  physinv_published_pages
  EXPORT physinv COMPONENT development)
# Their main, which is in the sources of a program.
install(TARGETS physinv_main EXPORT physinv
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/physinv COMPONENT development)
install(EXPORT physinv NAMESPACE physinv:: FILE physinv-targets.cmake
  DESTINATION ${physinv_package} COMPONENT development)
install(DIRECTORY suite problems optimizers baselines
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/physinv COMPONENT development
  FILES_MATCHING PATTERN *.h
  PATTERN app EXCLUDE PATTERN cases EXCLUDE PATTERN kernels.h EXCLUDE
  PATTERN libraries EXCLUDE PATTERN real_fft.h EXCLUDE)

write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/physinv-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
    ${PROJECT_SOURCE_DIR}/cmake/physinv-config.cmake
    ${PROJECT_SOURCE_DIR}/cmake/libraries.cmake
    ${PROJECT_SOURCE_DIR}/cmake/outside_sources.cmake
    ${PROJECT_SOURCE_DIR}/cmake/physinv-outside.cmake
    ${PROJECT_SOURCE_DIR}/cmake/revision.cmake
    ${PROJECT_SOURCE_DIR}/cmake/write_revision.cmake
    ${physinv_info}/physinv-build.cmake
    ${PROJECT_BINARY_DIR}/physinv-config-version.cmake
  DESTINATION ${physinv_package} COMPONENT development)
install(PROGRAMS $<TARGET_FILE:physinv-sources>
  DESTINATION ${physinv_package} COMPONENT development)
install(TARGETS physinv-bench COMPONENT programs OPTIONAL)
if(TARGET physinv-kernels)
  install(TARGETS physinv-kernels COMPONENT kernels OPTIONAL)
endif()

# Contract tests, where they were built: the verb `conformance`, and what users
# link over what they register.
function(physinv_install_contract_tests)
  install(TARGETS physinv-conformance COMPONENT kernels OPTIONAL)
  install(TARGETS physinv_contract physinv_test_quadratic physinv_test_equality
    EXPORT physinv-contract ARCHIVE COMPONENT development OPTIONAL)
  install(TARGETS physinv_conformance EXPORT physinv-contract
    OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/physinv
    COMPONENT development OPTIONAL)
  install(EXPORT physinv-contract NAMESPACE physinv::
    FILE physinv-contract-targets.cmake
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/physinv COMPONENT development)
endfunction()
foreach(component programs development)
  install(DIRECTORY reports/published
    DESTINATION ${CMAKE_INSTALL_DATADIR}/physinv COMPONENT ${component})
endforeach()

# Component `python`, where it is built.
if(TARGET physinv_python)
  set(package ${CMAKE_INSTALL_LIBDIR}/physinv/python/physinv)
  install(TARGETS physinv_python
    LIBRARY DESTINATION ${package} COMPONENT python OPTIONAL)
  install(DIRECTORY python/physinv/ DESTINATION ${package} COMPONENT python
    FILES_MATCHING PATTERN *.py PATTERN *.pyi PATTERN py.typed)
endif()
