# One recipe for every module: a static library pliant_<name> and, where it has tests, one test program.
#
#   pliant_module(NAME core SOURCES a.cpp USES <libraries that the headers need> PRIVATE_USES <the rest>
#                 TESTS a_test.cpp REFERENCE_TESTS a_reference_test.cpp PEER_TESTS a_peer_test.cpp
#                 TEST_USES <libraries of the tests>)
#
# Each test file is one CTest entry. A reference test reads the folder that PLIANT_REFERENCE_DATA names and is
# reported as skipped, with the reason, where the variable is not set (exit status 77, see test_main.cpp). A peer test
# runs CalculiX (ccx) beside Pliant, meshio_peer_test.cpp meshio, display_peer_test.cpp Xvfb, and is skipped likewise
# where it is not installed. With PLIANT_NO_SKIPS=1 they fail instead.

# Every entry of CTest has a label for its kind (unit, reference, peer, document, web, example, print, fuzz), and those
# over some 20 s, which PliantLongTests.cmake lists, the label `long`: ctest -L unit, ctest -LE long.

include(PliantLongTests)

# Labels a test by its kind; called where the test is added, and again where a kind is not the usual one.
function(pliant_label test kind)
  set(labels ${kind})
  if(test IN_LIST PLIANT_LONG_TESTS)
    list(APPEND labels long)
  endif()
  set_tests_properties(${test} PROPERTIES LABELS "${labels}")
endfunction()

add_library(pliant_flags INTERFACE)
target_include_directories(pliant_flags INTERFACE ${PROJECT_SOURCE_DIR}/src)
target_compile_options(pliant_flags INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor
                                              $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>) # false alarms of GCC 12
if(PLIANT_SANITIZE)
  target_compile_options(pliant_flags INTERFACE -fsanitize=${PLIANT_SANITIZE} -fno-omit-frame-pointer -g)
  target_link_options(pliant_flags INTERFACE -fsanitize=${PLIANT_SANITIZE})
endif()
if(PLIANT_FUZZ)
  target_compile_options(pliant_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

function(pliant_module)
  cmake_parse_arguments(M "" "NAME" "SOURCES;USES;PRIVATE_USES;TESTS;REFERENCE_TESTS;PEER_TESTS;TEST_USES" ${ARGN})
  set(library pliant_${M_NAME})
  add_library(${library} STATIC ${M_SOURCES})
  target_link_libraries(${library} PUBLIC pliant_flags ${M_USES} PRIVATE ${M_PRIVATE_USES})
  if(PLIANT_TESTS AND (M_TESTS OR M_REFERENCE_TESTS OR M_PEER_TESTS))
    pliant_test_program(${M_NAME} "${M_TESTS}" "${M_REFERENCE_TESTS}" "${library};${M_TEST_USES}" ${M_PEER_TESTS})
  endif()
endfunction()

function(pliant_test_program name tests reference_tests libraries) # then the peer tests
  set(program pliant_${name}_test)
  add_executable(${program} ${tests} ${reference_tests} ${ARGN} ${PROJECT_SOURCE_DIR}/src/test_main.cpp)
  target_link_libraries(${program} PRIVATE ${libraries} doctest::doctest)
  foreach(file IN LISTS tests)
    string(REGEX REPLACE "_test\\.cpp$" "" stem ${file})
    add_test(NAME ${name}/${stem} COMMAND ${program} --source-file=*/${file} WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name}/${stem} PROPERTIES TIMEOUT 600)
    pliant_label(${name}/${stem} unit)
  endforeach()
  foreach(file IN LISTS reference_tests)
    string(REGEX REPLACE "_reference_test\\.cpp$" "" stem ${file})
    add_test(NAME ${name}/reference/${stem} COMMAND ${program} --reference --source-file=*/${file}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name}/reference/${stem} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 900)
    pliant_label(${name}/reference/${stem} reference)
  endforeach()
  foreach(file IN LISTS ARGN)
    string(REGEX REPLACE "_peer_test\\.cpp$" "" stem ${file})
    set(peer ccx)
    if(stem STREQUAL "meshio")
      set(peer meshio)
    elseif(stem STREQUAL "display")
      set(peer Xvfb)
    endif()
    add_test(NAME ${name}/peer/${stem} COMMAND ${program} --peer=${peer} --source-file=*/${file}
             WORKING_DIRECTORY ${PROJECT_SOURCE_DIR})
    set_tests_properties(${name}/peer/${stem} PROPERTIES SKIP_RETURN_CODE 77 TIMEOUT 900)
    pliant_label(${name}/peer/${stem} peer)
  endforeach()
endfunction()
