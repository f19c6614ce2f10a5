// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

namespace cdiff::core {

// Names that were meant where an unknown one was written.

/// The known name with the smallest edit distance to `name`; empty when `known` is empty.
std::string nearestName(const std::string& name, const std::vector<std::string>& known);

/// Like nearestName, but empty unless at most a third of the letters differ or the known name
/// contains `name`: close enough to suggest.
std::string closeName(const std::string& name, const std::vector<std::string>& known);

/// "; did you mean 'NAME'?" with the close name; empty when there is none.
std::string didYouMean(const std::string& name, const std::vector<std::string>& known);

}  // namespace cdiff::core
