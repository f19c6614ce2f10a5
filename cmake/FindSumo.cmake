# SUMO's C++ client of its TraCI protocol (Sumo::traci), and SUMO as a library (Sumo::sumo) where it is there; Debian's package ships
# headers and libraries without a CMake file.
find_path(Sumo_INCLUDE_DIR libsumo/libtraci.h)
find_library(Sumo_traci_LIBRARY tracicpp)
find_library(Sumo_sumo_LIBRARY sumocpp)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Sumo REQUIRED_VARS Sumo_traci_LIBRARY Sumo_INCLUDE_DIR)
foreach(name traci sumo)
  if(Sumo_FOUND AND Sumo_${name}_LIBRARY AND NOT TARGET Sumo::${name})
    add_library(Sumo::${name} UNKNOWN IMPORTED)
    set_target_properties(Sumo::${name} PROPERTIES IMPORTED_LOCATION ${Sumo_${name}_LIBRARY}
                          INTERFACE_INCLUDE_DIRECTORIES ${Sumo_INCLUDE_DIR})
  endif()
endforeach()
