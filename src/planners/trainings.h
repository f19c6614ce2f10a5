// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "learning/task_registry.h"

namespace cdiff::planners {

// The table of training tasks: those of the planners in the list of src/planners/CMakeLists.txt
// that have a sub-folder training/. Free of torch.

/// The task of the diffusion planner first: it is the default.
learning::TaskRegistry packageTrainings();

}  // namespace cdiff::planners
