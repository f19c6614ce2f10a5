// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/messages/image_conversions.h"

#include <algorithm>

#include "core/text.h"
#include "cv_bridge/cv_bridge.h"
#include "e2e_cdiff/core/exceptions.h"
#include "ros/messages/conversions.h"
#include "sensor_msgs/distortion_models.h"
#include "sensor_msgs/image_encodings.h"

namespace cdiff::ros {
namespace {

const std::string& kEncoding = sensor_msgs::image_encodings::RGB8;

std::string sizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

[[noreturn]] void refuse(const ExpectedImage& expected, const std::string& what) {
  throw core::InputError("image on " + expected.topic + " " + what);
}

void checkShape(const sensor_msgs::Image& message, const ExpectedImage& expected) {
  if (message.encoding != kEncoding)
    refuse(expected, "has encoding '" + message.encoding + "'; expected '" + kEncoding + "'");
  if (message.width != expected.width || message.height != expected.height) {
    refuse(expected, "is " + sizeText(message.width, message.height) + " pixels; expected " +
                         sizeText(expected.width, expected.height));
  }
  const std::size_t bytes = std::size_t{message.step} * message.height;
  if (message.step < 3 * message.width || message.data.size() != bytes) {
    refuse(expected, "has " + std::to_string(message.data.size()) + " bytes in rows of " +
                         std::to_string(message.step) + " for " +
                         sizeText(message.width, message.height) + " pixels");
  }
}

void checkOrigin(const sensor_msgs::Image& message, const ExpectedImage& expected,
                 std::uint64_t tick) {
  if (message.header.frame_id != opticalFrame(expected.vehicle_id)) {
    refuse(expected, "has frame '" + message.header.frame_id + "'; expected '" +
                         opticalFrame(expected.vehicle_id) + "'");
  }
  if (toStamp(static_cast<double>(tick) * expected.simulation_step) != message.header.stamp) {
    refuse(expected, "has stamp " + core::formatFixed(message.header.stamp.toSec(), 9) +
                         ", which is no tick of " + core::formatNumber(expected.simulation_step) +
                         " s");
  }
}

}  // namespace

std::string opticalFrame(const std::string& vehicle_id) { return vehicle_id + "/camera_optical"; }

sensor_msgs::Image toMsg(const traffic::CameraImage& image, double time,
                         const std::string& vehicle_id) {
  std_msgs::Header header;
  header.stamp = toStamp(time);
  header.frame_id = opticalFrame(vehicle_id);
  cv_bridge::CvImage picture(header, kEncoding, cv::Mat(image.height, image.width, CV_8UC3));
  std::copy(image.rgb.begin(), image.rgb.end(), picture.image.data);
  sensor_msgs::Image message;
  picture.toImageMsg(message);
  return message;
}

traffic::CameraImage fromMsg(const sensor_msgs::Image& message, const ExpectedImage& expected) {
  checkShape(message, expected);
  traffic::CameraImage image;
  image.tick = nearestTick(message.header.stamp, expected.simulation_step);
  checkOrigin(message, expected, image.tick);
  image.width = static_cast<int>(message.width);
  image.height = static_cast<int>(message.height);
  const cv_bridge::CvImageConstPtr picture = cv_bridge::toCvShare(message, {}, kEncoding);
  image.rgb.reserve(std::size_t{3} * message.width * message.height);
  for (int row = 0; row < image.height; ++row) {
    const std::uint8_t* begin = picture->image.ptr(row);
    image.rgb.insert(image.rgb.end(), begin, begin + std::ptrdiff_t{3} * image.width);
  }
  return image;
}

sensor_msgs::CameraInfo toCameraInfoMsg(const rendering::CameraOptions& options,
                                        const std_msgs::Header& header) {
  const rendering::Intrinsics intrinsics = rendering::intrinsicsOf(options);
  const double f = intrinsics.focal_length;
  const double x = intrinsics.center_x;
  const double y = intrinsics.center_y;
  sensor_msgs::CameraInfo info;
  info.header = header;
  info.width = static_cast<std::uint32_t>(options.width);
  info.height = static_cast<std::uint32_t>(options.height);
  info.distortion_model = sensor_msgs::distortion_models::PLUMB_BOB;
  info.D.assign(5, 0.0);
  info.K = {f, 0.0, x, 0.0, f, y, 0.0, 0.0, 1.0};
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.P = {f, 0.0, x, 0.0, 0.0, f, y, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

}  // namespace cdiff::ros
