// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>

#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/display.h"
#include "node_graph/messages/traffic_conversions.h"
#include "sensor_msgs/CameraInfo.h"
#include "sensor_msgs/Image.h"

namespace cdiff::node_graph {

// Between traffic::CameraImage and sensor_msgs/Image (rgb8, rows from the top left), byte by byte.
//
// sensor_msgs/Image has no tick field, and roscpp overwrites header.seq when it publishes: the tick
// of an image is header.stamp / simulation step, and the stamp must be that tick's own to the
// nanosecond.

/// "<vehicle>/camera_optical": x right, y down, z forward; of a camera C other than the front one
/// "<vehicle>/camera_C_optical".
std::string opticalFrame(const std::string& vehicle_id,
                         const std::string& camera = rendering::kFrontCamera);

/// `time`: simulated time of the image's tick [s].
sensor_msgs::Image toMsg(const traffic::CameraImage& image, double time,
                         const std::string& vehicle_id,
                         const std::string& camera = rendering::kFrontCamera);

/// What the images of one topic are like.
struct ExpectedImage {
  std::string topic;
  std::string vehicle_id;
  std::int64_t width = 0;        ///< [px]
  std::int64_t height = 0;       ///< [px]
  double simulation_step = 0.0;  ///< [s]
  std::string camera = rendering::kFrontCamera;
};

/// What the rigs say of a topic's images; its camera must be one of the slot's rig.
ExpectedImage expectedOf(const Topic& topic, const std::string& vehicle_id,
                         const TickReading& reading);

/// Throws InputError naming topic and value for another encoding, size, frame or a stamp that is no
/// tick's. Rows may be padded.
traffic::CameraImage fromMsg(const sensor_msgs::Image& message, const ExpectedImage& expected);

/// Pinhole without distortion (plumb_bob, five zeros) with the image's stamp and frame.
sensor_msgs::CameraInfo toCameraInfoMsg(const rendering::RigCamera& camera,
                                        const std_msgs::Header& header);

// Conversions of the rows of the table of channels: from the values of a tick to its messages and
// back, and to messages that say the same for tools.

AnyMessage makeTraffic(const TickValues& values, const Topic& topic);
AnyMessage makeSelection(const TickValues& values, const Topic& topic);
AnyMessage makeControl(const TickValues& values, const Topic& topic);
AnyMessage makeRollout(const TickValues& values, const Topic& topic);
/// Of the CBVs' planner where it is guided and there was a CBV to drive.
AnyMessage makeGuidance(const TickValues& values, const Topic& topic);
AnyMessage makeImage(const TickValues& values, const Topic& topic);

/// Whether the answer drove.
void takeDecision(const TakenMessage& taken, const TickReading& reading, Answer& answer);
void takeControl(const TakenMessage& taken, const TickReading& reading, Answer& answer);
void takeRollout(const TakenMessage& taken, const TickReading& reading, Answer& answer);
void takeGuidance(const TakenMessage& taken, const TickReading& reading, Answer& answer);
/// Leaves an image out that is not as it must be.
void takeImage(const TakenMessage& taken, const TickReading& reading, Answer& answer);

/// Beside the image of the slot.
AnyMessage deriveCameraInfo(const TickMessages& tick, const TickReading& reading,
                            const Topic& topic);
/// With the cameras where the tick has images.
AnyMessage deriveTransforms(const TickMessages& tick, const TickReading& reading,
                            const Topic& topic);
AnyMessage deriveOdometry(const TickMessages& tick, const TickReading& reading, const Topic& topic);

}  // namespace cdiff::node_graph
