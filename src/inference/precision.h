// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "inference/instruction_set.h"

namespace cdiff::inference {

/// What the convolutions of an image encoder multiply. Sums, normalization, residual sums and
/// whatever else lies between two convolutions are float32 in each.
enum class Precision {
  kFp32,  ///< float32 x float32
  kBf16,  ///< bfloat16 x bfloat16, summed in float32
  kInt8   ///< unsigned bytes x signed bytes, summed exactly in int32
};

std::string toText(Precision precision);

/// The one that a key asks for: `auto` is int8 where the processor multiplies bytes (AVX-512 VNNI),
/// else fp32. Throws InputError naming `key`, and the instructions that this processor lacks (or
/// that `isa`, auto | avx2 | avx512, rules out).
Precision precisionNamed(const std::string& name, const std::string& isa, const std::string& key);

/// Instruction set of the kernels for a key `isa`: auto is the best one of this machine. Throws
/// InputError naming `key` where the processor lacks it.
InstructionSet instructionSetNamed(const std::string& isa, const std::string& key);

/// Holds oneDNN to `isa` in this process (auto and avx512: to nothing). oneDNN chooses once: throws
/// InputError naming `key` where something in this process has made it choose another one before,
/// and for an avx512 that it does not compute with.
void pinOneDnn(const std::string& isa, const std::string& key);

/// Instruction set that oneDNN computes with under `isa`, as in avx512_core_vnni.
std::string oneDnnInstructionSet(const std::string& isa);

/// The part of it that the bytes of an encoder depend on, for records: float32 and bytes come to
/// the same on all processors that have avx512_core and avx512_core_vnni, whatever else they have.
std::string oneDnnInstructionSet(const std::string& isa, Precision precision);

}  // namespace cdiff::inference
