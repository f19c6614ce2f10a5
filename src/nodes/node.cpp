// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The main function of each node; CMakeLists.txt says which.
#include "ros/node_main.h"

int main(int argc, char** argv) { return cdiff::ros::CDIFF_RUN_NODE(argc, argv); }
