# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
# Sourced by setup.sh. `cdiff` goes into PATH from where rosrun finds it: a second program of that name, in bin, would make rosrun ask.
case ":$PATH:" in
  *":$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:"*) ;;
  *) export PATH="$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:$PATH" ;;
esac
# The panel of rviz, once it is built, is a package of its own beside what catkin makes.
if [ -f "$CATKIN_ENV_HOOK_WORKSPACE/share/e2e_cdiff_rviz/package.xml" ]; then
  case ":$ROS_PACKAGE_PATH:" in
    *":$CATKIN_ENV_HOOK_WORKSPACE/share:"*) ;;
    *) export ROS_PACKAGE_PATH="$CATKIN_ENV_HOOK_WORKSPACE/share${ROS_PACKAGE_PATH:+:$ROS_PACKAGE_PATH}" ;;
  esac
fi
