// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace cdiff::core {

// Numbers and names as text: shortest round-trip decimals, numbers from text, parts of texts.

/// Shortest decimal that reads back to the same double; "nan", "inf" and "-inf" for the rest.
std::string formatNumber(double value);

/// `value` with a fixed number of decimals, for people.
std::string formatFixed(double value, int decimals);

/// The whole text as a finite double; nullopt when anything else is in it.
std::optional<double> parseNumber(std::string_view text);

/// `text` cut to at most `length` bytes; "..." follows where it was longer. For quotes in messages.
std::string shortened(const std::string& text, std::size_t length = 80);

/// `text` with every character that is not a letter, digit, '_', '-' or '.' replaced by '_', and
/// without leading dots: safe as a file name.
std::string fileName(std::string text);

/// Parts of `text` between separators; runs of separators count as one, no empty parts.
std::vector<std::string> splitText(std::string_view text, char separator);

/// `text` with small letters for the capitals of ASCII.
std::string lowerCase(std::string_view text);

/// Whether `text` ends with `end`.
bool endsWith(std::string_view text, std::string_view end);

/// The parts with a separator between them.
std::string joinText(const std::vector<std::string>& parts, std::string_view separator);

}  // namespace cdiff::core
