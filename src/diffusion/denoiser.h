// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <vector>

#include "diffusion/network/architecture.h"

namespace cdiff::diffusion {

/// What one trajectory is conditioned on.
struct Context {
  std::vector<float> image_features;  ///< [image_features]
  std::vector<float> route;           ///< [route_points, 2] tokens; empty: no route ("image" mode)
  double speed = 0.0;                 ///< own speed [m/s]
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
  virtual void pullBackActions(const float* action_gradient, float* noisy_gradient) = 0;
  /// states [B, T, 4] = f_state(actions [B, T, 3], k, c).
  virtual void predictStates(const float* actions, int k, float* states) = 0;
  /// action_gradient [B, T, 3] = (d states / d actions)^T state_gradient [B, T, 4], at the last
  /// predictStates.
  virtual void pullBackStates(const float* state_gradient, float* action_gradient) = 0;
};

}  // namespace cdiff::diffusion
