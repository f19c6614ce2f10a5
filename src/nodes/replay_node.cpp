// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Replays a recorded session under the traffic simulator's name, to which the other nodes listen.
#include "ros/node_main.h"

int main(int argc, char** argv) { return cdiff::ros::runReplayNode(argc, argv); }
