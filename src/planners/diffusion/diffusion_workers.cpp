// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_workers.h"

#include <algorithm>
#include <future>

namespace cdiff::planners {
namespace {

inference::InstructionSet instructionSetOf(const DiffusionOptions& options) {
  return inference::instructionSetNamed(options.isa, "diffusion.isa");
}

diffusion::ImageEncoder encoderFor(const DiffusionOptions& options, const diffusion::Model& model) {
  inference::pinOneDnn(options.isa, "diffusion.isa");
  const inference::Precision precision =
      inference::precisionNamed(options.precision, options.isa, "diffusion.precision");
  return diffusion::ImageEncoder(model, precision, instructionSetOf(options));
}

}  // namespace

Worker::Worker(const DiffusionOptions& options, const diffusion::Model& model, bool may_scale_route)
    : encoder_(encoderFor(options, model)), denoiser_(model, instructionSetOf(options)) {
  if (!may_scale_route) return;
  routeless_ = std::make_unique<diffusion::CpuDenoiser>(model, instructionSetOf(options));
  scaled_ =
      std::make_unique<diffusion::RouteScaledDenoiser>(denoiser_, *routeless_, options.route_scale);
}

diffusion::Denoiser& Worker::denoiser(bool route) {
  if (route && scaled_) return *scaled_;
  return denoiser_;
}

DiffusionWorkers::DiffusionWorkers(const DiffusionOptions& options, const diffusion::Model& model,
                                   bool may_scale_route) {
  for (std::int64_t i = 0; i < options.threads; ++i)
    workers_.push_back(std::make_unique<Worker>(options, model, may_scale_route));
}

void DiffusionWorkers::forEach(std::size_t count, const Part& part) {
  const std::size_t workers = std::min(workers_.size(), count);
  std::vector<std::future<void>> others;
  for (std::size_t i = 1; i < workers; ++i) {
    others.push_back(std::async(std::launch::async, [&, i] {
      part(*workers_[i], i * count / workers, (i + 1) * count / workers);
    }));
  }
  if (workers > 0) part(*workers_[0], 0, count / workers);
  for (std::future<void>& other : others) other.get();
}

}  // namespace cdiff::planners
