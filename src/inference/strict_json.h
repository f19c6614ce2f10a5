// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace cdiff::inference {

// JSON text of weight files as a value, refused where files from outside could mislead or exhaust
// the reader: duplicate keys, deep nesting, too many values.

using Json = nlohmann::json;

/// Throws InputError that starts with `source` when `text` is not JSON, repeats a key of an object,
/// nests deeper than 8, holds more than 65536 values and keys, a key of more than 256 bytes or a
/// string (or a stretch without strings) of more than 1 MiB.
Json parseStrictJson(std::string_view text, const std::string& source);

/// What kind of value it is, for errors: "a string", "an array" ...
std::string kindOf(const Json& value);

/// At most the first 100 bytes of a text from a file, for errors.
std::string excerpt(const std::string& text);

}  // namespace cdiff::inference
