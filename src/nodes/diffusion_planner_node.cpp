// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Drives all CBVs where their planner sees: cbv_planner_node under another name.
#include "ros/node_main.h"

int main(int argc, char** argv) { return cdiff::ros::runDiffusionPlannerNode(argc, argv); }
