# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
# Sourced by setup.sh. `cdiff` goes into PATH from where rosrun finds it: a second program of that name, in bin, would make rosrun ask.
case ":$PATH:" in
  *":$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:"*) ;;
  *) export PATH="$CATKIN_ENV_HOOK_WORKSPACE/lib/e2e_cdiff:$PATH" ;;
esac
# SUMO's programs need SUMO_HOME to be a folder, and look for type maps there. Debian's package sumo names
# one that does not exist.
if [ ! -d "${SUMO_HOME:-}" ]; then
  export SUMO_HOME="$CATKIN_ENV_HOOK_WORKSPACE/share/e2e_cdiff/sumo"
fi
