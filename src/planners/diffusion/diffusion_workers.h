// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "diffusion/model.h"
#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "planners/diffusion/diffusion_options.h"

namespace cdiff::planners {

/// Encoder and denoiser of a model for one thread.
class Worker {
 public:
  /// `may_scale_route`: whether `denoiser` may be asked to mix predictions (route_scale). The
  /// networks of worker `number` are kept where this process keeps content.
  Worker(const DiffusionOptions& options, const diffusion::Model& model, bool may_scale_route,
         std::int64_t number);

  diffusion::ImageEncoder& encoder() { return *encoder_; }
  /// `route`: whether its vehicles are given their routes, with which and without which it then
  /// mixes predictions where route_scale is not 1.
  diffusion::Denoiser& denoiser(bool route);

 private:
  std::shared_ptr<diffusion::ImageEncoder> encoder_;
  std::shared_ptr<diffusion::CpuDenoiser> denoiser_;
  std::shared_ptr<diffusion::CpuDenoiser> routeless_;       ///< where route_scale is not 1
  std::unique_ptr<diffusion::RouteScaledDenoiser> scaled_;  ///< likewise
};

/// As many workers as DiffusionOptions::threads.
class DiffusionWorkers {
 public:
  /// As Worker.
  DiffusionWorkers(const DiffusionOptions& options, const diffusion::Model& model,
                   bool may_scale_route);

  using Part = std::function<void(Worker& worker, std::size_t begin, std::size_t end)>;
  /// Calls `part` for every worker with the range of `count` items that is its share, each in a
  /// thread of its own.
  void forEach(std::size_t count, const Part& part);

 private:
  std::vector<std::unique_ptr<Worker>> workers_;
};

}  // namespace cdiff::planners
