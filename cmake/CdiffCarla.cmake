# Headers of the messages of CARLA's ROS bridge, from the definitions in msg/carla_msgs, msg/derived_object_msgs and
# msg/shape_msgs. Debian has none of these packages. ROS connects topics by the name of a type and the md5 of its
# definition, and both are the same here (test_node_graph_carla).
set(carla_headers ${CMAKE_BINARY_DIR}/carla_messages)
set(carla_paths)
foreach(package std_msgs geometry_msgs)
  list(APPEND carla_paths -I${package}:${${package}_DIR}/../msg)
endforeach()
foreach(package carla_msgs derived_object_msgs shape_msgs)
  list(APPEND carla_paths -I${package}:${PROJECT_SOURCE_DIR}/msg/${package})
endforeach()
file(GLOB carla_definitions CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/msg/carla_msgs/*.msg
     ${PROJECT_SOURCE_DIR}/msg/derived_object_msgs/*.msg ${PROJECT_SOURCE_DIR}/msg/shape_msgs/*.msg)
set(carla_outputs)
foreach(definition ${carla_definitions})
  get_filename_component(name ${definition} NAME_WE)
  get_filename_component(folder ${definition} DIRECTORY)
  get_filename_component(package ${folder} NAME)
  set(header ${carla_headers}/${package}/${name}.h)
  add_custom_command(OUTPUT ${header} DEPENDS ${carla_definitions}
    COMMAND ${CATKIN_ENV} ${PYTHON_EXECUTABLE} ${GENCPP_BIN} ${definition} ${carla_paths} -p ${package}
            -o ${carla_headers}/${package} -e ${GENCPP_TEMPLATE_DIR}
    COMMENT "Generating C++ code from ${package}/${name}.msg")
  list(APPEND carla_outputs ${header})
endforeach()
add_custom_target(e2e_cdiff_carla_headers DEPENDS ${carla_outputs})

# For the layer node_graph and its tests alone.
add_library(e2e_cdiff_carla_messages INTERFACE)
target_include_directories(e2e_cdiff_carla_messages SYSTEM INTERFACE ${carla_headers})
target_link_libraries(e2e_cdiff_carla_messages INTERFACE e2e_cdiff_messages)
add_dependencies(e2e_cdiff_carla_messages e2e_cdiff_carla_headers)
# Whoever asks for the headers of our messages gets these as well (scripts/check).
add_dependencies(e2e_cdiff_generate_messages_cpp e2e_cdiff_carla_headers)
