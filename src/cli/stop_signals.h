// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Ctrl-C and SIGTERM as a flag that long-running commands look at.
#pragma once

#include <atomic>

namespace cdiff::cli {

/// From now on SIGINT and SIGTERM set the flag returned, instead of ending the process. Clears it.
const std::atomic<bool>& catchStopSignals();

}  // namespace cdiff::cli
