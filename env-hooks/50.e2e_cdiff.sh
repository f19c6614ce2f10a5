# SPDX-License-Identifier: BSD-3-Clause
# Copyright (c) 2026 The e2e_cdiff authors
# Sourced by setup.sh: SUMO's programs need SUMO_HOME to be a folder, and look for type maps there. Debian's package sumo names
# one that does not exist.
if [ ! -d "${SUMO_HOME:-}" ]; then
  export SUMO_HOME="$CATKIN_ENV_HOOK_WORKSPACE/share/e2e_cdiff/sumo"
fi
