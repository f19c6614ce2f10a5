// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>

#include "inference/encoder_kernels.h"
#include "inference/transformer_kernels.h"

namespace cdiff::inference {

/// Which vector instructions of the processor the kernels use; a later one is faster.
enum class InstructionSet { kPlain, kAvx2, kAvx512 };

/// The best one of this machine; E2E_CDIFF_ISA=plain|avx2|avx512 lowers it. Throws InputError for
/// another value.
InstructionSet bestInstructionSet();
std::string toText(InstructionSet instruction_set);

/// Throw InputError where compiler or processor lack the instruction set.
const DenoiserKernels& denoiserKernels(InstructionSet instruction_set);
const EncoderKernels& encoderKernels(InstructionSet instruction_set);
const TransformerKernels& transformerKernels(InstructionSet instruction_set);

}  // namespace cdiff::inference
