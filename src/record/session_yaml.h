// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "record/session_result.h"

namespace cdiff::record {

/// Text of session.yaml: the resolved scenario, seeds, and what it ran on (package, simulator,
/// network, libraries, processor).
std::string sessionYaml(const session::SessionSetup& setup, const RunFacts& facts);

}  // namespace cdiff::record
