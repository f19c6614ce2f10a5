# Clipper 6: union and offsetting of polygons on an integer grid (Debian: libpolyclipping-dev).
find_path(Clipper_INCLUDE_DIR polyclipping/clipper.hpp)
find_library(Clipper_LIBRARY polyclipping)
include(FindPackageHandleStandardArgs)
find_package_handle_standard_args(Clipper REQUIRED_VARS Clipper_LIBRARY Clipper_INCLUDE_DIR)
if(Clipper_FOUND AND NOT TARGET Clipper::clipper)
  add_library(Clipper::clipper UNKNOWN IMPORTED)
  set_target_properties(Clipper::clipper PROPERTIES IMPORTED_LOCATION ${Clipper_LIBRARY}
                        INTERFACE_INCLUDE_DIRECTORIES ${Clipper_INCLUDE_DIR})
endif()
