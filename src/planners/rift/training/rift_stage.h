// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "planners/rift/training/rift_task.h"

namespace cdiff::planners {

inline constexpr const char* kRiftStage = "fine_tune";
inline constexpr std::int64_t kRiftBatch = 256;

/// Logits of features [N, width] by a score head.
at::Tensor riftScores(const learning::ParameterSet& head, const at::Tensor& features);

/// Learning rate of a step with `batches` x `epochs` steps a buffer: for buffer k 0.9^k of `first`
/// (at least 1e-6), after a warm-up of three epochs, falling by a cosine to 0.9 of it.
double riftRate(double first, std::int64_t step, std::int64_t batches, std::int64_t epochs);

/// States gathered by a policy, as tensors: S states with up to G candidates.
struct RiftBuffer {
  at::Tensor features;  ///< [S, G, width]
  RiftRows rows;        ///< [S, G], its `logits` undefined

  RiftBuffer(const std::vector<RiftGroup>& groups, std::int64_t width,
             const learning::ParameterSet& head, const at::Device& device);
};

/// The stage `fine_tune`. Buffer k: the next `buffer` of the training moments in an order drawn
/// from the seed, judged by the policy of that time; then `epochs` passes over them in batches,
/// with the learning rate 0.9^k of the option's: three epochs of warm-up, then a cosine to 0.9 of
/// it.
class RiftStage : public learning::Stage {
 public:
  explicit RiftStage(RiftTrainingState& state);

  const std::string& name() const override { return name_; }
  std::vector<learning::TrainedPart> parts() override { return {{"head", &state_.head}}; }
  std::int64_t batchSize() const override;
  std::vector<std::size_t> samplesOf(std::int64_t step) override;
  learning::Loss loss(std::int64_t step) override;
  learning::Measures measureHeldOut() override;
  std::optional<double> learningRate(std::int64_t step) const override;
  learning::StageRules rules() const override;

  std::int64_t stepsOfBuffer() const { return state_.settings.epochs * batches(); }

 private:
  std::int64_t batches() const;
  std::vector<std::size_t> momentsOf(std::int64_t buffer) const;
  std::vector<std::int64_t> rowsOf(std::int64_t step) const;
  void gather(std::int64_t buffer);

  std::string name_ = kRiftStage;
  RiftTrainingState& state_;
  std::int64_t gathered_ = -1;  ///< number of the buffer
  std::optional<RiftBuffer> buffer_;
  std::vector<RiftGroup> held_out_;  ///< made at the first judgment
};

/// What the measures say, as Markdown.
std::string riftTable(const learning::Measures& held_out);

}  // namespace cdiff::planners
