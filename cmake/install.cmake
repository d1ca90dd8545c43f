# Component `programs`: those that are built. ./bench builds one of them, and
# with it every layer of the component `development`: find_package(physinv) gives
# physinv::physinv, all below the cases, with the flags that they were built with.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(CODE "
  if(NOT EXISTS \"${PROJECT_BINARY_DIR}/physinv-bench\" AND
     NOT EXISTS \"${PROJECT_BINARY_DIR}/physinv-run\")
    message(FATAL_ERROR \"Nothing is built yet that could be installed. Run \"
      \"./bench or cmake --build ${PROJECT_BINARY_DIR} first.\")
  endif()" ALL_COMPONENTS)

add_library(physinv INTERFACE)
set(physinv_exported physinv physinv_flags)
set_target_properties(physinv_flags PROPERTIES EXPORT_NAME flags)
foreach(layer core decompositions nn problems optimizers baselines diagnostics results evidence build_info harness)
  if(TARGET physinv_${layer})
    target_link_libraries(physinv INTERFACE physinv_${layer})
    list(APPEND physinv_exported physinv_${layer})
  endif()
endforeach()

set(physinv_package ${CMAKE_INSTALL_LIBDIR}/cmake/physinv)
install(TARGETS ${physinv_exported} EXPORT physinv COMPONENT development)
install(EXPORT physinv NAMESPACE physinv:: FILE physinv-targets.cmake
  DESTINATION ${physinv_package} COMPONENT development)
install(DIRECTORY suite problems optimizers baselines
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/physinv COMPONENT development
  FILES_MATCHING PATTERN *.h
  PATTERN app EXCLUDE PATTERN cases EXCLUDE PATTERN kernels.h EXCLUDE
  PATTERN real_fft.h EXCLUDE)

write_basic_package_version_file(
  ${PROJECT_BINARY_DIR}/physinv-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES
    ${PROJECT_SOURCE_DIR}/cmake/physinv-config.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindRE2.cmake
    ${PROJECT_SOURCE_DIR}/cmake/FindSLEEF.cmake
    ${PROJECT_BINARY_DIR}/physinv-config-version.cmake
  DESTINATION ${physinv_package} COMPONENT development)
foreach(program physinv-bench physinv-run physinv-kernels)
  if(TARGET ${program})
    install(TARGETS ${program} COMPONENT programs OPTIONAL)
  endif()
endforeach()
install(DIRECTORY reports/published
  DESTINATION ${CMAKE_INSTALL_DATADIR}/physinv COMPONENT programs)
install(FILES ${PROJECT_SOURCE_DIR}/reports/expected_failures.json
  DESTINATION ${CMAKE_INSTALL_DATADIR}/physinv COMPONENT programs)
