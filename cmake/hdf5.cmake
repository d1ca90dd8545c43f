# physinv_hdf5: HDF5 for what is built here. Programs take the archive: Debian's
# shared library brings thirty others along, for files in the web, and loading
# them is most of what a start costs. What is loaded into other programs (the
# Python module) takes the shared library, and so does everything where the
# archive alone does not link.
include(CheckCSourceCompiles)
find_package(HDF5 REQUIRED COMPONENTS C)

add_library(physinv_hdf5 INTERFACE)
if(HDF5_C_LIBRARY_hdf5)
  cmake_path(GET HDF5_C_LIBRARY_hdf5 PARENT_PATH folder)
  find_library(PHYSINV_HDF5_ARCHIVE libhdf5.a PATHS ${folder} NO_DEFAULT_PATH)
  find_library(PHYSINV_SZIP sz)
  mark_as_advanced(PHYSINV_HDF5_ARCHIVE PHYSINV_SZIP)
endif()
if(PHYSINV_HDF5_ARCHIVE AND PHYSINV_SZIP)
  set(archive ${PHYSINV_HDF5_ARCHIVE} ${PHYSINV_SZIP} ZLIB::ZLIB
    ${CMAKE_DL_LIBS} m)
  set(CMAKE_REQUIRED_LIBRARIES ${archive})
  set(CMAKE_REQUIRED_INCLUDES ${HDF5_C_INCLUDE_DIRS})
  check_c_source_compiles("
    #include <hdf5.h>
    int main(void) {
      const hid_t list = H5Pcreate(H5P_FILE_ACCESS);
      H5Pset_fapl_core(list, 1, 0);
      const hid_t file = H5Fopen(\"\", H5F_ACC_RDWR, list);
      const hid_t set = H5Dopen2(file, \"x\", H5P_DEFAULT);
      double x;
      H5Dread(set, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, &x);
      return H5Fget_file_image(file, 0, 0) < 0;
    }" PHYSINV_HDF5_ARCHIVE_LINKS)
  unset(CMAKE_REQUIRED_LIBRARIES)
  unset(CMAKE_REQUIRED_INCLUDES)
endif()
target_include_directories(physinv_hdf5 SYSTEM INTERFACE ${HDF5_C_INCLUDE_DIRS})
target_compile_definitions(physinv_hdf5 INTERFACE ${HDF5_C_DEFINITIONS})
if(PHYSINV_HDF5_ARCHIVE_LINKS)
  set(program $<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>)
  target_link_libraries(physinv_hdf5 INTERFACE
    "$<${program}:${archive}>" $<$<NOT:${program}>:hdf5::hdf5>)
  # A plug-in that has HDF5 of its own meets none of a program's functions.
  target_link_options(physinv_hdf5 INTERFACE
    $<${program}:LINKER:--exclude-libs=libhdf5.a>)
else()
  target_link_libraries(physinv_hdf5 INTERFACE hdf5::hdf5)
endif()
