// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "inference/safetensors.h"

namespace cdiff::inference {

inline constexpr const char* kMetadataKey = "__metadata__";
inline constexpr const char* kChecksumKey = "sha256";

/// Where a tensor lies in the data section.
struct TensorEntry {
  std::string name;
  TensorType type = TensorType::kF32;
  std::vector<std::int64_t> shape;
  std::uint64_t begin = 0;  ///< [byte]
  std::uint64_t end = 0;    ///< [byte]
};

/// The JSON header of a safetensors file, checked against the size of the file [bytes]; no tensor
/// is read here.
struct SafetensorsHeader {
  std::map<std::string, std::string> metadata;
  std::vector<TensorEntry> entries;  ///< in the order of the data section, without gap or overlap
};

/// `source` starts every error; `data_size` is what the file holds after the header.
SafetensorsHeader parseHeader(std::string_view text, std::uint64_t data_size,
                              const std::string& source);

/// Throws InputError naming the first tensor that is missing, unknown or of another shape.
void requireExpected(const SafetensorsHeader& header, const std::vector<TensorShape>& expected,
                     const std::string& source);

std::uint64_t bytesOf(TensorType type);
/// "[3, 4]".
std::string shapeText(const std::vector<std::int64_t>& shape);

/// Throws core::InputError "SOURCE: WHAT".
[[noreturn]] void failOn(const std::string& source, const std::string& what);

}  // namespace cdiff::inference
