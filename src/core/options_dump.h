// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// How loading and dumping of options write a range of values.
#pragma once

#include <string>

namespace cdiff::core::detail {

/// "[0, 1] m"
std::string rangeText(const std::string& low, const std::string& high, const char* unit);

}  // namespace cdiff::core::detail
