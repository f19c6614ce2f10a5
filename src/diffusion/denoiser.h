// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "diffusion/network/architecture.h"
#include "diffusion/normalizer.h"
#include "dynamics/action_rollout.h"

namespace cdiff::diffusion {

/// What one trajectory is conditioned on.
struct Context {
  std::vector<float> image_features;   ///< [image_features]
  std::vector<float> route;            ///< [route_points, 2] tokens; empty: no route ("image" mode)
  double speed = 0.0;                  ///< own speed [m/s]
  std::vector<float> previous;         ///< [image_features] of the image before; empty: not known
  std::optional<double> target_speed;  ///< v* [m/s]
};

/// The denoiser f_theta(tau^k, k, c) of a batch (paper III-C2): action head, state head on actions,
/// and the vector-Jacobian products that guidance needs. Everything normalized, float32, row-major.
/// Results of a sample never depend on its neighbors in the batch, bit by bit.
class Denoiser {
 public:
  virtual ~Denoiser() = default;
  virtual const Architecture& architecture() const = 0;
  /// Fixes the batch until the next call.
  virtual void setContexts(const std::vector<Context>& contexts) = 0;
  /// actions [B, T, 3] = f_act(tau^k [B, T, 7], k, c).
  virtual void predictActions(const float* noisy, int k, float* actions) = 0;
  /// noisy_gradient [B, T, 7] = (d actions / d tau^k)^T action_gradient [B, T, 3], at the last
  /// predictActions.
  virtual void backwardActions(const float* action_gradient, float* noisy_gradient) = 0;
  /// states [B, T, 4] = f_state(actions [B, T, 3], k, c).
  virtual void predictStates(const float* actions, int k, float* states) = 0;
  /// action_gradient [B, T, 3] = (d states / d actions)^T state_gradient [B, T, 4], at the last
  /// predictStates.
  virtual void backwardStates(const float* state_gradient, float* action_gradient) = 0;
};

/// States from actions: the learned state head (paper) or the exact rollout of the vehicle
/// dynamics, with the vector-Jacobian product of each. Normalized, float32, [B, T, .] row-major.
class StateBranch {
 public:
  virtual ~StateBranch() = default;
  /// states [B, T, 4] of actions [B, T, 3] at diffusion step k.
  virtual void predict(const float* actions, int k, float* states) = 0;
  /// action_gradient [B, T, 3] = (d states / d actions)^T state_gradient [B, T, 4], at the last
  /// predict.
  virtual void backward(const float* state_gradient, float* action_gradient) = 0;
};

/// The denoiser's state head.
class LearnedStateBranch : public StateBranch {
 public:
  explicit LearnedStateBranch(Denoiser& denoiser) : denoiser_(denoiser) {}
  void predict(const float* actions, int k, float* states) override;
  void backward(const float* state_gradient, float* action_gradient) override;

 private:
  Denoiser& denoiser_;
};

/// Classifier-free guidance on the route and, where the model takes it, the target speed: actions
/// x_u + w (x_c - x_u), x_c of the contexts as they are, x_u of the same without both, w = `scale`;
/// 0 is without, 1 with them, above 1 beyond them. States are those of the actions, which no route
/// decides. Normalized.
class RouteScaledDenoiser : public Denoiser {
 public:
  /// Two denoisers of the same model; both must outlive it.
  RouteScaledDenoiser(Denoiser& with_route, Denoiser& without_route, double scale)
      : with_route_(with_route), without_route_(without_route), scale_(static_cast<float>(scale)) {}

  const Architecture& architecture() const override { return with_route_.architecture(); }
  void setContexts(const std::vector<Context>& contexts) override;
  void predictActions(const float* noisy, int k, float* actions) override;
  void backwardActions(const float* action_gradient, float* noisy_gradient) override;
  void predictStates(const float* actions, int k, float* states) override;
  void backwardStates(const float* state_gradient, float* action_gradient) override;

 private:
  void mixInto(float* values);

  Denoiser& with_route_;
  Denoiser& without_route_;
  float scale_;
  std::size_t rows_ = 0;      ///< B x T
  std::vector<float> other_;  ///< of without_route_, as large as what it is mixed with
};

/// States of the actions as they are executed (dynamics::makeExecutable) by ActionRollout through
/// the normalizer; `speeds` [m/s] of the batch. The gradient is that of the rollout without the
/// choice of a pedal (straight-through): also the pedal that does not act yet can be moved.
class ExactStateBranch : public StateBranch {
 public:
  ExactStateBranch(const dynamics::BicycleModelOptions& vehicle, const Normalizer& normalizer,
                   std::vector<double> speeds,
                   dynamics::ThrottleResponse response = dynamics::ThrottleResponse::kFitted);
  void predict(const float* actions, int k, float* states) override;
  void backward(const float* state_gradient, float* action_gradient) override;

 private:
  dynamics::ActionRollout rollout_;
  const Normalizer& normalizer_;
  std::vector<double> speeds_;
  std::vector<traffic::Rollout> last_;
};

}  // namespace cdiff::diffusion
