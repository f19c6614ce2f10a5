// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A stage of training: which weights it trains by which loss, and how held-out samples judge it.
#pragma once

#include <ATen/ATen.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "learning/figures.h"
#include "learning/parameters.h"

namespace cdiff::learning {

/// A loss with its parts, for the log.
struct Loss {
  at::Tensor total;
  std::vector<std::pair<std::string, at::Tensor>> terms;
};

/// Weights that a stage trains; their names in checkpoints begin with `name`.
struct TrainedPart {
  std::string name;
  ParameterSet* parameters;
};

class Stage {
 public:
  virtual ~Stage() = default;
  virtual const std::string& name() const = 0;
  virtual std::vector<TrainedPart> parts() = 0;
  virtual std::int64_t batchSize() const = 0;
  /// The loss on the batch of a step, which is a function of seed, stage and step alone: so a
  /// resumed run goes on as if it had never stopped.
  virtual Loss loss(std::int64_t step) = 0;
  /// Samples of a step, for messages.
  virtual std::vector<std::size_t> samplesOf(std::int64_t step) = 0;
  /// Figures on held-out samples.
  virtual Figures judge() = 0;
};

}  // namespace cdiff::learning
