// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>

#include "diffusion/denoiser.h"
#include "diffusion/model.h"
#include "inference/instruction_set.h"

namespace cdiff::diffusion {

/// The denoiser on a CPU: a compact fused path with its own convolutions (AVX-512, AVX2 or plain,
/// chosen at run time), forward and vector-Jacobian product. Inference only.
class CpuDenoiser : public Denoiser {
 public:
  using InstructionSet = inference::InstructionSet;
  /// The best one of this machine; E2E_CDIFF_ISA=plain|avx2|avx512 lowers it.
  static InstructionSet bestInstructionSet();
  static std::string toText(InstructionSet instruction_set);

  explicit CpuDenoiser(const Model& model, InstructionSet instruction_set = bestInstructionSet());
  ~CpuDenoiser() override;

  const Architecture& architecture() const override;
  void setContexts(const std::vector<Context>& contexts) override;
  void predictActions(const float* noisy, int k, float* actions) override;
  void backwardActions(const float* action_gradient, float* noisy_gradient) override;
  void predictStates(const float* actions, int k, float* states) override;
  void backwardStates(const float* state_gradient, float* action_gradient) override;

 private:
  struct Network;
  std::unique_ptr<Network> network_;
};

}  // namespace cdiff::diffusion
