// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace cdiff::inference {

// Safetensors files: 8 bytes header length (little endian), JSON header, raw tensors. Strict:
// every check happens before anything large is allocated.

/// A tensor that a weight file must hold.
struct TensorShape {
  std::string name;
  std::vector<std::int64_t> shape;
};

/// A tensor as computed with: float32, row-major.
struct Tensor {
  std::vector<std::int64_t> shape;
  std::vector<float> values;
};

/// Content of a safetensors file: metadata, and tensors by name.
struct SafetensorsFile {
  std::map<std::string, std::string> metadata;
  std::map<std::string, Tensor> tensors;
};

/// Reads a file whose tensors must be exactly `expected` (given the file's own metadata), in F16 or
/// F32. Refused with an InputError that names file, tensor or key and what was expected: no such
/// file, truncated or trailing bytes, header too long (8 MiB) or not JSON, duplicate or foreign
/// keys, unknown type, wrong shape, offsets that overlap, leave gaps or do not fit shape and type,
/// missing or unknown tensors, a data section of more than 4 GiB, metadata "sha256" that is not the
/// hash of the data section (required), values that are not finite. Memory for tensors is taken
/// only after all but the last of these.
SafetensorsFile readSafetensors(
    const std::filesystem::path& file,
    const std::function<std::vector<TensorShape>(const std::map<std::string, std::string>&)>&
        expected);

/// The type in which floating-point tensors are stored: 16 or 32 bits.
enum class TensorType { kF16, kF32 };

/// Writes a file of the program's own (core::OutputFolder), tensors by name, with metadata "sha256"
/// of the data section added, which is returned. F16 rounds to nearest even; a value out of its
/// range throws InputError naming the tensor.
std::string writeSafetensors(const std::filesystem::path& file, const SafetensorsFile& content,
                             TensorType type);

}  // namespace cdiff::inference
