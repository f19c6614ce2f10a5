// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/instruction_set.h"

#include <algorithm>
#include <cstdlib>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::inference {
namespace {

constexpr InstructionSet kInstructionSets[] = {InstructionSet::kPlain, InstructionSet::kAvx2,
                                               InstructionSet::kAvx512};

bool processorHas(InstructionSet instruction_set) {
#if defined(__x86_64__)
  if (instruction_set == InstructionSet::kAvx512) return __builtin_cpu_supports("avx512f");
  if (instruction_set == InstructionSet::kAvx2)
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
#endif
  return instruction_set == InstructionSet::kPlain;
}

/// nullptr where compiler or processor lack it.
template <class Kernels>
const Kernels* kernelsOf(InstructionSet instruction_set, const Kernels* plain, const Kernels* avx2,
                         const Kernels* avx512) {
  if (!processorHas(instruction_set)) return nullptr;
  if (instruction_set == InstructionSet::kPlain) return plain;
  return instruction_set == InstructionSet::kAvx2 ? avx2 : avx512;
}

const DenoiserKernels* knownKernels(InstructionSet set) {
  return kernelsOf(set, plainKernels(), avx2Kernels(), avx512Kernels());
}

template <class Kernels>
const Kernels& required(const Kernels* kernels, InstructionSet instruction_set) {
  if (kernels != nullptr) return *kernels;
  throw core::InputError("this CPU lacks the instruction set " + toText(instruction_set));
}

InstructionSet instructionSetNamed(const std::string& name) {
  for (const InstructionSet known : kInstructionSets) {
    if (toText(known) == name) return known;
  }
  throw core::InputError("E2E_CDIFF_ISA is '" + name + "'; plain, avx2 or avx512 was expected");
}

}  // namespace

InstructionSet bestInstructionSet() {
  InstructionSet best = InstructionSet::kPlain;
  for (const InstructionSet candidate : kInstructionSets) {
    if (knownKernels(candidate) != nullptr) best = candidate;
  }
  const char* wanted = std::getenv("E2E_CDIFF_ISA");
  return wanted ? std::min(best, instructionSetNamed(wanted)) : best;
}

std::string toText(InstructionSet instruction_set) {
  switch (instruction_set) {
    case InstructionSet::kPlain:
      return "plain";
    case InstructionSet::kAvx2:
      return "avx2";
    case InstructionSet::kAvx512:
      return "avx512";
  }
  return "unknown";
}

const DenoiserKernels& denoiserKernels(InstructionSet instruction_set) {
  return required(knownKernels(instruction_set), instruction_set);
}

const EncoderKernels& encoderKernels(InstructionSet instruction_set) {
  return required(kernelsOf(instruction_set, plainEncoderKernels(), avx2EncoderKernels(),
                            avx512EncoderKernels()),
                  instruction_set);
}

const TransformerKernels& transformerKernels(InstructionSet instruction_set) {
  return required(kernelsOf(instruction_set, plainTransformerKernels(), avx2TransformerKernels(),
                            avx512TransformerKernels()),
                  instruction_set);
}

}  // namespace cdiff::inference
