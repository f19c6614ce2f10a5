# The Debian package of the install space (scripts/package): what sessions need, without trainer, tests and benchmarks.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME e2e-cdiff)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The e2e_cdiff authors <maintainers@e2e-cdiff.org>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "closed-loop traffic scenarios to test a driving system")
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_BINARY_DIR}/package)
# The files lie below the prefix that catkin wrote into its setup files.
set(CPACK_SET_DESTDIR ON)
set(CPACK_INSTALL_PREFIX ${CMAKE_INSTALL_PREFIX})
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
# dpkg-shlibdeps finds the packages of all libraries; these programs and ROS tools are started by name. The setup files find packages of ROS by
# ros-environment.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/devel/lib)
set(CPACK_DEBIAN_PACKAGE_DEPENDS sumo)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "ffmpeg, python3-roslaunch, python3-rosbag, ros-environment, rosout")
# Both have a program /usr/bin/cdiff.
set(CPACK_DEBIAN_PACKAGE_CONFLICTS colordiff)

# scripts/package makes the manual from the program's help.
set(cdiff_manual ${CMAKE_BINARY_DIR}/manual)
set(cdiff_in_path ${CMAKE_BINARY_DIR}/manual/bin/cdiff)
file(MAKE_DIRECTORY ${cdiff_manual}/bin)
if(E2E_CDIFF_PACKAGE)
  file(CREATE_LINK ${CMAKE_INSTALL_PREFIX}/${CATKIN_PACKAGE_BIN_DESTINATION}/cdiff ${cdiff_in_path} SYMBOLIC)
  install(FILES ${cdiff_in_path} DESTINATION /usr/bin)
  install(FILES ${cdiff_manual}/cdiff.1.gz DESTINATION /usr/share/man/man1)
  install(FILES ${cdiff_manual}/cdiff DESTINATION /usr/share/bash-completion/completions)
endif()
include(CPack)
