// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/diffusion_workers.h"

#include <algorithm>
#include <future>
#include <string>

#include "core/kept_content.h"

namespace cdiff::planners {
namespace {

inference::InstructionSet instructionSetOf(const DiffusionOptions& options) {
  return inference::instructionSetNamed(options.isa, "diffusion.isa");
}

/// A network of a worker, whose `kind` is another for each that works beside it.
template <class Network, class... Further>
std::shared_ptr<Network> networkFor(const std::string& kind, const diffusion::Model& model,
                                    inference::InstructionSet set, Further... further) {
  const auto make = [&] { return std::make_shared<Network>(model, further..., set); };
  if (!core::keepsContent()) return make();
  return core::keptContent<Network>(kind, diffusion::identityOf(model), make);
}

std::shared_ptr<diffusion::ImageEncoder> encoderFor(const DiffusionOptions& options,
                                                    const diffusion::Model& model,
                                                    const std::string& worker) {
  inference::pinOneDnn(options.isa, "diffusion.isa");
  const inference::Precision precision =
      inference::precisionNamed(options.precision, options.isa, "diffusion.precision");
  return networkFor<diffusion::ImageEncoder>(
      "encoder " + options.precision + " " + options.isa + worker, model, instructionSetOf(options),
      precision);
}

}  // namespace

Worker::Worker(const DiffusionOptions& options, const diffusion::Model& model, bool may_scale_route,
               std::int64_t number) {
  const std::string worker = " of worker " + std::to_string(number);
  encoder_ = encoderFor(options, model, worker);
  const auto denoiser = [&](const std::string& kind) {
    return networkFor<diffusion::CpuDenoiser>(kind + " " + options.isa + worker, model,
                                              instructionSetOf(options));
  };
  denoiser_ = denoiser("denoiser");
  if (!may_scale_route) return;
  routeless_ = denoiser("routeless denoiser");
  scaled_ = std::make_unique<diffusion::RouteScaledDenoiser>(*denoiser_, *routeless_,
                                                             options.route_scale);
}

diffusion::Denoiser& Worker::denoiser(bool route) {
  if (route && scaled_) return *scaled_;
  return *denoiser_;
}

DiffusionWorkers::DiffusionWorkers(const DiffusionOptions& options, const diffusion::Model& model,
                                   bool may_scale_route) {
  for (std::int64_t i = 0; i < options.threads; ++i)
    workers_.push_back(std::make_unique<Worker>(options, model, may_scale_route, i));
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
