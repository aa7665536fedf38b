# ccache, where it is installed, so that what was compiled once, in this or in another clone, is not compiled again:
# paths count from the source folder, and precompiled headers by what they hold. -DPLIANT_CCACHE=OFF compiles everything.
option(PLIANT_CCACHE "Compile through ccache where it is installed" ON)
find_program(PLIANT_CCACHE_PROGRAM ccache)
mark_as_advanced(PLIANT_CCACHE_PROGRAM)
if(PLIANT_CCACHE AND PLIANT_CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1 CCACHE_DEPEND=1
      CCACHE_SLOPPINESS=pch_defines,time_macros ${PLIANT_CCACHE_PROGRAM})
endif()
