// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

namespace cdiff::cli {

/// The ids at places I, I+N, I+2N ... for a part "I/N"; all where it is empty. Throws InputError
/// for anything else than whole numbers with 0 <= I < N.
std::vector<std::string> partOf(const std::vector<std::string>& ids, const std::string& part);

}  // namespace cdiff::cli
