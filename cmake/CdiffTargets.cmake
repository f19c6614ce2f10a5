# Helpers that every folder's CMakeLists.txt uses.
set(CDIFF_WARNINGS -Wall -Wextra -Werror)
# Private headers lie beside their sources: "FOLDER/name.h". Only quoted names are looked up there, so <ros/...> stays ROS's.
set(CDIFF_PRIVATE_HEADERS "SHELL:-iquote ${PROJECT_SOURCE_DIR}/src")

# Several sources of a target are compiled as one: most of a file's time goes into the headers that its neighbors read too.
option(E2E_CDIFF_UNITY "Compile sources of a target together, six at a time" ON)
set(CMAKE_UNITY_BUILD ${E2E_CDIFF_UNITY})
set(CMAKE_UNITY_BUILD_BATCH_SIZE 6)
# Layers in which test/nightly/drawn_mutants.py changes one file after another: compiled file by file, quickly, and a variable that a change
# leaves unused is no error.
set(E2E_CDIFF_MUTATED "" CACHE STRING "Layers that are compiled file by file with little optimization")
# A program need not be linked again because a shared library that it uses was.
set(CMAKE_LINK_DEPENDS_NO_SHARED ON)

# cdiff_camel_case(SNAKE OUT): the name of a function, as in pdm_lite -> pdmLite.
function(cdiff_camel_case snake out)
  set(camel "")
  string(REPLACE "_" ";" words ${snake})
  foreach(word ${words})
    string(SUBSTRING ${word} 0 1 first)
    string(SUBSTRING ${word} 1 -1 rest)
    if(camel)
      string(TOUPPER ${first} first)
    endif()
    string(APPEND camel ${first}${rest})
  endforeach()
  set(${out} ${camel} PARENT_SCOPE)
endfunction()

# cdiff_layer(NAME SOURCES file... LINK target...): library e2e_cdiff_NAME of src/NAME.
function(cdiff_layer name)
  cdiff_library(${name} SHARED ${ARGN})
endfunction()

# cdiff_module(NAME SOURCES file... LINK target...): library e2e_cdiff_NAME that a program loads when it needs it.
function(cdiff_module name)
  cdiff_library(${name} MODULE ${ARGN})
endfunction()

# What both have in common.
function(cdiff_library name kind)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(target e2e_cdiff_${name})
  add_library(${target} ${kind} ${ARG_SOURCES})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:include>)
  target_compile_options(${target} PRIVATE ${CDIFF_PRIVATE_HEADERS} ${CDIFF_WARNINGS} -ffp-contract=off)
  target_link_libraries(${target} PUBLIC ${ARG_LINK})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN")
  if(name IN_LIST E2E_CDIFF_MUTATED)
    set_target_properties(${target} PROPERTIES UNITY_BUILD OFF)
    target_compile_options(${target} PRIVATE -O1 -Wno-error)
  endif()
  if(E2E_CDIFF_ROS)
    install(TARGETS ${target} LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  endif()
endfunction()

# All programs that rosrun finds, without tests and benchmarks; those of them that sessions need, without the trainer.
add_custom_target(e2e_cdiff_programs)
add_custom_target(e2e_cdiff_session_programs)

# cdiff_program(NAME [TRAINER] SOURCES file... LINK target...): program that rosrun finds.
function(cdiff_program name)
  cmake_parse_arguments(ARG "TRAINER" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_compile_options(${name} PRIVATE ${CDIFF_PRIVATE_HEADERS} ${CDIFF_WARNINGS} -ffp-contract=off)
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/../../lib;$ORIGIN;$ORIGIN/..")
  add_dependencies(e2e_cdiff_programs ${name})
  if(NOT ARG_TRAINER)
    add_dependencies(e2e_cdiff_session_programs ${name})
  endif()
  if(E2E_CDIFF_ROS)
    install(TARGETS ${name} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  endif()
endfunction()

# Most of the time of a test's compilation goes into headers that all tests read: they are compiled once, and once more together with
# those of the tensor library for tests of trainings. All tests have the flags of these two targets.
set(CDIFF_TEST_FLAGS ${CDIFF_PRIVATE_HEADERS} ${CDIFF_WARNINGS} -ffp-contract=off -O1)
function(cdiff_test_headers name)
  cmake_parse_arguments(ARG "" "" "HEADERS;LINK" ${ARGN})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}.cpp)
  file(CONFIGURE OUTPUT ${source} CONTENT "int main() {}\n")
  add_executable(${name} EXCLUDE_FROM_ALL ${source})
  target_compile_options(${name} PRIVATE ${CDIFF_TEST_FLAGS})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest)
  target_precompile_headers(${name} PRIVATE <gtest/gtest.h> <Eigen/Core> <algorithm> <cmath> <fstream> <functional> <limits> <map> <set>
                                            <string> <vector> ${ARG_HEADERS})
