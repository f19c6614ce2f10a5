# The target `docs`, which nothing else builds: pages of the public API by Doxygen (docs/Doxyfile.in), in <build>/api/html.
#
# The file is also the script that runs it: cmake -DDOXYFILE=... -P CdiffDocs.cmake
if(CMAKE_SCRIPT_MODE_FILE)
  find_program(DOXYGEN doxygen)
  if(NOT DOXYGEN)
    message(FATAL_ERROR "doxygen is not installed; on Debian: apt-get install doxygen")
  endif()
  get_filename_component(folder ${DOXYFILE} DIRECTORY)
  file(MAKE_DIRECTORY ${folder}/api)
  execute_process(COMMAND ${DOXYGEN} ${DOXYFILE} RESULT_VARIABLE result)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "the comments of include/e2e_cdiff have faults (above)")
  endif()
  message(STATUS "${folder}/api/html/index.html")
  return()
endif()

# In a workspace another package may have the name already.
if(NOT TARGET docs)
  configure_file(docs/Doxyfile.in ${CMAKE_BINARY_DIR}/Doxyfile @ONLY)
  add_custom_target(docs COMMAND ${CMAKE_COMMAND} -DDOXYFILE=${CMAKE_BINARY_DIR}/Doxyfile -P ${CMAKE_CURRENT_LIST_FILE} VERBATIM)
endif()
