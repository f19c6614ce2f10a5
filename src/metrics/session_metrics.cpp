// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "metrics/session_metrics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "metrics/cbv_measures.h"
#include "metrics/comfort_measures.h"
#include "metrics/contact_fault.h"
#include "metrics/ego_measures.h"
#include "metrics/interaction_statistics.h"
#include "metrics/normality_measures.h"
#include "metrics/post_encroachment.h"
#include "metrics/rift_measures.h"
#include "metrics/speed_target.h"

namespace cdiff::metrics {
namespace {

using traffic::TrafficSnapshot;
using traffic::Vehicle;
using traffic::VehicleRole;

constexpr double kBackgroundRadius = 150.0;  // [m] speeds of background vehicles are sampled within

/// Limit of the lane that a vehicle is on; off the road, of the nearest one.
std::optional<double> speedLimit(const Vehicle& vehicle, const map::RoadNetwork& network) {
  constexpr double kRadius = 5.0;  // [m] from a lane's centre line
  map::LaneIndex lane = network.findLane(vehicle.lane_id);
  if (lane == map::kNoLane) {
    const auto near = network.lanesNear(vehicle.state.position, vehicle.state.elevation, kRadius);
    if (!near.empty()) lane = near.front().lane;
  }
  if (lane == map::kNoLane) return std::nullopt;
  return network.lane(lane).speed_limit;
}

double wantedSpeed(const Vehicle& vehicle, const SessionMetricsOptions& options) {
  if (options.network == nullptr || !vehicle.state.position.allFinite())
    return options.target_speed;
  const std::optional<double> limit = speedLimit(vehicle, *options.network);
  return std::min(options.target_speed, limit.value_or(options.target_speed));
}

/// Of the centres; absent without ego, and where one passes under the other.
std::optional<double> distanceToEgo(const Vehicle& vehicle, const Vehicle* ego) {
  if (ego == nullptr || traffic::onDifferentLevels(vehicle, *ego)) return std::nullopt;
  return (vehicle.state.position - ego->state.position).norm();
}

}  // namespace

class SessionMetrics::Accumulator {
 public:
  Accumulator(const SessionMetricsOptions& options, const map::DrivableArea& drivable_area,
              const map::Route& ego_route)
      : options_(options),
        drivable_area_(drivable_area),
        ego_(ego_route, options.completion_percent, options.completion_distance,
             EgoInfractions(options.network, ego_route, options.infractions)),
        ego_contacts_(options.network, options.infractions.collision_minimum_speed),
        comfort_(options.decision_period),
        encroachments_(options.post_encroachment_limit),
        rift_(options.decision_period),
        speed_target_(options.metrics) {}

  TickMeasures observe(const TrafficSnapshot& snapshot) {
    TickMeasures tick;
    if (const Vehicle* ego = snapshot.ego()) observeEgo(*ego, snapshot, tick);
    tick.route_completion_percent = ego_.routeCompletionPercent();
    blocked_ = snapshot.status == traffic::SessionStatus::kBlocked;
    observeContacts(snapshot);
    ego_contacts_.observe(snapshot);
    observeCbvs(snapshot, tick);
    encroachments_.observe(snapshot);
    return tick;
  }

  SessionMeasures measures() const {
    SessionMeasures result;
    result.route_completion_percent = ego_.routeCompletionPercent();
    result.driving_score = ego_.drivingScore();
    result.ego_collisions = ego_.collisions();
    result.ego_contacts = ego_contacts_.contacts();
    result.protocol = options_.protocol;
    result.blocked = blocked_;
    result.penalty = ego_.infractions().penalty();
    result.infractions = ego_.infractions().measures();
    result.ego_off_road_percent = ego_.offRoadPercent();
    addCbvs(result);
    addMotion(result);
    interactions_.write(result);
    result.post_encroachment = encroachments_.measure();
    result.post_encroachments = encroachments_.times();
    result.rift_compat = rift_.measures();
    return result;
  }

 private:
  void addCbvs(SessionMeasures& result) const {
    result.cbv_count = cbvs_.count();
    result.cbv_decisions = cbvs_.decisions();
    result.cbv_off_road_rate_percent = cbvs_.offRoadRatePercent();
    result.cbv_corner_off_road_rate_percent = cbvs_.cornerOffRoadRatePercent();
    result.cbv_uncomfortable_rate_percent = comfort_.uncomfortableRatePercent();
    result.cbv_collisions = cbvs_.collisions();
    result.cbv_ego_collisions = cbvs_.egoCollisions();
    result.collisions_per_km = cbvs_.collisionsPerKilometre();
    result.ego_collisions_per_km = cbvs_.egoCollisionsPerKilometre();
    result.cbv_distance_m = cbvs_.distance();
    result.cbv_speed_error = cbvs_.speedError();
    result.cbv_closest_distance = cbvs_.closestDistance();
    result.cbv_minimum_distance = cbvs_.minimumDistance();
  }

