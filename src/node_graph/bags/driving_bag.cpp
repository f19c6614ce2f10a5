// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/driving_bag.h"

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "core/text.h"
#include "cv_bridge/cv_bridge.h"
#include "e2e_cdiff/ControlAction.h"
#include "e2e_cdiff/core/exceptions.h"
#include "nav_msgs/Odometry.h"
#include "nav_msgs/Path.h"
#include "node_graph/bags/bag_reader.h"
#include "sensor_msgs/CompressedImage.h"
#include "sensor_msgs/Image.h"

namespace cdiff::node_graph {
namespace {

using core::InputError;

constexpr const char* kImage = "sensor_msgs/Image";
constexpr const char* kCompressed = "sensor_msgs/CompressedImage";

double yawOf(const geometry_msgs::Quaternion& message) {
  const Eigen::Quaterniond q(message.w, message.x, message.y, message.z);
  if (q.norm() < 1e-6)
    throw InputError("an odometry message has no orientation (a quaternion of zeros)");
  const Eigen::Matrix3d rotation = q.normalized().toRotationMatrix();
  return std::atan2(rotation(1, 0), rotation(0, 0));
}

traffic::VehicleState toState(const nav_msgs::Odometry& message) {
  traffic::VehicleState state;
  state.position = {message.pose.pose.position.x, message.pose.pose.position.y};
  state.elevation = message.pose.pose.position.z;
  state.heading = yawOf(message.pose.pose.orientation);
  state.speed = message.twist.twist.linear.x;
  if (!std::isfinite(state.position.sum() + state.elevation + state.heading + state.speed))
    throw InputError("an odometry message holds a value that is no number");
  return state;
}

/// The center of the picture, cropped to the desired aspect ratio and resized.
traffic::CameraImage scaledImage(const cv::Mat& picture, const diffusion::Architecture& wanted) {
  const double aspect =
      static_cast<double>(wanted.image_width) / static_cast<double>(wanted.image_height);
  const int width = std::min(picture.cols, static_cast<int>(std::lround(picture.rows * aspect)));
  const int height = std::min(picture.rows, static_cast<int>(std::lround(picture.cols / aspect)));
  const cv::Rect middle((picture.cols - width) / 2, (picture.rows - height) / 2, width, height);
  cv::Mat small;
  cv::resize(picture(middle), small,
             {static_cast<int>(wanted.image_width), static_cast<int>(wanted.image_height)}, 0, 0,
             cv::INTER_AREA);
  traffic::CameraImage image;
  image.width = small.cols;
  image.height = small.rows;
  image.rgb.assign(small.data, small.data + small.total() * small.elemSize());
  return image;
}

class DrivingBagReader {
 public:
  DrivingBagReader(const std::filesystem::path& file, const collection::DriveOptions& topics,
                   const diffusion::Architecture& architecture)
      : reader_(file), topics_(topics), architecture_(architecture) {
    require(topics.image, {kImage, kCompressed});
    require(topics.odometry, {"nav_msgs/Odometry"});
    if (!topics.control.empty()) require(topics.control, {"e2e_cdiff/ControlAction"});
    if (!topics.path.empty()) require(topics.path, {"nav_msgs/Path"});
  }

  collection::RecordedDrive read() {
    BagMessage message;
    while (reader_.next(message)) take(message);
    if (!reader_.damage().empty()) throw InputError(core::joinText(reader_.damage(), "; "));
    return std::move(bag_);
  }

 private:
  void require(const std::string& topic, const std::set<std::string>& types) const {
    std::set<std::string> there;
    for (const BagConnection& connection : reader_.connections()) {
      there.insert(connection.topic + " (" + connection.type + ")");
      if (connection.topic != topic) continue;
      if (types.count(connection.type) != 0) return;
      throw InputError("its topic '" + topic + "' is of type " + connection.type + ", expected " +
                       core::joinText({types.begin(), types.end()}, " or "));
    }
    throw InputError("has no topic '" + topic + "' (" +
                     core::joinText({types.begin(), types.end()}, " or ") + "); it has " +
                     core::joinText({there.begin(), there.end()}, ", "));
  }

  void take(const BagMessage& message) {
    const std::string& topic = message.connection->topic;
    if (topic == topics_.image) takeImage(message);
    if (topic == topics_.odometry) {
      const auto odometry = decode<nav_msgs::Odometry>(message);
      requireFrame(topic, odometry->header.frame_id);
      bag_.states[odometry->header.stamp.toSec()] = toState(*odometry);
    }
    if (topic == topics_.control && !topic.empty()) takeControl(message);
    if (topic == topics_.path && !topic.empty()) takePath(message);
  }

  /// Throws InputError unless `name`, with or without a leading slash, is the frame of the first
  /// message with a position: positions can be compared in one frame alone.
  void requireFrame(const std::string& topic, const std::string& name) {
    const std::string frame = name.substr(name.rfind('/', 0) == 0 ? 1 : 0);
    if (frame_topic_.empty()) {
      frame_ = frame;
      frame_topic_ = topic;
    }
    if (frame == frame_) return;
    throw InputError("'" + topic + "' is in the frame '" + frame + "', '" + frame_topic_ +
                     "' in '" + frame_ + "'; record both in one fixed frame");
  }

  void takeImage(const BagMessage& message) {
    try {
      if (message.connection->type == kImage) {
        const auto image = decode<sensor_msgs::Image>(message);
        bag_.images[image->header.stamp.toSec()] =
            scaledImage(cv_bridge::toCvCopy(*image, "rgb8")->image, architecture_);
      } else {
        const auto image = decode<sensor_msgs::CompressedImage>(message);
        bag_.images[image->header.stamp.toSec()] =
            scaledImage(cv_bridge::toCvCopy(*image, "rgb8")->image, architecture_);
      }
    } catch (const cv_bridge::Exception& error) {
      throw InputError("an image on '" + topics_.image + "' cannot be used: " + error.what());
    } catch (const cv::Exception& error) {
      throw InputError("an image on '" + topics_.image + "' cannot be used: " + error.what());
    }
  }

  void takeControl(const BagMessage& message) {
    const auto control = decode<::e2e_cdiff::ControlAction>(message);
    const traffic::ControlAction action{control->throttle, control->steer, control->brake};
    if (!action.valid())
      throw InputError("a message on '" + topics_.control + "' is no action within its range");
    bag_.controls[control->header.stamp.toSec()] = action;
  }

  void takePath(const BagMessage& message) {
    const auto path = decode<nav_msgs::Path>(message);
    if (path->poses.size() > 1) requireFrame(topics_.path, path->header.frame_id);
    std::vector<Eigen::Vector3d> points;
    for (const geometry_msgs::PoseStamped& pose : path->poses) {
      const Eigen::Vector3d point(pose.pose.position.x, pose.pose.position.y, pose.pose.position.z);
      if (points.empty() || (points.back() - point).head<2>().norm() > 0.05)
        points.push_back(point);
    }
    if (points.size() > 1) bag_.paths[path->header.stamp.toSec()] = geometry::Polyline(points);
  }

  BagReader reader_;
  const collection::DriveOptions& topics_;
  const diffusion::Architecture& architecture_;
  collection::RecordedDrive bag_;
  std::string frame_;        ///< of all positions
  std::string frame_topic_;  ///< that named it
};

}  // namespace

collection::RecordedDrive readDrivingBag(const std::filesystem::path& file,
                                         const collection::DriveOptions& options,
                                         const diffusion::Architecture& architecture) {
  return DrivingBagReader(file, options, architecture).read();
}

}  // namespace cdiff::node_graph
