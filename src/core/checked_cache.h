// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace cdiff::core {

// Files in the cache folder (core/file.h). Several processes may read and store a file at once: all
// store the same, and each file is whole at any time.

/// Path of a file in `folder` of the cache: the SHA-256 of `key`, then `ending`. Makes the folder.
/// Throws InputError where it cannot be made.
std::filesystem::path cacheFile(const std::string& folder, std::string_view key,
                                const std::string& ending);

/// Content of a file; nothing where there is none, or none that can be read.
std::optional<std::string> cachedContent(const std::filesystem::path& file);
/// Replaces whatever has the name but a folder that holds something. Throws InputError.
void storeInCache(const std::filesystem::path& file, std::string_view content);

/// As cachedContent, of a file that storeChecked wrote; nothing where it is another now.
std::optional<std::string> checkedContent(const std::filesystem::path& file);
/// As storeInCache; keeps the SHA-256 in a file beside it.
void storeChecked(const std::filesystem::path& file, std::string_view content);

}  // namespace cdiff::core
