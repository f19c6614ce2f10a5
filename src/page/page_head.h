// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// What every HTML page has: document type and <head> with the common style sheet, sections, and
/// the banner with an outcome.
#pragma once

#include <string>

#include "record/verdict.h"

namespace cdiff::page {

/// Up to and with </head>; `title` is escaped here, `style` is CSS after the common sheet.
std::string pageHead(const std::string& title, const std::string& style = "");

/// A <section> with a heading; `style`: its class, or none. `title` is escaped here.
std::string pageSection(const std::string& title, const std::string& content,
                        const std::string& style = "");

/// The sign of an outcome and `headline`, in its colours, above `content`.
std::string pageBanner(record::Outcome outcome, const std::string& headline,
                       const std::string& content);

}  // namespace cdiff::page
