# Messages and the ROS packages that only the layers node_graph, nodes and cli use; sets where catkin puts
# programs, so it is included before any target. The devel space is <build>/devel.
find_package(catkin REQUIRED COMPONENTS
  diagnostic_msgs diagnostic_updater geometry_msgs message_generation nav_msgs rosbag roscpp
  rosgraph_msgs sensor_msgs std_msgs tf2_msgs visualization_msgs)
# Apart from the others: their exported libraries are all of OpenCV, which every node would load.
find_package(cv_bridge REQUIRED)
find_package(image_transport REQUIRED)
find_library(CDIFF_CV_BRIDGE_LIBRARY cv_bridge REQUIRED)
find_library(CDIFF_IMAGE_TRANSPORT_LIBRARY image_transport REQUIRED)
# Its messages; the library in its exports is of no use here.
find_package(dynamic_reconfigure REQUIRED)
# Its exports are actionlib and all that belongs to it.
find_package(tf2_ros REQUIRED)
find_library(CDIFF_TF2_ROS_LIBRARY tf2_ros REQUIRED)
find_library(CDIFF_TF2_LIBRARY tf2 REQUIRED)

file(GLOB CDIFF_MESSAGES RELATIVE ${PROJECT_SOURCE_DIR}/msg CONFIGURE_DEPENDS
     ${PROJECT_SOURCE_DIR}/msg/*.msg)
add_message_files(DIRECTORY msg FILES ${CDIFF_MESSAGES})
file(GLOB CDIFF_SERVICES RELATIVE ${PROJECT_SOURCE_DIR}/srv CONFIGURE_DEPENDS
     ${PROJECT_SOURCE_DIR}/srv/*.srv)
add_service_files(DIRECTORY srv FILES ${CDIFF_SERVICES})
generate_messages(DEPENDENCIES geometry_msgs std_msgs)

# What planners, objectives and metrics of other packages need (include/e2e_cdiff/plugins/plugin.h).
catkin_package(INCLUDE_DIRS include
               LIBRARIES e2e_cdiff_core e2e_cdiff_geometry e2e_cdiff_map e2e_cdiff_traffic e2e_cdiff_dynamics e2e_cdiff_guidance
                         e2e_cdiff_rendering e2e_cdiff_planning e2e_cdiff_metrics e2e_cdiff_cbv
               CATKIN_DEPENDS geometry_msgs message_runtime std_msgs)
install(DIRECTORY include/e2e_cdiff/ DESTINATION ${CATKIN_PACKAGE_INCLUDE_DESTINATION})

# Python beside the messages: `from e2e_cdiff.pedal_map import pedals_for`.
configure_file(${PROJECT_SOURCE_DIR}/src/dynamics/pedal_map.py
               ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_PYTHON_DESTINATION}/pedal_map.py COPYONLY)
install(FILES ${PROJECT_SOURCE_DIR}/src/dynamics/pedal_map.py DESTINATION ${CATKIN_PACKAGE_PYTHON_DESTINATION})

# The interface that node_graph, nodes, cli and their tests link to see ROS and our messages.
add_library(e2e_cdiff_messages INTERFACE)
target_include_directories(e2e_cdiff_messages SYSTEM INTERFACE
  ${CATKIN_DEVEL_PREFIX}/include ${catkin_INCLUDE_DIRS})
target_link_libraries(e2e_cdiff_messages INTERFACE ${catkin_LIBRARIES})
add_dependencies(e2e_cdiff_messages ${PROJECT_NAME}_generate_messages_cpp)
# In every language: rostopic echo reads those of Python.
add_dependencies(e2e_cdiff_programs ${PROJECT_NAME}_generate_messages)
add_dependencies(e2e_cdiff_session_programs ${PROJECT_NAME}_generate_messages)

# Images as messages, for the layer node_graph alone.
add_library(e2e_cdiff_images INTERFACE)
target_include_directories(e2e_cdiff_images SYSTEM INTERFACE
  ${cv_bridge_INCLUDE_DIRS} ${image_transport_INCLUDE_DIRS})
target_link_libraries(e2e_cdiff_images INTERFACE
  ${CDIFF_CV_BRIDGE_LIBRARY} ${CDIFF_IMAGE_TRANSPORT_LIBRARY} opencv_core)

# Transforms, for the layer node_graph alone.
add_library(e2e_cdiff_transforms INTERFACE)
target_include_directories(e2e_cdiff_transforms SYSTEM INTERFACE ${tf2_ros_INCLUDE_DIRS})
target_link_libraries(e2e_cdiff_transforms INTERFACE ${CDIFF_TF2_ROS_LIBRARY} ${CDIFF_TF2_LIBRARY})

# Type maps for SUMO's netconvert.
file(MAKE_DIRECTORY ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION})
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/sumo ${CATKIN_DEVEL_PREFIX}/${CATKIN_PACKAGE_SHARE_DESTINATION}/sumo SYMBOLIC)
catkin_add_env_hooks(50.e2e_cdiff SHELLS sh DIRECTORY ${PROJECT_SOURCE_DIR}/env-hooks)

foreach(folder config launch networks rviz sumo weights)
  if(EXISTS ${PROJECT_SOURCE_DIR}/${folder})
    install(DIRECTORY ${folder}/ DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/${folder})
  endif()
endforeach()
file(GLOB CDIFF_SCRIPTS LIST_DIRECTORIES false CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scripts/*)
install(PROGRAMS ${CDIFF_SCRIPTS} DESTINATION ${CATKIN_PACKAGE_SHARE_DESTINATION}/scripts)
