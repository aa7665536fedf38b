# One recipe for every module: the folder src/WING/ROOM is the static library pliant_WING_ROOM, made of its .cpp files,
# and where it has tests, one test program.
#
#   pliant_module(USES <what its headers need> PRIVATE_USES <the rest> TEST_USES <more, for its tests>
#                 SOURCES <generated files> EXCEPT <files of other targets of this folder>
#                 ALONE <files that no group can have: with definitions or system headers of their own>
#                 QUICK: compiled quickly, see below; PLAIN: without what the others share)
#
# Other modules are named by their folders, WING/ROOM; everything else is the name of a target. A module sees the
# headers of what it names, and no others: there is no common include folder, only one for each module that shows that
# module alone (pliant_show). tools/check_arrows says more about the order.
#
# Each test file is one CTest entry. x_reference_test.cpp reads the folder that PLIANT_REFERENCE_DATA names and is
# reported as skipped, with the reason, where the variable is not set (exit status 77, see test_main.cpp). x_peer_test.cpp
# runs another program beside Pliant (CalculiX; meshio and Xvfb by the names of the files) and is skipped likewise where
# it is not installed. With PLIANT_NO_SKIPS=1 they fail instead.
#
# Every entry of CTest has a label for its kind (unit, reference, peer, document, web, example, print, fuzz), and those
# over some 20 s, which PliantLongTests.cmake lists, the label `long`: ctest -L unit, ctest -LE long.

include(PliantLongTests)

# Labels a test by its kind; called where the test is added, and again where a kind is not the usual one.
function(pliant_label test kind)
  set(labels ${kind})
  if(test IN_LIST PLIANT_LONG_TESTS)
    list(APPEND labels long)
    # Begun first, also in a clone in which CTest does not know yet how long they take.
    set_tests_properties(${test} PROPERTIES COST 100)
  endif()
  set_tests_properties(${test} PROPERTIES LABELS "${labels}")
endfunction()

add_library(pliant_flags INTERFACE)
target_compile_options(pliant_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                              $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict> # false alarms of GCC 12
                                              # The sources of a group are taken for headers.
                                              $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>
                                              $<$<CXX_COMPILER_ID:GNU>:-fpch-preprocess>) # what ccache asks for
# All code may become part of the shared library, which shows its public interface alone.
target_compile_options(pliant_flags INTERFACE -fPIC -fvisibility=hidden -fvisibility-inlines-hidden)
if(PLIANT_SANITIZE)
  target_compile_options(pliant_flags INTERFACE -fsanitize=${PLIANT_SANITIZE} -fno-omit-frame-pointer -g)
  target_link_options(pliant_flags INTERFACE -fsanitize=${PLIANT_SANITIZE})
