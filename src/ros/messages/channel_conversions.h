// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "ros/lockstep/tick_answers.h"
#include "ros/messages/conversions.h"
#include "ros/messages/display.h"
#include "ros/messages/image_conversions.h"

namespace cdiff::ros {

// Conversions of the rows of the table of channels: from the values of a tick to its messages and
// back, and to messages that say the same for tools.

AnyMessage makeTraffic(const TickValues& values, int slot);
AnyMessage makeSelection(const TickValues& values, int slot);
AnyMessage makeControl(const TickValues& values, int slot);
AnyMessage makeRollout(const TickValues& values, int slot);
/// Of the CBVs' planner where it is guided and there was a CBV to drive.
AnyMessage makeGuidance(const TickValues& values, int slot);
AnyMessage makeImage(const TickValues& values, int slot);

/// Whether the answer drove.
void takeDecision(const AnyMessage& message, const TickReading& reading, Answer& answer);
void takeControl(const AnyMessage& message, const TickReading& reading, Answer& answer);
void takeRollout(const AnyMessage& message, const TickReading& reading, Answer& answer);
void takeGuidance(const AnyMessage& message, const TickReading& reading, Answer& answer);
/// Leaves an image out that is not as it must be.
void takeImage(const AnyMessage& message, const TickReading& reading, Answer& answer);

/// Beside the image of the slot.
AnyMessage deriveCameraInfo(const TickMessages& tick, const TickReading& reading, int slot);
/// With the cameras where the tick has images.
AnyMessage deriveTransforms(const TickMessages& tick, const TickReading& reading, int slot);
AnyMessage deriveOdometry(const TickMessages& tick, const TickReading& reading, int slot);

}  // namespace cdiff::ros
