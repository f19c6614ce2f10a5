// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "diffusion/network/cpu_denoiser.h"

#include <stdexcept>

#include "diffusion/network/conditioning.h"
#include "diffusion/network/state_head.h"
#include "diffusion/network/unet.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::diffusion {
namespace {

using InstructionSet = CpuDenoiser::InstructionSet;

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

InstructionSet CpuDenoiser::bestInstructionSet() { return inference::bestInstructionSet(); }

std::string CpuDenoiser::toText(InstructionSet instruction_set) {
  return inference::toText(instruction_set);
}

CpuDenoiser::CpuDenoiser(const Model& model, InstructionSet instruction_set) {
  const inference::DenoiserKernels& kernels = inference::denoiserKernels(instruction_set);
  requireDenoiserTensors(model);
  network_ = std::make_unique<Network>(model, kernels);
}

CpuDenoiser::~CpuDenoiser() = default;

const Architecture& CpuDenoiser::architecture() const { return network_->architecture; }

void CpuDenoiser::setContexts(const std::vector<Context>& contexts) {
  network_->conditioning.setContexts(contexts);
  network_->state_head.setContexts(contexts);
  network_->unet.setContexts(contexts);
  network_->ready = true;
  network_->actions_predicted = network_->states_predicted = false;
}

void CpuDenoiser::predictActions(const float* noisy, int k, float* actions) {
  network_->requireStep(k);
  network_->unet.forward(noisy, network_->conditioning.injection(k), actions);
  network_->actions_predicted = true;
}

void CpuDenoiser::backwardActions(const float* action_gradient, float* noisy_gradient) {
  if (!network_->actions_predicted) {
    throw std::logic_error("backwardActions was called before predictActions");
  }
  network_->unet.backward(action_gradient, noisy_gradient);
}

void CpuDenoiser::predictStates(const float* actions, int k, float* states) {
  network_->requireStep(k);
  network_->state_head.forward(actions, k, states);
  network_->states_predicted = true;
}

void CpuDenoiser::backwardStates(const float* state_gradient, float* action_gradient) {
  if (!network_->states_predicted) {
    throw std::logic_error("backwardStates was called before predictStates");
  }
  network_->state_head.backward(state_gradient, action_gradient);
}

}  // namespace cdiff::diffusion
