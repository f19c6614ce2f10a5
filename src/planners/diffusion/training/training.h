// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What the table of training tasks needs of this planner; free of torch.
#pragma once

#include "learning/task_registry.h"

namespace cdiff::planners {

/// The task "diffusion".
learning::TaskDescriptor diffusionTraining();

}  // namespace cdiff::planners
