# Every library that Pliant links, from the Debian packages of packages.txt. Licences: LICENSES.md.
find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(fmt REQUIRED)
find_package(tl-expected REQUIRED)
find_package(nlohmann_json REQUIRED)
find_package(CLI11 REQUIRED)
find_package(PNG REQUIRED)
find_package(embree 3 REQUIRED)
find_package(GIF 5 REQUIRED)
find_package(hwy REQUIRED)
set(CGAL_DO_NOT_WARN_ABOUT_CMAKE_BUILD_TYPE ON)
find_package(CGAL REQUIRED)
pkg_check_modules(cairo REQUIRED IMPORTED_TARGET cairo)
add_library(pliant_cairo_headers INTERFACE) # the library itself is loaded when the first picture is drawn
target_include_directories(pliant_cairo_headers SYSTEM INTERFACE ${cairo_INCLUDE_DIRS})
pkg_check_modules(tomlplusplus REQUIRED IMPORTED_TARGET tomlplusplus)
pkg_check_modules(muparser REQUIRED IMPORTED_TARGET muparser)
pkg_check_modules(sdl2 REQUIRED IMPORTED_TARGET sdl2)
pkg_check_modules(libdeflate REQUIRED IMPORTED_TARGET libdeflate)
pkg_check_modules(nettle REQUIRED IMPORTED_TARGET nettle)
pkg_check_modules(libzip REQUIRED IMPORTED_TARGET libzip)
add_library(pliant_libzip_headers INTERFACE) # the library itself is loaded when the first archive is read
target_include_directories(pliant_libzip_headers SYSTEM INTERFACE ${libzip_INCLUDE_DIRS})
file(READ_SYMLINK ${pkgcfg_lib_libzip_zip} pliant_libzip_name) # libzip.so.4 of libzip.so
pkg_check_modules(pugixml REQUIRED IMPORTED_TARGET pugixml)

if(PLIANT_TESTS)
  find_package(doctest REQUIRED)
  pkg_check_modules(x11 REQUIRED IMPORTED_TARGET x11)
endif()

if(PLIANT_MPI)
  pkg_check_modules(petsc REQUIRED IMPORTED_TARGET PETSc)
  pkg_check_modules(hdf5mpi REQUIRED IMPORTED_TARGET hdf5-openmpi)
  set_target_properties(PkgConfig::petsc PROPERTIES INTERFACE_COMPILE_OPTIONS "") # how Debian compiles is not how we do
  pkg_check_modules(mpi REQUIRED IMPORTED_TARGET ompi-c)
  add_library(pliant_petsc INTERFACE)
  target_link_libraries(pliant_petsc INTERFACE PkgConfig::petsc PkgConfig::hdf5mpi PkgConfig::mpi)
  target_compile_definitions(pliant_petsc INTERFACE OMPI_SKIP_MPICXX)
endif()

# A library that ships neither a CMake package nor a pkg-config file.
function(pliant_find_plain target header library)
  find_path(${target}_INCLUDE ${header} PATH_SUFFIXES suitesparse REQUIRED)
  find_library(${target}_LIBRARY ${library} REQUIRED)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${target} SYSTEM INTERFACE ${${target}_INCLUDE})
  target_link_libraries(${target} INTERFACE ${${target}_LIBRARY})
endfunction()

pliant_find_plain(gmsh gmsh.h gmsh)
pliant_find_plain(civetweb civetweb.h civetweb)

# Of Highway only the headers: base/linalg/simd_targets.cpp says why.
add_library(pliant_highway INTERFACE)
target_include_directories(pliant_highway SYSTEM INTERFACE $<TARGET_PROPERTY:hwy::hwy,INTERFACE_INCLUDE_DIRECTORIES>)

# Kernels in SIMD are compiled once for each of: what every processor has, AVX2, AVX-512; NEON elsewhere. Vectors whose
# size is not known when they are compiled (SVE, RVV) do not fit into arrays.
set(PLIANT_SIMD_TARGETS
  "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_SSE4|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
