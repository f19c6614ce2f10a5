# Helpers that every folder's CMakeLists.txt uses.
set(CDIFF_WARNINGS -Wall -Wextra -Werror)

# cdiff_layer(NAME SOURCES file... LINK target...): library e2e_cdiff_NAME of src/NAME.
function(cdiff_layer name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  set(target e2e_cdiff_${name})
  add_library(${target} SHARED ${ARG_SOURCES})
  target_include_directories(${target} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                              $<INSTALL_INTERFACE:include>)
  target_compile_options(${target} PRIVATE ${CDIFF_WARNINGS} -ffp-contract=off)
  target_link_libraries(${target} PUBLIC ${ARG_LINK})
  set_target_properties(${target} PROPERTIES INSTALL_RPATH "$ORIGIN")
  if(E2E_CDIFF_ROS)
    install(TARGETS ${target} LIBRARY DESTINATION ${CATKIN_PACKAGE_LIB_DESTINATION})
  endif()
endfunction()

# cdiff_program(NAME SOURCES file... LINK target...): program that rosrun finds.
function(cdiff_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/include)
  target_compile_options(${name} PRIVATE ${CDIFF_WARNINGS} -ffp-contract=off)
  target_link_libraries(${name} PRIVATE ${ARG_LINK})
  set_target_properties(${name} PROPERTIES INSTALL_RPATH "$ORIGIN/../../lib;$ORIGIN;$ORIGIN/..")
  if(E2E_CDIFF_ROS)
    install(TARGETS ${name} RUNTIME DESTINATION ${CATKIN_PACKAGE_BIN_DESTINATION})
  endif()
endfunction()

# cdiff_gtest(NAME SOURCES file... LINK target... [TIMEOUT s]): one gtest program; results where catkin looks for them.
function(cdiff_gtest name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LINK" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR}/include ${PROJECT_SOURCE_DIR}/test)
  target_compile_options(${name} PRIVATE ${CDIFF_WARNINGS} -ffp-contract=off)
  target_link_libraries(${name} PRIVATE ${ARG_LINK} GTest::gtest GTest::gtest_main)
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  add_test(NAME ${name}
           COMMAND ${name} --gtest_output=xml:${CMAKE_BINARY_DIR}/test_results/e2e_cdiff/gtest-${name}.xml)
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} ENVIRONMENT
                       "SUMO_HOME=/usr/share/sumo;E2E_CDIFF_SHARE=${PROJECT_SOURCE_DIR}")
endfunction()
