// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Begin of every HTML page: document type and <head> with the common style sheet.
#pragma once

#include <string>

namespace cdiff::report {

/// Up to and with </head>; `title` is escaped here, `style` is CSS after the common sheet.
std::string pageHead(const std::string& title, const std::string& style = "");

}  // namespace cdiff::report