  void addMotion(SessionMeasures& result) const {
    result.cbv_speed = comfort_.speed();
    result.cbv_acceleration = comfort_.acceleration();
    result.cbv_jerk = comfort_.jerk();
    const NormalityMeasures speeds = normalityMeasures(cbvs_.speeds(), kNoCbv);
    result.speed_shapiro_wilk = speeds.w;
    result.speed_shapiro_wilk_p = speeds.p;
    const NormalityMeasures accelerations = normalityMeasures(cbvs_.accelerations(), kNoCbv);
    result.acceleration_shapiro_wilk = accelerations.w;
    result.acceleration_shapiro_wilk_p = accelerations.p;
    result.speed_wasserstein = speed_target_.distanceFrom(cbvs_.speeds());
  }

  bool offRoad(const Vehicle& vehicle) const {
    const auto& state = vehicle.state;
    if (!state.position.allFinite()) return false;
    return drivable_area_.signedDistance(state.position, state.elevation) < 0.0;
  }

  /// All corners are looked for on the level of the vehicle.
  bool cornerOffRoad(const Vehicle& vehicle) const {
    const auto& state = vehicle.state;
    if (!state.position.allFinite() || !std::isfinite(state.heading)) return false;
    const auto corners = vehicle.box().corners();
    return std::any_of(corners.begin(), corners.end(), [&](const Eigen::Vector2d& corner) {
      return drivable_area_.signedDistance(corner, state.elevation) < 0.0;
    });
  }

  void observeEgo(const Vehicle& ego, const TrafficSnapshot& snapshot, TickMeasures& tick) {
    tick.ego_speed = ego.state.speed;
    tick.ego_off_road = offRoad(ego);
    ego_.observe(ego, tick.ego_off_road, snapshot);
    const Interaction interaction = interactionOf(
        ego, snapshot, {options_.ttc_radius, options_.ttc_limit, snapshot.decision_tick});
    tick.ttc_2d = interaction.ttc_2d;
    tick.nearest_distance = interaction.nearest_distance;
    if (!snapshot.decision_tick) return;
    const bool cbv_driven =
        std::any_of(snapshot.vehicles.begin(), snapshot.vehicles.end(),
                    [](const Vehicle& other) { return other.role == VehicleRole::kCbv; });
    interactions_.observe(interaction, cbv_driven);
    rift_.observeEgo(ego.state.speed, interaction.rift_ttc, interaction.rift_act);
    sampleBackground(ego, snapshot);
  }

  void sampleBackground(const Vehicle& ego, const TrafficSnapshot& snapshot) {
    for (const Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role != VehicleRole::kBackground || !std::isfinite(vehicle.state.speed)) continue;
      const double distance = (vehicle.state.position - ego.state.position).norm();
      if (distance <= kBackgroundRadius) speed_target_.addBackground(vehicle.state.speed);
    }
  }

  /// By the role now, or at the last tick for a vehicle that this contact removed. Call before
  /// observeCbvs.
  bool isCbv(const TrafficSnapshot& snapshot, const std::string& id) const {
    const Vehicle* vehicle = snapshot.find(id);
    return vehicle != nullptr ? vehicle->role == VehicleRole::kCbv : cbvs_.isDriven(id);
  }

  void observeContacts(const TrafficSnapshot& snapshot) {
    for (const traffic::Contact& contact : snapshot.contacts) {
      const bool with_ego = contact.first == ego_.id() || contact.second == ego_.id();
      if (with_ego) ego_.countCollision(snapshot, contact);
      bool with_cbv = false;
      for (const std::string* id : {&contact.first, &contact.second}) {
        if (!isCbv(snapshot, *id)) continue;
        with_cbv = true;
        rift_.countCollision(*id);
      }
      if (with_cbv) cbvs_.countCollision(with_ego);
    }
  }

  void observeCbvs(const TrafficSnapshot& snapshot, TickMeasures& tick) {
    sightings_.clear();
    for (const Vehicle& vehicle : snapshot.vehicles) {
      if (vehicle.role != VehicleRole::kCbv) continue;
      sightings_.push_back({&vehicle, offRoad(vehicle), wantedSpeed(vehicle, options_),
                            distanceToEgo(vehicle, snapshot.ego()), cornerOffRoad(vehicle)});
      if (sightings_.back().off_road) ++tick.cbv_off_road;
    }
    cbvs_.observe(sightings_, snapshot.decision_tick);
    if (!snapshot.decision_tick) return;
    comfort_.observe(sightings_);
    rift_.observeCbvs(sightings_);
  }

  SessionMetricsOptions options_;
  const map::DrivableArea& drivable_area_;
  EgoMeasures ego_;
  EgoContacts ego_contacts_;
  bool blocked_ = false;  ///< by the last snapshot
  CbvMeasures cbvs_;
  ComfortMeasures comfort_;
  InteractionStatistics interactions_;
  PostEncroachmentTimes encroachments_;
  RiftMeasures rift_;
  SpeedTarget speed_target_;
  std::vector<CbvSighting> sightings_;  ///< of the present tick
};

SessionMetrics::SessionMetrics(const SessionMetricsOptions& options,
                               const map::DrivableArea& drivable_area, const map::Route& ego_route)
    : accumulator_(std::make_unique<Accumulator>(options, drivable_area, ego_route)) {}

SessionMetrics::~SessionMetrics() = default;

TickMeasures SessionMetrics::observe(const TrafficSnapshot& snapshot, const cbv::CbvSelection*) {
  return accumulator_->observe(snapshot);
}

SessionMeasures SessionMetrics::measures() const { return accumulator_->measures(); }

}  // namespace cdiff::metrics
