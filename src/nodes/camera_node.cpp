// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Renders what the driven vehicles see.
#include "ros/node_main.h"

int main(int argc, char** argv) { return cdiff::ros::runCameraNode(argc, argv); }
