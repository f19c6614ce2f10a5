// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <string>

#include "record/session_result.h"

namespace cdiff::page {

/// Text of report.html: one self-contained page with verdict, main measures, a picture from above,
/// charts and tables.
std::string htmlReport(const record::SessionResult& result);

/// The page with what other drivers of the ego would have come to below its contacts: sentence by
/// address of the page that shows it. nullopt for a page without the place for it.
std::optional<std::string> withWhatIf(const std::string& page,
                                      const std::map<std::string, std::string>& answers);

}  // namespace cdiff::page
