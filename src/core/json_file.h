// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <exception>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace cdiff::core {

// JSON that others may have written or damaged.

/// Throws InputError that starts with `source` for a text whose brackets nest deeper than 100: the
/// stack would not hold what copies and walks through such a value need. Call it before the text is
/// parsed.
void requireShallowJson(std::string_view text, const std::string& source);

/// The value in a whole file. Throws InputError as readFile and requireShallowJson do, and
/// nlohmann::json::exception for a file that is not JSON.
nlohmann::json readJson(const std::filesystem::path& file, const std::string& what);

/// What a nlohmann::json::exception says of the text or value, without the library's own names.
std::string jsonFault(const std::exception& error);

}  // namespace cdiff::core
