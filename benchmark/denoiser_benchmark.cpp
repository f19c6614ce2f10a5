// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "benchmark.h"
#include "e2e_cdiff/core/random.h"
#include "fma_peak.h"
#include "network_times.h"

namespace cdiff::benchmark {
namespace {

using diffusion::CpuDenoiser;

/// Weights of about unit gain; speed does not depend on them.
diffusion::Model randomModel() {
  diffusion::Model model;
  const core::RandomStream random(1, "benchmark");
  for (const inference::TensorShape& wanted : diffusion::denoiserTensors(model.architecture)) {
    inference::Tensor& tensor = model.denoiser[wanted.name];
    tensor.shape = wanted.shape;
    std::int64_t count = 1;
    for (const std::int64_t size : wanted.shape) count *= size;
    const double bound = wanted.shape.size() == 1 ? 1.0 : 0.05;
    core::RandomKey key;
    key.vehicle = core::hashText(wanted.name);
    for (std::int64_t i = 0; i < count; ++i) {
      tensor.values.push_back(
          static_cast<float>(random.uniform(key, static_cast<std::uint32_t>(i), -bound, bound)));
    }
  }
  return model;
}

}  // namespace

double unetOperations(const diffusion::Model& model) {
  const auto levels = static_cast<std::int64_t>(model.architecture.channels.size());
  double sum = 0.0;
  for (const auto& [name, tensor] : model.denoiser) {
    if (tensor.shape.size() != 3) continue;
    std::int64_t halvings = 0;
    if (name.rfind("down.", 0) == 0)
      halvings = name[5] - '0' + (name.compare(6, 7, ".sample") == 0);
    if (name.rfind("middle.", 0) == 0) halvings = levels - 1;
    if (name.rfind("up.", 0) == 0) halvings = levels - 1 - (name[3] - '0');
    sum += 2.0 * static_cast<double>(tensor.values.size()) *
           static_cast<double>(model.architecture.horizon >> halvings);
  }
  return sum;
}

DenoiserTimes denoiserTimes(CpuDenoiser& denoiser, std::size_t samples) {
  const diffusion::Architecture& architecture = denoiser.architecture();
  diffusion::Context context;
  context.image_features.assign(static_cast<std::size_t>(architecture.image_features), 0.1f);
  denoiser.setContexts(std::vector<diffusion::Context>(samples, context));
  const std::size_t rows = samples * static_cast<std::size_t>(architecture.horizon);
  std::vector<float> noisy(rows * 7, 0.3f);
  std::vector<float> actions(rows * 3);
  std::vector<double> forward;
  std::vector<double> pull_back;
  for (int k = static_cast<int>(architecture.diffusion_steps); k > 0; --k) {
    forward.push_back(secondsOf([&] { denoiser.predictActions(noisy.data(), k, actions.data()); }));
    pull_back.push_back(secondsOf([&] { denoiser.backwardActions(actions.data(), noisy.data()); }));
  }
  return {median(forward), median(forward) + median(pull_back)};
}

void benchmarkDenoiser(Figures& figures) {
  const diffusion::Model model = randomModel();
  const CpuDenoiser::InstructionSet set = CpuDenoiser::bestInstructionSet();
  CpuDenoiser denoiser(model, set);
  const double peak = measureFmaPeak();
  figures.push_back({"fma_peak", 1e-9 * peak, "GFLOP/s", ""});
  for (const std::size_t samples : {1, 8}) {
    const DenoiserTimes times = denoiserTimes(denoiser, samples);
    const std::string prefix = "denoiser_b" + std::to_string(samples);
    const std::string goal = samples == 1 ? "<=1" : "";
    figures.push_back({prefix + "_forward", 1e3 * times.forward, "ms", ""});
    figures.push_back({prefix + "_forward_and_pull_back", 1e3 * times.both, "ms", goal});
    const double rate = 2.0 * static_cast<double>(samples) * unetOperations(model) / times.both;
    figures.push_back({prefix + "_share_of_peak", 100.0 * rate / peak, "%", ""});
  }
}

}  // namespace cdiff::benchmark
