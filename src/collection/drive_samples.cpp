// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/drive_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "collection/camera_sight.h"
#include "collection/dataset_statistics.h"
#include "collection/session_samples.h"
#include "diffusion/network/architecture.h"
#include "dynamics/action_rollout.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"

namespace cdiff::collection {

void DriveOptions::describe(core::OptionsVisitor& visitor) {
  visitor.text({"image", "", "Topic of the front camera's images."}, image, {});
  visitor.text({"odometry", "", "Topic of the vehicle's nav_msgs/Odometry."}, odometry, {});
  visitor.text({"control", "", "Topic of e2e_cdiff/ControlAction; empty: inferred."}, control, {});
  visitor.text({"path", "", "Topic of the route as nav_msgs/Path; empty: the path driven."}, path,
               {});
  visitor.number({"period", "s", "Time between samples."}, period, 0.05, 60.0);
  visitor.number({"largest_gap", "s", "Longest gap of odometry and controls in a sample."},
                 largest_gap, 0.01, 10.0);
}

void DriveOptions::validate() const {
  const auto require = [](const char* key, const std::string& topic) {
    if (topic.empty()) throw core::InputError(std::string("topics: ") + key + " is not given");
  };
  require("image", image);
  require("odometry", odometry);
}

std::optional<traffic::VehicleState> RecordedDrive::stateAt(double time, double largest_gap) const {
  const auto after = states.lower_bound(time);
  if (after == states.end()) return std::nullopt;
  if (after->first == time) return after->second;
  if (after == states.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (after->first - before->first > largest_gap) return std::nullopt;
  const double share = (time - before->first) / (after->first - before->first);
  const traffic::VehicleState& a = before->second;
  const traffic::VehicleState& b = after->second;
  traffic::VehicleState state = a;
  state.position += share * (b.position - a.position);
  state.elevation += share * (b.elevation - a.elevation);
  state.heading = core::wrapAngle(a.heading + share * core::angleDifference(b.heading, a.heading));
  state.speed += share * (b.speed - a.speed);
  return state;
}

std::optional<traffic::ControlAction> RecordedDrive::controlAt(double time,
                                                               double largest_gap) const {
  const auto after = controls.upper_bound(time);
  if (after == controls.begin()) return std::nullopt;
  const auto before = std::prev(after);
  if (time - before->first > largest_gap) return std::nullopt;
  return before->second;
}

namespace {

using core::InputError;

constexpr double kLeastPath = 0.5;        // a shorter path has no direction [m]
constexpr double kPart = 60.0;            // [s] of a drive that count as one session
constexpr double kImageTolerance = 0.05;  // [s]
constexpr double kReversing = 0.1;        // [m/s] backwards that is more than noise at standstill

class DriveSamples {
 public:
  DriveSamples(const RecordedDrive& drive, const DriveOptions& drive_options,
               const DatasetOptions& options, std::string name)
      : drive_(drive), drive_options_(drive_options), options_(options), name_(std::move(name)) {}

  std::vector<learning::DrivingSample> make(DatasetStatistics& statistics) const {
    std::vector<learning::DrivingSample> samples;
    double next = 0.0;
    for (const auto& [time, image] : drive_.images) {
      if (!samples.empty() && time < next) continue;
      ++statistics.images;
      std::optional<learning::DrivingSample> sample = sampleAt(time);
      if (!sample || reverses(*sample)) {
        ++statistics.dropped[sample ? "reversing" : "gap"];
        continue;
      }
      stopAtZero(*sample);
      next = time + drive_options_.period - 1e-6;
      sample->image = image;
      sample->image.tick = sample->tick;
      sample->previous_image = imageBefore(time);
      countUp(*sample, statistics);
      samples.push_back(std::move(*sample));
    }
    return samples;
  }

 private:
  /// The image kPreviousInterval before, give or take kImageTolerance; empty where there is none.
  traffic::CameraImage imageBefore(double time) const {
    const auto before = drive_.images.lower_bound(time - kPreviousInterval - kImageTolerance);
    if (before == drive_.images.end() || before->first > time - kPreviousInterval + kImageTolerance)
      return {};
    return before->second;
  }

  static bool reverses(const learning::DrivingSample& sample) {
    return std::min(sample.speed, sample.rollout.col(traffic::kRolloutSpeed).minCoeff()) <
           -kReversing;
  }

  static void stopAtZero(learning::DrivingSample& sample) {
    sample.speed = std::max(0.0, sample.speed);
    auto speeds = sample.rollout.col(traffic::kRolloutSpeed);
    speeds = speeds.cwiseMax(0.0);
  }

  std::optional<learning::DrivingSample> sampleAt(double time) const {
    const auto start = drive_.stateAt(time, drive_options_.largest_gap);
    if (!start) return std::nullopt;
    learning::DrivingSample sample;
    sample.speed = start->speed;  // below 0 until make() has looked at it
    const double since = time - drive_.images.begin()->first;
    sample.session = core::hashText(name_ + "_" + std::to_string(static_cast<int>(since / kPart)));
    sample.vehicle = name_;
    sample.tick = static_cast<std::uint64_t>(std::llround(since / (0.5 * traffic::kRolloutStep)));
    if (!fillRollout(time, *start, sample.rollout)) return std::nullopt;
    const auto tokens = routeAt(time, *start);
    if (!tokens) return std::nullopt;
    sample.route = *tokens;
    sample.auxiliary.assign(sightTargets().size(), std::numeric_limits<float>::quiet_NaN());
    return sample;
  }

  bool fillRollout(double time, const traffic::VehicleState& start,
                   traffic::Rollout& rollout) const {
    rollout.resize(options_.architecture.horizon, traffic::kRolloutColumns);
    traffic::VehicleState before = start;
    double heading = 0.0;
    for (Eigen::Index t = 0; t < rollout.rows(); ++t) {
      const double begin = time + traffic::kRolloutStep * static_cast<double>(t);
      const auto state = drive_.stateAt(begin + traffic::kRolloutStep, drive_options_.largest_gap);
      if (!state) return false;
      const double turn = core::angleDifference(state->heading, before.heading);
      const auto action =
          actionAt(begin, {std::max(0.0, before.speed), std::max(0.0, state->speed), turn});
      if (!action) return false;
      heading += turn;
      const Eigen::Vector2d position = start.pose().toBody(state->position);
      rollout.row(t) << position.x(), position.y(), heading, state->speed, action->throttle,
          action->steer, action->brake;
      before = *state;
    }
    return true;
  }

  std::optional<traffic::ControlAction> actionAt(double time,
                                                 const dynamics::ObservedMotion& motion) const {
    if (drive_options_.control.empty()) return dynamics::inferAction(model_, motion);
    return drive_.controlAt(time, drive_options_.largest_gap);
  }

  /// Along the path given last, or along the route that is driven from `time` on.
  std::optional<std::vector<float>> routeAt(double time, const traffic::VehicleState& start) const {
    const auto tokens = [&](const geometry::Polyline& path) {
      const double arc_length = path.project(start.position).arc_length;
      return diffusion::routeTokens(options_.architecture, path, arc_length, start.pose());
    };
    if (drive_options_.path.empty()) return tokens(wayFrom(time, start));
    const auto after = drive_.paths.upper_bound(time);
    if (after == drive_.paths.begin()) return std::nullopt;
    return tokens(std::prev(after)->second);
  }

  geometry::Polyline wayFrom(double time, const traffic::VehicleState& start) const {
    const auto point = [](const traffic::VehicleState& state) {
      return Eigen::Vector3d(state.position.x(), state.position.y(), state.elevation);
    };
    const double length = static_cast<double>(options_.architecture.route_points + 1) *
                          options_.architecture.route_spacing;
    std::vector<Eigen::Vector3d> points = {point(start)};
    double driven = 0.0;
    for (auto state = drive_.states.upper_bound(time);
         state != drive_.states.end() && driven < length; ++state) {
      if (state->second.speed < -kReversing) break;
      const double step = (point(state->second) - points.back()).head<2>().norm();
      if (step < kLeastPath) continue;
      driven += step;
      points.push_back(point(state->second));
    }
    if (points.size() < 2) {
      const Eigen::Vector2d ahead = start.position + geometry::direction(start.heading);
      points.emplace_back(ahead.x(), ahead.y(), start.elevation);
    }
    return geometry::Polyline(points);
  }

  void countUp(learning::DrivingSample& sample, DatasetStatistics& statistics) const {
    const SampleKinds kinds = kindsOf(sample);
    sample.maneuver = kinds.maneuver;
    sample.stop_reason = kinds.stop_reason;
    count(sample, kinds, statistics);
    ++statistics.samples;
  }

  const RecordedDrive& drive_;
  const DriveOptions& drive_options_;
  const DatasetOptions& options_;
  std::string name_;
  dynamics::BicycleModel model_;
};

}  // namespace

std::vector<learning::DrivingSample> samplesOf(const RecordedDrive& drive, const std::string& name,
                                               const DriveOptions& drive_options,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics) {
  if (drive.images.empty()) throw InputError("holds no image on '" + drive_options.image + "'");
  std::vector<learning::DrivingSample> samples =
      DriveSamples(drive, drive_options, options, name).make(statistics);
  if (samples.empty())
    throw InputError("gives no sample: none of its " + std::to_string(drive.images.size()) +
                     " images is followed by " + std::to_string(options.architecture.horizon) +
                     " steps of 0.1 s of odometry without a gap, driving forwards");
  statistics.seconds += drive.states.rbegin()->first - drive.states.begin()->first;
  return samples;
}

}  // namespace cdiff::collection
