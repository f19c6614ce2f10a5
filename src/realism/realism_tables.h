// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "realism/matched_realism.h"
#include "realism/pooled_realism.h"

namespace cdiff::realism {

// Both comparisons of realism as texts: JSON, a table in Markdown, and a page of its own.

std::string matchedJson(const std::vector<MatchedRow>& rows, const ContinuationOptions& options);
std::string matchedMarkdown(const std::vector<MatchedRow>& rows,
                            const ContinuationOptions& options);
std::string matchedPage(const std::vector<MatchedRow>& rows, const ContinuationOptions& options);

std::string pooledJson(const PooledResult& result);
std::string pooledMarkdown(const PooledResult& result);
std::string pooledPage(const PooledResult& result);

}  // namespace cdiff::realism