endfunction()

# cdiff_nightly(TEST...): tests of this folder that only `scripts/test --nightly` runs, by their names in ctest.
function(cdiff_nightly)
  foreach(test ${ARGN})
    set_property(TEST ${test} APPEND PROPERTY LABELS nightly)
  endforeach()
endfunction()

# cdiff_first_try(TEST...): tests of this folder that `scripts/test` does not run once more where they fail: same bytes, lost data, access.
function(cdiff_first_try)
  foreach(test ${ARGN})
    set_property(TEST ${test} APPEND PROPERTY LABELS first_try)
  endforeach()
endfunction()

# cdiff_gtest(NAME SOURCES file... LINK target... [TIMEOUT s] [NIGHTLY] [NIGHTLY_CASES pattern]): one gtest program; results
# where catkin looks for them. NIGHTLY: only `scripts/test --nightly` builds and runs it. NIGHTLY_CASES: it runs the cases of this
# gtest filter, as NAME_nightly, and `scripts/test` all others.
function(cdiff_gtest name)
  cmake_parse_arguments(ARG "NIGHTLY" "TIMEOUT;NIGHTLY_CASES" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/test)
  # Compiling tests takes longer than running them: little optimization halves that.
  target_compile_options(${name} PRIVATE ${CDIFF_TEST_FLAGS})
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  if("${ARG_LINK}" MATCHES "_learning|_training")
    target_precompile_headers(${name} REUSE_FROM e2e_cdiff_tensor_test_headers)
  else()
    target_precompile_headers(${name} REUSE_FROM e2e_cdiff_test_headers)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 240)
  endif()
  set(filter)
  if(ARG_NIGHTLY_CASES)
    cdiff_gtest_run(${name}_nightly ${name} ${ARG_TIMEOUT} --gtest_filter=${ARG_NIGHTLY_CASES})
    cdiff_nightly(${name}_nightly)
    set(filter --gtest_filter=-${ARG_NIGHTLY_CASES})
  endif()
  cdiff_gtest_run(${name} ${name} ${ARG_TIMEOUT} ${filter})
  if(ARG_NIGHTLY)
    cdiff_nightly(${name})
    set_target_properties(${name} PROPERTIES EXCLUDE_FROM_ALL ON)
    add_dependencies(e2e_cdiff_nightly_tests ${name})
  endif()
endfunction()

# One run of a gtest program (used by cdiff_gtest). A filter that leaves no case fails.
function(cdiff_gtest_run test program timeout)
  add_test(NAME ${test} COMMAND ${program} --gtest_output=xml:${CMAKE_BINARY_DIR}/test_results/e2e_cdiff/gtest-${test}.xml
                                           ${ARGN})
  set_tests_properties(${test} PROPERTIES TIMEOUT ${timeout} FAIL_REGULAR_EXPRESSION "Running 0 tests" ENVIRONMENT
                       "SUMO_HOME=/usr/share/sumo;E2E_CDIFF_SHARE=${PROJECT_SOURCE_DIR}")
endfunction()
