# `cpack` in a build tree makes two packages for Debian 12 from what is built:
# physinv-bench (the programs, the papers' numbers) and python3-physinv. They run
# on processors with the registers that they were built for; the preset v3 is
# for all that have AVX2.
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/physinv-bench
  RENAME copyright COMPONENT programs)
if(TARGET physinv_python)
  install(FILES ${PROJECT_SOURCE_DIR}/LICENSE
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/python3-physinv
    RENAME copyright COMPONENT python)
  # Python finds the package by a path that is seen from its own directory.
  set(site lib/python3/dist-packages)
  file(RELATIVE_PATH package_path /${site}
    /${CMAKE_INSTALL_LIBDIR}/physinv/python)
  file(GENERATE OUTPUT ${PROJECT_BINARY_DIR}/physinv.pth
    CONTENT "${package_path}\n")
  install(FILES ${PROJECT_BINARY_DIR}/physinv.pth
    DESTINATION ${site} COMPONENT python)
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE zstd)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL programs)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "physinv-bench contributors")
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME physinv-bench)
set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION
  "benchmarks of inverse problems in physics
 Fits networks and runs classical optimizers on the inverse problems of three
 papers, and compares losses, times and statements with the published ones.")
if(TARGET physinv_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-physinv)
  # The module is for this Python alone.
  string(REGEX MATCH "^3\\.([0-9]+)$" version ${physinv_python_version})
  math(EXPR next "${CMAKE_MATCH_1} + 1")
  set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "physinv-bench (= ${PROJECT_VERSION})"
    "python3 (>= ${version})" "python3 (<< 3.${next})" python3-numpy)
  list(JOIN CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS ", "
    CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS)
  set(CPACK_COMPONENT_PYTHON_DESCRIPTION
    "problems and campaigns of physinv-bench in Python
 Every problem as functions of NumPy arrays and PyTorch tensors, methods and
 problems of one's own, and campaigns that run and are read from Python.")
endif()
include(CPack)
