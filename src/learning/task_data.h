// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <iosfwd>

#include "learning/samples/dataset.h"
#include "learning/training_options.h"

namespace cdiff::learning {

/// The samples that a task learns from: the shards of its data folder, or what the task makes of
/// the scenes there. Throws InputError naming the task and what to do where there is none or a
/// field that it needs is missing, and core::Interrupted after `stop`.
Dataset readData(const Training& training, const std::atomic<bool>& stop, std::ostream& log);

}  // namespace cdiff::learning
