// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <string>
#include <vector>

#include "diffusion/noise_schedule.h"
#include "diffusion/normalizer.h"
#include "learning/curve_log.h"
#include "learning/samples/driving_sample.h"
#include "learning/samples/sample_order.h"
#include "learning/task.h"
#include "planners/diffusion/training/networks.h"

namespace cdiff::planners {

// Batches of the diffusion stages: which samples come at which step, how each is changed, and the
// noise of the diffusion loss. All of it is a function of (seed, stage, step), so that a resumed
// run goes on as if it had never stopped.

/// Features of every sample, each of one variant: as it is, or, where the stage mirrors, in half of
/// the cases mirrored (one variant takes half the time, and the other samples show the other side).
struct FeatureCache {
  at::Tensor features;  ///< [samples, image_features]
  /// Of the images before, and which samples have one [samples, 1], 0 or 1; undefined where the
  /// network takes none.
  at::Tensor previous, previous_known;
};
/// Which samples those are.
bool mirroredInCache(std::size_t index);

/// Tensors of one batch of samples: images or features, context, normalized rollouts, auxiliary
/// targets, diffusion steps and noise.
struct TrainingBatch {
  std::vector<std::size_t> samples;
  std::vector<std::uint8_t> maneuvers;  ///< DrivingSample::maneuver
  at::Tensor images;                    ///< [B, 3, H, W] scaled; undefined on cached features
  at::Tensor previous_images;  ///< likewise, black where not known; undefined without `with_motion`
  ContextBatch context;        ///< without features where there are images
  at::Tensor rollouts;         ///< [B, T, 7] normalized
  at::Tensor auxiliary;        ///< [B, A], 0 where not known
  at::Tensor auxiliary_known;  ///< [B, A], 0 or 1
  at::Tensor k;                ///< [B] int64 in 1..K
  at::Tensor noise;            ///< [B, T, 7]
};

/// How a stage changes its samples.
struct BatchOptions {
  std::string stage;
  std::int64_t batch = 32;
  double image_scale = 1.0;
  double route_drop = 0.2;
  bool with_motion = false;  ///< also the image before and the target speed
  double balance = 0.5;
  double yielding_share = 1.0;
  bool mirror = true;
  bool change_light = true;
  std::int64_t diffusion_steps = 100;
  std::uint64_t seed = 1;
};

/// Makes batches of tensors on a device from stored samples; every draw depends on the seed and the
/// step alone.
class BatchMaker {
 public:
  BatchMaker(const learning::DrivingDataset& dataset, const diffusion::Normalizer& normalizer,
             const BatchOptions& options, const at::Device& device);

  /// Training batch of a step, with images, or with features where a cache is given.
  TrainingBatch training(std::int64_t step, const FeatureCache* cache = nullptr);
  /// These samples as they are, with route; images only if asked.
  TrainingBatch plain(const std::vector<std::size_t>& samples, bool with_images) const;
  /// Indices of a step.
  std::vector<std::size_t> order(std::int64_t step) { return order_.at(step); }

 private:
  learning::DrivingSample changedSample(std::size_t index, const core::RandomKey& key,
                                        bool mirrored, bool with_image) const;
  bool isMirrored(std::size_t index, const core::RandomKey& key, bool cached) const;
  void addNoise(std::int64_t step, TrainingBatch& batch) const;
  TrainingBatch pack(const std::vector<learning::DrivingSample>& samples,
                     const std::vector<float>& has_route) const;
  void packMotion(const std::vector<learning::DrivingSample>& samples, TrainingBatch& batch) const;
  void dropMotion(std::int64_t step, TrainingBatch& batch) const;

  const learning::DrivingDataset& dataset_;
  diffusion::Normalizer normalizer_;
  BatchOptions options_;
  at::Device device_;
  learning::SampleOrder order_;
  core::RandomStream change_;
  core::RandomStream noise_;
};

/// The loss of a clean prediction on a batch (the state head gets detached actions), normalized:
///  - `weighted`: mean of w_t (a - a_hat)^2 + mean of (s - s_hat)^2, w_t = 1 + 4 exp(-t / 4), for
///    only the first actions of a plan are executed;
///  - `plain`: mean of (tau^0 - tau^0_hat)^2 over all T x 7 cells, as the paper writes it (III-C3);
/// and the measures by which held-out samples judge a denoiser.
class DiffusionLoss {
 public:
  enum class Kind { kWeighted, kPlain };

  DiffusionLoss(Kind kind, const diffusion::Architecture& architecture,
                const diffusion::Normalizer& normalizer, const at::Device& device);

  /// tau^k = sqrt(alpha_bar_k) tau^0 + sqrt(1 - alpha_bar_k) noise.
  at::Tensor addNoise(const at::Tensor& clean, const at::Tensor& k, const at::Tensor& noise) const;
  /// Its terms `actions` and `states` are the means of the two blocks, weighted as its kind
  /// prescribes.
  learning::Loss loss(const DenoiserNet& denoiser, const TrainingBatch& batch) const;
  /// [states; actions] [B, T, 7] as predicted from tau^k in one step.
  at::Tensor predictClean(const DenoiserNet& denoiser, const at::Tensor& noisy, std::int64_t k,
                          const ContextBatch& context) const;
  /// DDIM from noise over `steps` evenly spaced diffusion steps.
  at::Tensor sample(const DenoiserNet& denoiser, const at::Tensor& noise,
                    const ContextBatch& context, std::int64_t steps) const;
  /// Mean absolute errors of a normalized prediction: ade_m, fde_m, speed_mps, heading_rad,
  /// throttle, steer, brake; keys get `prefix`.
  void addMeasures(const std::string& prefix, const at::Tensor& predicted, const at::Tensor& clean,
                   learning::Measures& measures) const;
  /// One-step predictions at K/2 and K and DDIM samples of held-out samples, the latter also with
  /// the features of a gray image and without route.
  learning::Measures measureHeldOut(const DenoiserNet& denoiser, const TrainingBatch& held_out,
                                    const at::Tensor& gray_features) const;
  /// What a card sets beside it: errors of going straight on at the own speed
  /// (`constant_velocity_`, states alone), the least ADE and FDE of kManySamples DDIM samples
  /// (`least_of_8_`), and errors of DDIM samples by maneuver (`sample_left_`, ...).
  learning::Measures measureFurther(const DenoiserNet& denoiser,
                                    const TrainingBatch& held_out) const;
  /// Standard deviation of the clean prediction's error at k = K, [T, 7] normalized.
  traffic::Rollout spread(const DenoiserNet& denoiser, const TrainingBatch& held_out) const;

  static constexpr int kManySamples = 8;

 private:
  /// Of the places [B, T], m.
  at::Tensor distances(const at::Tensor& predicted, const at::Tensor& clean) const;
  /// Normalized; the actions are the mean ones.
  at::Tensor constantVelocity(const TrainingBatch& batch) const;
  at::Tensor fixedNoise(const at::Tensor& like, const std::string& name) const;

  Kind kind_;
  diffusion::Architecture architecture_;
  diffusion::NoiseSchedule schedule_;
  at::Device device_;
  at::Tensor signal_;   ///< sqrt(alpha_bar) [K + 1]
  at::Tensor noise_;    ///< sqrt(1 - alpha_bar) [K + 1]
  at::Tensor weights_;  ///< of the rows [1, T, 1]
  at::Tensor mean_;     ///< [T, 7]
  at::Tensor scale_;    ///< [T, 7]
};

}  // namespace cdiff::planners
