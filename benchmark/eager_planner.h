// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The planner's two modes with libtorch's eager execution, image to sampled trajectory, one
/// vehicle on one thread: what a decision would take without code of its own. Random weights of the
/// same sizes; the objectives are given gradients, so their own time is left out here.
#pragma once

namespace cdiff::benchmark {

/// Seconds of one image through ResNet-34.
double eagerEncoderSeconds();
/// Mode `paper`: one image and K guided steps, each with U-Net and state head forward, the gradient
/// through both to the noisy trajectory, and the step of the sampler.
double eagerPaperSeconds();
/// Mode `real_time`: one image and 10 steps, each with the U-Net forward and a proximal step (the
/// state head 6 times forward, 5 times with its gradient), and the step of the sampler.
double eagerRealTimeSeconds();

}  // namespace cdiff::benchmark
