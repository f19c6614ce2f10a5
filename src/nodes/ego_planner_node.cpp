// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Drives the ego.
#include "ros/node_main.h"

int main(int argc, char** argv) { return cdiff::ros::runEgoPlannerNode(argc, argv); }