endif()
if(PLIANT_FUZZ)
  target_compile_options(pliant_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# What compiling costs. A full optimisation (-O3) is for rooms in which people wait for the processor; those marked QUICK
# and all tests make do with -O1, which the compiler finishes in a third less time. The standard library, fmt and, in
# tests, doctest are parsed once for all that is compiled alike. PLIANT_PRECOMPILE=OFF shows what a file forgot to include.
option(PLIANT_PRECOMPILE "Parse the standard library once instead of once for every file" ON)
set(pliant_quick_flags $<$<CONFIG:Release>:-O1>
                       # GCC 12 takes sums of strings at -O1 for writes beyond their ends: false alarms.
                       $<$<CXX_COMPILER_ID:GNU>:-Wno-array-bounds> $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow>)

function(pliant_headers name)
  add_library(${name} OBJECT ${PROJECT_SOURCE_DIR}/cmake/precompiled.cpp)
  target_link_libraries(${name} PRIVATE pliant_flags fmt::fmt tl::expected Threads::Threads)
  target_precompile_headers(${name} PRIVATE
    <algorithm> <array> <chrono> <cmath> <cstdint> <filesystem> <functional> <limits> <map> <memory> <numeric> <optional>
    <set> <span> <sstream> <string> <string_view> <tuple> <utility> <variant> <vector> <fmt/format.h> <tl/expected.hpp>)
endfunction()
if(PLIANT_PRECOMPILE)
  pliant_headers(pliant_headers_full)
  pliant_headers(pliant_headers_quick)
  target_compile_options(pliant_headers_quick PRIVATE ${pliant_quick_flags})
  if(PLIANT_TESTS)
    pliant_headers(pliant_headers_test)
    target_compile_options(pliant_headers_test PRIVATE ${pliant_quick_flags})
    target_link_libraries(pliant_headers_test PRIVATE doctest::doctest)
    target_precompile_headers(pliant_headers_test PRIVATE <doctest/doctest.h>)
  endif()
endif()

# pliant_compile(TARGET full|quick|test): how it is compiled.
function(pliant_compile target kind)
  if(NOT kind STREQUAL "full")
    target_compile_options(${target} PRIVATE ${pliant_quick_flags})
  endif()
  if(PLIANT_PRECOMPILE)
    target_precompile_headers(${target} REUSE_FROM pliant_headers_${kind})
  endif()
endfunction()

# Most of the compiler's time goes into headers, Eigen's above all, once for every file. So the sources of a room are
# compiled in groups: files of the build folder that include several of them. Within a group all unnamed namespaces are
# one; tools/check_names sees to it that no name is in two files. PLIANT_GROUPS=0, as in the preset dev, compiles each
# source alone: after an edit only that file is compiled again, clang-tidy finds the command of each, and a file that
# forgot to include a header does not compile.
set(PLIANT_GROUPS 8 CACHE STRING "Compile at most so many sources of a room together; 0: each alone")

# pliant_grouped(RESULT NAME FILE...): what is compiled for these files of this folder.
function(pliant_grouped result name)
  list(LENGTH ARGN count)
  if(PLIANT_GROUPS LESS 2 OR count LESS 2)
    set(${result} ${ARGN} PARENT_SCOPE)
    return()
  endif()
  # Groups of one size, within a file.
  math(EXPR groups "(${count} + ${PLIANT_GROUPS} - 1) / ${PLIANT_GROUPS}")
  set(grouped)
  set(begin 0)
  foreach(group RANGE 1 ${groups})
    math(EXPR end "${group} * ${count} / ${groups}")
    math(EXPR size "${end} - ${begin}")
    list(SUBLIST ARGN ${begin} ${size} members)
    set(begin ${end})
    set(file ${CMAKE_CURRENT_BINARY_DIR}/groups/${name}_${group}.cpp)
    set(text)
    foreach(member IN LISTS members)
      # Not by its full path: another clone finds the object in the compiler's cache.
      cmake_path(ABSOLUTE_PATH member)
      cmake_path(RELATIVE_PATH member BASE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/groups)
      string(APPEND text "#include \"${member}\"\n")
    endforeach()
    file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
    list(APPEND grouped ${file})
  endforeach()
  set(${result} ${grouped} PARENT_SCOPE)
endfunction()

# The main function of all test programs, with the code of doctest, compiled once.
if(PLIANT_TESTS)
  add_library(pliant_test_main STATIC ${PROJECT_SOURCE_DIR}/src/test_main.cpp)
  target_link_libraries(pliant_test_main PUBLIC doctest::doctest
                        PRIVATE pliant_flags fmt::fmt tl::expected Threads::Threads)
  pliant_compile(pliant_test_main test)
endif()

# The targets of a list of names: pliant_base_core for base/core, all others as they are.
function(pliant_targets result)
  set(targets)
  foreach(name IN LISTS ARGN)
    if(name MATCHES "^[a-z0-9_]+/[a-z0-9_]+$")
      string(REPLACE "/" "_" name pliant_${name})
    endif()
    list(APPEND targets ${name})
  endforeach()
  set(${result} ${targets} PARENT_SCOPE)
endfunction()

# target_link_libraries with names as above: pliant_link(TARGET PUBLIC base/core PRIVATE pliant_highway).
function(pliant_link target)
  pliant_targets(libraries ${ARGN})
  target_link_libraries(${target} ${libraries})
endfunction()

# Lets users of `target` include "WING/ROOM/..." of this folder and of no other.
function(pliant_show target folder)
  string(REPLACE "/" "_" name ${folder})
  set(view ${PROJECT_BINARY_DIR}/see/${name})
  cmake_path(GET folder PARENT_PATH wing)
  file(MAKE_DIRECTORY ${view}/${wing})
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/src/${folder} ${view}/${folder} SYMBOLIC)
  target_include_directories(${target} PUBLIC ${view})
