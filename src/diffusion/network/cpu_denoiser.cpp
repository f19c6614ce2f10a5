// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/cpu_denoiser.h"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

#include "diffusion/network/conditioning.h"
#include "diffusion/network/heads.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

using InstructionSet = CpuDenoiser::InstructionSet;

constexpr InstructionSet kInstructionSets[] = {InstructionSet::kPlain, InstructionSet::kAvx2,
                                               InstructionSet::kAvx512};

/// nullptr where compiler or CPU lack it.
const inference::DenoiserKernels* kernelsOf(InstructionSet instruction_set) {
#if defined(__x86_64__)
  if (instruction_set == InstructionSet::kAvx512) {
    return __builtin_cpu_supports("avx512f") ? inference::avx512Kernels() : nullptr;
  }
  if (instruction_set == InstructionSet::kAvx2) {
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")
               ? inference::avx2Kernels()
               : nullptr;
  }
#endif
  return instruction_set == InstructionSet::kPlain ? inference::plainKernels() : nullptr;
}

const inference::DenoiserKernels& requiredKernels(InstructionSet instruction_set) {
  if (const inference::DenoiserKernels* kernels = kernelsOf(instruction_set)) return *kernels;
  throw core::InputError("this CPU lacks the instruction set " +
                         CpuDenoiser::toText(instruction_set));
}

InstructionSet instructionSetNamed(const std::string& name) {
  for (const InstructionSet known : kInstructionSets) {
    if (CpuDenoiser::toText(known) == name) return known;
  }
  throw core::InputError("E2E_CDIFF_ISA is '" + name + "'; plain, avx2 or avx512 was expected");
}

void requireDenoiserTensors(const Model& model) {
  model.architecture.validate();
  for (const inference::TensorShape& expected : denoiserTensors(model.architecture)) {
    if (inference::tensorNamed(model.denoiser, expected.name).shape == expected.shape) continue;
    throw core::InputError("the denoiser's tensor '" + expected.name +
                           "' does not have the shape of its architecture");
  }
}

}  // namespace

struct CpuDenoiser::Network {
  Network(const Model& model, const inference::DenoiserKernels& kernels)
      : architecture(model.architecture),
        unet(kernels, architecture, model.denoiser),
        conditioning(kernels, architecture, model.denoiser, unet.injections()),
        state_head(kernels, architecture, model.denoiser, conditioning.timeEmbeddings()) {}

  void requireStep(int k) const {
    if (!ready) throw std::logic_error("the denoiser was asked before setContexts");
    if (k >= 1 && k <= architecture.diffusion_steps) return;
    throw std::invalid_argument("diffusion step " + std::to_string(k) + " is not in 1.." +
                                std::to_string(architecture.diffusion_steps));
  }

  Architecture architecture;
  UNet unet;
  Conditioning conditioning;
  StateHead state_head;
  bool ready = false;              ///< contexts are set
  bool actions_predicted = false;  ///< since then
  bool states_predicted = false;   ///< since then
};

InstructionSet CpuDenoiser::bestInstructionSet() {
  InstructionSet best = InstructionSet::kPlain;
  for (const InstructionSet candidate : kInstructionSets) {
    if (kernelsOf(candidate)) best = candidate;
  }
  const char* wanted = std::getenv("E2E_CDIFF_ISA");
  return wanted ? std::min(best, instructionSetNamed(wanted)) : best;
}

std::string CpuDenoiser::toText(InstructionSet instruction_set) {
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

CpuDenoiser::CpuDenoiser(const Model& model, InstructionSet instruction_set) {
  const inference::DenoiserKernels& kernels = requiredKernels(instruction_set);
  requireDenoiserTensors(model);
  network_ = std::make_unique<Network>(model, kernels);
}

CpuDenoiser::~CpuDenoiser() = default;

const Architecture& CpuDenoiser::architecture() const { return network_->architecture; }

void CpuDenoiser::setContexts(const std::vector<Context>& contexts) {
  network_->conditioning.setContexts(contexts);
  network_->state_head.setContexts(contexts);
  network_->unet.resize(static_cast<std::int64_t>(contexts.size()));
  network_->ready = true;
  network_->actions_predicted = network_->states_predicted = false;
}

void CpuDenoiser::predictActions(const float* noisy, int k, float* actions) {
  network_->requireStep(k);
  network_->unet.forward(noisy, network_->conditioning.injection(k), actions);
  network_->actions_predicted = true;
}

void CpuDenoiser::pullBackActions(const float* action_gradient, float* noisy_gradient) {
  if (!network_->actions_predicted) {
    throw std::logic_error("pullBackActions was called before predictActions");
  }
  network_->unet.pullBack(action_gradient, noisy_gradient);
}

void CpuDenoiser::predictStates(const float* actions, int k, float* states) {
  network_->requireStep(k);
  network_->state_head.forward(actions, k, states);
  network_->states_predicted = true;
}

void CpuDenoiser::pullBackStates(const float* state_gradient, float* action_gradient) {
  if (!network_->states_predicted) {
    throw std::logic_error("pullBackStates was called before predictStates");
  }
  network_->state_head.pullBack(state_gradient, action_gradient);
}

}  // namespace cdiff::diffusion
