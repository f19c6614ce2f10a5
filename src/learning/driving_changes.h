// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Driving samples changed for training: mirrored, or in another light.
#pragma once

#include "e2e_cdiff/core/random.h"
#include "learning/driving_sample.h"

namespace cdiff::learning {

/// y, heading and steer change sign.
void mirrorRollout(traffic::Rollout& rollout);

/// Left and right exchanged: image, y, heading, steer, y of the route, and the auxiliary targets
/// whose name in `schema` ends in "_left".
void mirrorSample(const DrivingSchema& schema, DrivingSample& sample);

/// Brightness by up to 40 of 255 grey levels, contrast by up to 20 %, and noise of up to 12 grey
/// levels on each value, in place.
void changeLight(const core::RandomStream& random, const core::RandomKey& key,
                 traffic::CameraImage& image);

}  // namespace cdiff::learning
