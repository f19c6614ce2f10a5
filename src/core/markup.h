// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Text that is safe inside XML and HTML, and coordinates as short decimals.
#pragma once

#include <string>
#include <string_view>

namespace cdiff::core {

/// `text` for content and quoted attributes: & < > " ' escaped; control characters that XML forbids
/// and bytes that are not UTF-8 replaced by U+FFFD.
std::string escapeMarkup(std::string_view text);

/// `value` with one decimal at most ("12", "12.3"), for pictures.
std::string shortNumber(double value);

}  // namespace cdiff::core
