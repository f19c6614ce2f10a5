// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The main function of each node; CMakeLists.txt says which.
#include "node_graph/node_main.h"

int main(int argc, char** argv) { return cdiff::node_graph::CDIFF_RUN_NODE(argc, argv); }
