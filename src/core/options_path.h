// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "e2e_cdiff/core/options.h"

namespace cdiff::core::detail {

// The keys of an options struct with those of its groups before them: "cbv.search_radius".

/// The full key that `key` means: itself, or the one whose last part it is. Throws InputError that
/// names `source` and the nearest key, or the keys among which it is ambiguous.
std::string resolvePath(const std::string& key, const std::string& source, void* options,
                        Describe describe);

/// How loading, checking and dumping of options write a range of values: "[0, 10000000] m".
std::string rangeText(double low, double high, const char* unit);

}  // namespace cdiff::core::detail
