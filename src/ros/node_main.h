// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the main functions of the nodes share: signals, ROS, and errors as one line and an exit
/// code (as `cdiff`: 2 run time, 3 bad input).
#pragma once

#include <functional>

#include "ros/lockstep/stop_signal.h"

namespace cdiff::ros {

/// Starts ROS under a default node name and runs `body`; `without_master`, where given, gives the
/// exit code when no ROS master answers.
int runNode(int argc, char** argv, const char* name, const std::function<int(StopSignal&)>& body,
            const std::function<int()>& without_master = {});

/// Whether the ROS master answers within two seconds.
bool masterAnswers();

}  // namespace cdiff::ros
