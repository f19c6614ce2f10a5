// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>

namespace cdiff::core {

/// SHA-256 of a file's content. A process that keeps content (core/kept_content.h) does not read a
/// file again whose identity, size and times of change are still the same. A file that was changed
/// within the last seconds is read again. `what` is what the file holds. Throws as readFile does.
std::string keptSha256(const std::filesystem::path& file, const std::string& what);

}  // namespace cdiff::core
