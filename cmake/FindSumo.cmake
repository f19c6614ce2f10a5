# SUMO's C++ client of its TraCI protocol; Debian's package ships headers and library without a CMake file.
find_path(Sumo_INCLUDE_DIR libsumo/libtraci.h)
find_library(Sumo_LIBRARY tracicpp)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Sumo REQUIRED_VARS Sumo_LIBRARY Sumo_INCLUDE_DIR)
if(Sumo_FOUND AND NOT TARGET Sumo::traci)
  add_library(Sumo::traci UNKNOWN IMPORTED)
  set_target_properties(Sumo::traci PROPERTIES IMPORTED_LOCATION ${Sumo_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${Sumo_INCLUDE_DIR})
endif()
