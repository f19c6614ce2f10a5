// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

namespace cdiff::cli {

// What `cdiff --version` prints.

/// Package version and revision, SUMO's version, and the instruction sets that the program was
/// compiled for and that its networks use on this machine; a line each.
std::string versionText();

}  // namespace cdiff::cli
