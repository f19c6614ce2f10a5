// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

namespace cdiff::cli {

/// The runs of a plan that `cdiff worker --part I/N` takes: those at places I, I+N, I+2N ...,
/// counted from 0; all of them where `part` is empty. Throws InputError for anything else than
/// whole numbers with 0 <= I < N.
std::vector<std::string> partOf(const std::vector<std::string>& ids, const std::string& part);

}  // namespace cdiff::cli