endfunction()

# A further library of a module's folder.
function(pliant_part name)
  cmake_parse_arguments(M "QUICK;PLAIN" "" "SOURCES;USES;PRIVATE_USES" ${ARGN})
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/src OUTPUT_VARIABLE folder)
  add_library(${name} STATIC ${M_SOURCES})
  pliant_show(${name} ${folder})
  pliant_link(${name} PUBLIC pliant_flags ${M_USES} PRIVATE ${M_PRIVATE_USES})
  if(M_QUICK)
    pliant_compile(${name} quick)
  elseif(NOT M_PLAIN)
    pliant_compile(${name} full)
  endif()
endfunction()

function(pliant_module)
  cmake_parse_arguments(M "QUICK;PLAIN" "" "SOURCES;EXCEPT;ALONE;USES;PRIVATE_USES;TEST_USES" ${ARGN})
  set(kind)
  foreach(option IN ITEMS QUICK PLAIN)
    if(M_${option})
      set(kind ${option})
    endif()
  endforeach()
  cmake_path(RELATIVE_PATH CMAKE_CURRENT_SOURCE_DIR BASE_DIRECTORY ${PROJECT_SOURCE_DIR}/src OUTPUT_VARIABLE folder)
  pliant_targets(library ${folder})
  file(GLOB files RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS *.cpp)
  set(tests ${files})
  list(FILTER tests INCLUDE REGEX "_test\\.cpp$")
  list(FILTER files EXCLUDE REGEX "^test_.*|_test\\.cpp$")
  list(REMOVE_ITEM files ${M_EXCEPT} ${M_ALONE} "") # it asks for one at least
  pliant_grouped(files sources ${files})
  pliant_part(${library} ${kind} SOURCES ${files} ${M_ALONE} ${M_SOURCES} USES ${M_USES} PRIVATE_USES ${M_PRIVATE_USES})
  if(PLIANT_TESTS AND tests)
    pliant_test_program(${folder} GROUPED TESTS ${tests} USES ${library} ${M_PRIVATE_USES} ${M_TEST_USES})
  endif()
endfunction()

# pliant_test_program(WING/ROOM TESTS a_test.cpp ... USES <what they need> GROUPED: compiled in groups): one program, an
# entry for each file.
function(pliant_test_program folder)
  cmake_parse_arguments(T "GROUPED" "" "TESTS;USES" ${ARGN})
  string(REPLACE "/" "_" program pliant_${folder}_test)
  set(sources ${T_TESTS})
  if(T_GROUPED)
    pliant_grouped(sources ${program} ${T_TESTS})
  endif()
  add_executable(${program} ${sources})
  pliant_link(${program} PRIVATE pliant_test_main pliant_flags ${T_USES})
  if(NOT "CGAL::CGAL" IN_LIST T_USES) # its flags are not those of the shared headers
    pliant_compile(${program} test)
  endif()
  add_dependencies(${program} pliant_mesh)
  foreach(file IN LISTS T_TESTS)
    string(REGEX REPLACE "_test\\.cpp$" "" stem ${file})
    set(name ${folder}/${stem})
    set(options)
    set(kind unit)
    if(stem MATCHES "^(.*)_reference$")
      set(kind reference)
      set(name ${folder}/reference/${CMAKE_MATCH_1})
      set(options --reference)
    elseif(stem MATCHES "^(.*)_peer$")
      set(kind peer)
      set(name ${folder}/peer/${CMAKE_MATCH_1})
      set(peer ccx)
      if(CMAKE_MATCH_1 STREQUAL "meshio")
        set(peer meshio)
      elseif(CMAKE_MATCH_1 STREQUAL "display")
        set(peer Xvfb)
      endif()
      set(options --peer=${peer})
    endif()
    add_test(NAME ${name} COMMAND ${program} ${options} --source-file=*/${file} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name} PROPERTIES TIMEOUT 900 SKIP_RETURN_CODE 77)
    pliant_label(${name} ${kind})
  endforeach()
endfunction()
