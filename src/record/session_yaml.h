// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "record/session_result.h"

namespace cdiff::record {

// What this binary was built from and runs on, for the record of a session.

/// Version of the package, "unknown" when the build did not give one.
std::string packageVersion();
/// Git revision at configure time, or "unknown".
std::string packageRevision();
/// (name, version) of the libraries and the compiler that decide results.
std::vector<std::pair<std::string, std::string>> libraryVersions();
/// Model name of the processor, or "unknown".
std::string processorModel();
/// Instruction set that the binary was compiled for, e.g. "x86-64 baseline".
std::string instructionSet();

/// Text of session.yaml: the resolved scenario, seeds, and what it ran on (package, simulator,
/// network, libraries, processor).
std::string sessionYaml(const session::SessionSetup& setup, const RunFacts& facts);

}  // namespace cdiff::record
