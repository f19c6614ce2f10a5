// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/messages/front_view.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "core/text.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/plan_markers.h"
#include "node_graph/messages/traffic_conversions.h"
#include "record/logs/cbv_log.h"

namespace cdiff::node_graph {
namespace {

constexpr int kLegendHeight = 316;  // [px]
constexpr int kHeadHeight = 38;     // [px]

cv::Scalar toScalar(const MarkerColor& color) {
  return {255.0 * color.red, 255.0 * color.green, 255.0 * color.blue};
}

/// Scenario and time, and the colors of the markers.
void drawLegend(cv::Mat picture, const std::string& head) {
  picture.setTo(toScalar(marker_color::kPlate));
  video::writeText(picture, video::cutText(head, picture.cols - 20, 0.75), {10, 30}, 0.75,
                   toScalar(marker_color::kWhite));
  const std::pair<const char*, MarkerColor> entries[] = {
      {"ego, its route and goal", marker_color::kEgo},
      {"CBV, its route and goal", marker_color::kCbv},
      {"other traffic", marker_color::kBackground},
      {"conflict point", marker_color::kConflict},
      {"contact", marker_color::kContact},
      {"plan that nothing guides", marker_color::kUnguided},
      {"plan pulled by collision_seeking", objectiveColor("collision_seeking")},
      {"plan pulled by speed", objectiveColor("speed")}};
  int index = 0;
  for (const auto& [name, color] : entries) {
    const cv::Point corner(10, 48 + 33 * index);
    cv::rectangle(picture, cv::Rect(corner.x, corner.y + 4, 26, 18), toScalar(color), cv::FILLED);
    video::writeText(picture, name, {corner.x + 38, corner.y + 21}, 0.75,
                     toScalar(marker_color::kWhite));
    ++index;
  }
}

void drawWay(cv::Mat view, const std::vector<Eigen::Vector2d>& pixels, const MarkerColor& color) {
  constexpr double kFarthest = 10000.0;  // [px], so that whole numbers hold it
  std::vector<cv::Point> line;
  for (const Eigen::Vector2d& pixel : pixels) {
    if (pixel.cwiseAbs().maxCoeff() > kFarthest) continue;
    line.emplace_back(static_cast<int>(pixel.x()), static_cast<int>(pixel.y()));
  }
  cv::polylines(view, line, false, toScalar(marker_color::kPlate), 9, cv::LINE_AA);
  cv::polylines(view, line, false, toScalar(color), 5, cv::LINE_AA);
}

const planning::PlannedAction* actionFor(const std::vector<planning::PlannedAction>* actions,
                                         const std::string& vehicle_id) {
  if (actions == nullptr) return nullptr;
  const auto found = std::find_if(actions->begin(), actions->end(), [&](const auto& action) {
    return action.vehicle_id == vehicle_id;
  });
  return found == actions->end() ? nullptr : &*found;
}

void drawHead(cv::Mat view, const traffic::Vehicle* cbv, const planning::PlannedAction* action) {
  std::string text = "no CBV: what the ego sees";
  if (cbv != nullptr) {
    text = "what CBV " + cbv->id + " sees";
    const bool plans = action != nullptr && !action->rollout.empty();
    text += plans ? ", and its plan" : "; it tells no plan";
  }
  const MarkerColor& color = cbv == nullptr ? marker_color::kEgo : marker_color::kCbv;
  cv::rectangle(view, cv::Rect(0, 0, view.cols, kHeadHeight), toScalar(marker_color::kPlate),
                cv::FILLED);
  video::writeText(view, video::cutText(text, view.cols - 20, 0.75), {10, 25}, 0.75,
                   toScalar(color));
}

}  // namespace

std::vector<Eigen::Vector2d> projectedRollout(const rendering::RigCamera& camera,
                                              const traffic::Vehicle& vehicle,
                                              const std::vector<planning::RolloutPoint>& rollout) {
  constexpr double kLeastDepth = 0.5;  // [m]
  const Eigen::Matrix<double, 3, 4> projection = rendering::projectionOf(camera);
  std::vector<Eigen::Vector2d> pixels;
  for (const planning::RolloutPoint& point : rollout) {
    const Eigen::Vector2d place = vehicle.state.pose().toBody(point.state.position);
    const double up = point.state.elevation - vehicle.state.elevation;
    const Eigen::Vector3d seen = projection * Eigen::Vector4d(place.x(), place.y(), up, 1.0);
    if (seen.z() >= kLeastDepth) pixels.emplace_back(seen.x() / seen.z(), seen.y() / seen.z());
  }
  return pixels;
}

FrontView::FrontView(const session::SessionSetup& setup)
    : setup_(setup), camera_(record::cameraForPeople(setup, kWidth, kHeight - kLegendHeight)) {}

sensor_msgs::Image FrontView::draw(const traffic::TrafficSnapshot& snapshot,
                                   const std::vector<planning::PlannedAction>* actions) {
  sensor_msgs::Image message;
  message.header.stamp = toStamp(snapshot.time);
  message.encoding = "rgb8";
  message.width = kWidth;
  message.height = kHeight;
  message.step = 3 * kWidth;
  message.data.assign(static_cast<std::size_t>(message.step) * kHeight, 0);
  cv::Mat picture(kHeight, kWidth, CV_8UC3, message.data.data());
  drawLegend(picture(cv::Rect(0, kHeight - kLegendHeight, kWidth, kLegendHeight)),
             setup_.options().name + ", " + core::formatFixed(snapshot.time, 1) + " s");
  const traffic::Vehicle* cbv = followed_.update(snapshot);
  const traffic::Vehicle* seeing = cbv != nullptr ? cbv : snapshot.ego();
  if (seeing == nullptr || !video::isPlaced(*seeing)) return message;
  message.header.frame_id = opticalFrame(seeing->id, rendering::kFrontCamera);
  traffic::CameraImage image = camera_.render(snapshot, *seeing);
  cv::Mat view = picture(cv::Rect(0, 0, kWidth, kHeight - kLegendHeight));
  cv::Mat(image.height, image.width, CV_8UC3, image.rgb.data()).copyTo(view);
  const planning::PlannedAction* action = actionFor(actions, seeing->id);
  if (action != nullptr && !action->rollout.empty()) {
    const MarkerColor color = objectiveColor(strongestObjective(action->guidance));
    drawWay(view,
            projectedRollout(rendering::frontCamera(camera_.options()), *seeing, action->rollout),
            color);
  }
  drawHead(view, cbv, action);
  return message;
}

}  // namespace cdiff::node_graph
