// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The same guided sampling with libtorch's eager execution: what the planner would take without
/// code of its own.
#pragma once

namespace cdiff::benchmark {

/// Seconds of one image through ResNet-34.
double eagerEncoderSeconds();
/// Seconds of one guided denoising step: forward pass and gradient with respect to the noisy
/// trajectory.
double eagerGuidedStepSeconds();

}  // namespace cdiff::benchmark
