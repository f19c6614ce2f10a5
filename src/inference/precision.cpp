// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/precision.h"

#include <oneapi/dnnl/dnnl.hpp>

#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::inference {
namespace {

using dnnl::cpu_isa;

/// Instruction sets of oneDNN from the weakest to the strongest.
struct NamedIsa {
  cpu_isa isa;
  const char* name;
};
constexpr NamedIsa kIsas[] = {{cpu_isa::sse41, "sse41"},
                              {cpu_isa::avx, "avx"},
                              {cpu_isa::avx2, "avx2"},
                              {cpu_isa::avx2_vnni, "avx2_vnni"},
                              {cpu_isa::avx512_core, "avx512_core"},
                              {cpu_isa::avx512_core_vnni, "avx512_core_vnni"},
                              {cpu_isa::avx512_core_bf16, "avx512_core_bf16"},
                              {cpu_isa::avx512_core_amx, "avx512_core_amx"}};

/// Place in kIsas; -1 for one that is not there.
int rankOf(cpu_isa isa) {
  int rank = 0;
  for (const NamedIsa& known : kIsas) {
    if (known.isa == isa) return rank;
    ++rank;
  }
  return -1;
}

/// What oneDNN computes with under `isa`; AVX2 is held to itself, AVX-512 to nothing. Asking fixes
/// oneDNN's choice for this process, so it is held to AVX2 before.
cpu_isa effectiveIsa(const std::string& isa) {
  if (isa == "avx2") dnnl::set_max_cpu_isa(cpu_isa::avx2);
  return dnnl::get_effective_cpu_isa();
}

bool atLeast(const std::string& isa, cpu_isa needed) {
  if (isa == "avx2" && rankOf(needed) > rankOf(cpu_isa::avx2)) return false;
  return rankOf(effectiveIsa(isa)) >= rankOf(needed);
}

void require(const std::string& name, const std::string& isa, cpu_isa needed,
             const std::string& key) {
  if (atLeast(isa, needed)) return;
  throw core::InputError("key '" + key + "' is '" + name + "', which needs " +
                         kIsas[rankOf(needed)].name + "; here convolutions are computed with " +
                         oneDnnInstructionSet(isa) +
                         (isa == "auto" ? "" : " (key isa: " + isa + ")") +
                         ". Set it to fp32, or to auto, which takes what this processor has");
}

}  // namespace

std::string toText(Precision precision) {
  switch (precision) {
    case Precision::kFp32:
      return "fp32";
    case Precision::kBf16:
      return "bf16";
    case Precision::kInt8:
      return "int8";
  }
  return "unknown";
}

Precision precisionNamed(const std::string& name, const std::string& isa, const std::string& key) {
  if (name == "auto")
    return atLeast(isa, cpu_isa::avx512_core_vnni) ? Precision::kInt8 : Precision::kFp32;
  if (name == "int8") require(name, isa, cpu_isa::avx512_core_vnni, key);
  if (name == "bf16") require(name, isa, cpu_isa::avx512_core_bf16, key);
  if (name == "int8") return Precision::kInt8;
  return name == "bf16" ? Precision::kBf16 : Precision::kFp32;
}

InstructionSet instructionSetNamed(const std::string& isa, const std::string& key) {
  const InstructionSet best = bestInstructionSet();
  if (isa == "auto") return best;
  const InstructionSet wanted = isa == "avx2" ? InstructionSet::kAvx2 : InstructionSet::kAvx512;
  if (wanted <= best) return wanted;
  throw core::InputError("key '" + key + "' is '" + isa + "'; this processor has " + toText(best) +
                         " at most (or E2E_CDIFF_ISA says so)");
}

void pinOneDnn(const std::string& isa, const std::string& key) {
  if (isa == "avx512" && rankOf(effectiveIsa(isa)) < rankOf(cpu_isa::avx512_core)) {
    throw core::InputError("key '" + key + "' is 'avx512', but convolutions are computed with " +
                           oneDnnInstructionSet(isa) +
                           " here: the processor has no more, or ONEDNN_MAX_CPU_ISA says so");
  }
  if (isa != "avx2" || rankOf(effectiveIsa(isa)) <= rankOf(cpu_isa::avx2)) return;
  throw core::InputError("key '" + key +
                         "' is 'avx2', but another network of this process already "
                         "computes with " +
                         oneDnnInstructionSet("auto") +
                         "; set the same isa for all planners, or ONEDNN_MAX_CPU_ISA=AVX2");
}

std::string oneDnnInstructionSet(const std::string& isa) {
  const cpu_isa effective = effectiveIsa(isa);
  const int rank = rankOf(effective);
  return rank < 0 ? "isa_" + std::to_string(static_cast<int>(effective)) : kIsas[rank].name;
}

std::string oneDnnInstructionSet(const std::string& isa, Precision precision) {
  for (const cpu_isa enough : {cpu_isa::avx512_core_vnni, cpu_isa::avx512_core, cpu_isa::avx2}) {
    const bool counts = enough != cpu_isa::avx512_core_vnni || precision == Precision::kInt8;
    if (precision != Precision::kBf16 && counts && atLeast(isa, enough))
      return kIsas[rankOf(enough)].name;
  }
  return oneDnnInstructionSet(isa);
}

}  // namespace cdiff::inference
