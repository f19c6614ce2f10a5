# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
# Sourced by setup.sh. `cdiff` goes into PATH from where rosrun finds it: a second program of that name, in bin, would make rosrun ask.
case ":$PATH:" in
  *":$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:"*) ;;
  *) export PATH="$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:$PATH" ;;
esac
