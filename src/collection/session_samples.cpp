// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/session_samples.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "collection/dataset_statistics.h"
#include "collection/displaced_samples.h"
#include "collection/policy_plans.h"
#include "diffusion/network/architecture.h"
#include "e2e_cdiff/core/angle.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "planners/diffusion/diffusion_options.h"
#include "planning/route_follower.h"

namespace cdiff::collection {
namespace {

using core::InputError;

constexpr std::size_t kPreviousDecisions = 4;  // kPreviousInterval before
constexpr double kSlow = 2.0;                  // [m/s]

/// Where a vehicle is on its route at a decision.
struct Place {
  DriveKey drive;
  double arc_length = 0.0;    ///< as planners see it [m]
  std::size_t decisions = 0;  ///< before this one at which it was driven
};

/// Makes the training samples of one driven session and adds them to the statistics (samplesOf in
/// session_samples.h); one object per session.
class SampleMaker {
 public:
  SampleMaker(const DrivenSession& session, const DatasetOptions& options,
              DatasetStatistics& statistics)
      : session_(session),
        options_(options),
        statistics_(statistics),
        horizon_(static_cast<std::size_t>(options.architecture.horizon)),
        thinning_(static_cast<std::uint64_t>(session.setup->options().seed), "dataset_standing"),
        offsets_(static_cast<std::uint64_t>(session.setup->options().seed), "dataset_offset"),
        displaced_samples_(*session.setup, options) {
    for (std::size_t i = 0; i < session.decisions.size(); ++i)
      index_[session.decisions[i].tick] = i;
    if (options.policy_plans > 0) {
      const auto& planners = session.setup->options().planner_options;
      plans_.emplace(planners.of<planners::DiffusionOptions>().model, options.policy_plans,
                     *session.setup);
    }
    followAll();
  }

  std::vector<learning::DrivingSample> make() {
    std::vector<learning::DrivingSample> samples;
    for (const DrivenImage& image : session_.images) {
      ++statistics_.images;
      const char* reason = tryImage(image, samples);
      if (reason != nullptr) ++statistics_.dropped[reason];
    }
    for (const auto& [drive, route] : session_.routes) driven_.insert(drive.first);
    for (const std::string& id : driven_) {
      const auto contacts = session_.contacts.find(id);
      if (contacts != session_.contacts.end()) statistics_.contacts += contacts->second.size();
    }
    statistics_.samples += samples.size();
    statistics_.seconds += session_.seconds;
    return samples;
  }

 private:
  /// Finds the arc length of every drive on its route at each decision, as its planner did.
  void followAll() {
    std::map<DriveKey, std::pair<planning::RouteFollower, std::size_t>> followers;
    for (const traffic::TrafficSnapshot& snapshot : session_.decisions) {
      const auto drives = session_.drives.find(snapshot.tick);
      if (drives == session_.drives.end()) continue;
      for (const auto& [slot, key] : drives->second) {
        const traffic::Vehicle* vehicle = snapshot.find(key.first);
        if (vehicle == nullptr) continue;
        auto& [follower, decisions] = followers[key];
        follower.update(session_.routes.at(key), vehicle->state.position);
        places_[{snapshot.tick, slot}] = {key, follower.arcLength(), decisions++};
      }
    }
  }

  /// Appends the sample of an image, and perhaps a displaced one; returns why there is none, or
  /// nullptr.
  const char* tryImage(const DrivenImage& image, std::vector<learning::DrivingSample>& samples) {
    const auto at = index_.find(image.image.tick);
    const auto place = places_.find({image.image.tick, image.slot});
    if (at == index_.end() || place == places_.end()) return "no_vehicle";
    requireSize(image.image);
    if (at->second + horizon_ >= session_.decisions.size()) return "session_end";
    const char* reason = unfit(at->second, image.slot, place->second.drive);
    if (reason != nullptr) return reason;
    learning::DrivingSample sample = sampleAt(at->second, place->second);
    sample.image = image.image;
    addPrevious(at->second, place->second, sample);
    const SampleSurroundings surroundings{*session_.setup, session_.decisions[at->second],
                                          session_.routes.at(place->second.drive),
                                          place->second.arc_length};
    const SampleKinds kinds = kindsOf(sample, surroundings);
    if (kinds.standing && !keepsStanding(sample)) return "standing_thinned";
    sample.maneuver = kinds.maneuver;
    sample.stop_reason = kinds.stop_reason;
    sample.auxiliary =
        displaced_samples_.targets(*surroundings.snapshot.find(sample.vehicle), surroundings);
    count(sample, kinds, statistics_);
    samples.push_back(std::move(sample));
    const std::size_t recorded = samples.size() - 1;
    addDisplaced(at->second, surroundings, kinds, samples);
    addPlanned(at->second, surroundings, samples[recorded], samples);
    return nullptr;
  }

  /// The image before, where the vehicle was driven by then: at a take-over it may jump. Rendered
  /// here, which gives the bytes that it saw.
  void addPrevious(std::size_t begin, const Place& place, learning::DrivingSample& sample) {
    if (options_.target_speed) sample.target_speed = options_.target_speed(sample.vehicle);
    if (place.decisions < kPreviousDecisions || begin < kPreviousDecisions) return;
    const traffic::TrafficSnapshot& snapshot = session_.decisions[begin - kPreviousDecisions];
    const traffic::Vehicle* vehicle = snapshot.find(sample.vehicle);
    if (vehicle == nullptr) return;
    sample.previous_image = displaced_samples_.seen(snapshot, *vehicle, vehicle->state);
  }

  std::vector<const traffic::TrafficSnapshot*> futureOf(std::size_t begin) const {
    std::vector<const traffic::TrafficSnapshot*> future;
    for (std::size_t t = 1; t <= horizon_; ++t) future.push_back(&session_.decisions[begin + t]);
    return future;
  }

  /// Appends a plan of the policy for the recorded sample, where it moves and plans are drawn.
  void addPlanned(std::size_t begin, const SampleSurroundings& surroundings,
                  const learning::DrivingSample& recorded,
                  std::vector<learning::DrivingSample>& samples) {
    if (!plans_ || recorded.speed < kSlow) return;
    auto planned = plans_->improved(recorded, surroundings, futureOf(begin));
    if (!planned) return;
    SampleKinds kinds = kindsOf(*planned, surroundings);
    kinds.planned = true;
    planned->maneuver = kinds.maneuver;
    planned->stop_reason = kinds.stop_reason;
    count(*planned, kinds, statistics_);
    samples.push_back(std::move(*planned));
  }

  /// For a share of the moving vehicles, appends a second sample: the last one with its vehicle
  /// displaced from its route (DisplacedSamples).
  void addDisplaced(std::size_t begin, const SampleSurroundings& surroundings, SampleKinds kinds,
                    std::vector<learning::DrivingSample>& samples) {
    const learning::DrivingSample& sample = samples.back();
    const core::RandomKey key{core::hashText(sample.vehicle),
                              static_cast<std::uint32_t>(sample.tick), 0};
    if (sample.speed < kSlow || offsets_.uniform(key, 0) >= options_.offset_share) return;
    const double heading = core::degreesToRadians(options_.offset_heading);
    const SampleOffset offset{
        offsets_.uniform(key, 1, -options_.offset_lateral, options_.offset_lateral),
        offsets_.uniform(key, 2, -heading, heading)};
    const std::size_t back = sample.previous_image.empty() ? 0 : kPreviousDecisions;
    auto displaced = displaced_samples_.displace(
        sample, surroundings, session_.decisions[begin - back], futureOf(begin), offset);
    if (!displaced) return;
    kinds.displaced = true;
    kinds.off_course = displaced->off_course;
    count(displaced->sample, kinds, statistics_);
    samples.push_back(std::move(displaced->sample));
  }

  void requireSize(const traffic::CameraImage& image) const {
    const diffusion::Architecture& wanted = options_.architecture;
    if (image.width == wanted.image_width && image.height == wanted.image_height) return;
    throw InputError("its images are " + std::to_string(image.width) + " x " +
                     std::to_string(image.height) + "; expected " +
                     std::to_string(wanted.image_width) + " x " +
                     std::to_string(wanted.image_height));
  }

  /// Why the decisions from `begin` to the end of the horizon make no sample (not driven by its
  /// planner, disturbed, jumped or in contact), or nullptr.
  const char* unfit(std::size_t begin, int slot, const DriveKey& drive) const {
    constexpr double kJump = 0.5;  // [m] between distance moved and that from the speeds
    const traffic::Vehicle* before = nullptr;
    for (std::size_t i = begin; i <= begin + horizon_; ++i) {
      const traffic::TrafficSnapshot& snapshot = session_.decisions[i];
      const traffic::Vehicle* vehicle = snapshot.find(drive.first);
      if (vehicle == nullptr || !vehicle->applied_action) return "not_driven";
      const auto place = places_.find({snapshot.tick, slot});
      const bool last = i == begin + horizon_;
      if (!last && (place == places_.end() || place->second.drive != drive)) return "not_driven";
      if (!last && session_.disturbed.count({drive.first, snapshot.tick}) != 0) return "disturbed";
      if (before != nullptr) {
        const double moved = (vehicle->state.position - before->state.position).norm();
        const double expected =
            0.5 * traffic::kRolloutStep * (vehicle->state.speed + before->state.speed);
        if (std::abs(moved - expected) > kJump) return "jump";
      }
      before = vehicle;
    }
    return touches(drive.first, begin) ? "contact" : nullptr;
  }

  bool touches(const std::string& vehicle, std::size_t begin) const {
    const auto contacts = session_.contacts.find(vehicle);
    if (contacts == session_.contacts.end()) return false;
    const std::uint64_t first = session_.decisions[begin].tick;
    const std::uint64_t last = session_.decisions[begin + horizon_].tick;
    return std::any_of(contacts->second.begin(), contacts->second.end(),
                       [&](std::uint64_t tick) { return tick >= first && tick <= last; });
  }

  /// The sample without image and kinds; rows in the frame of the vehicle at `begin` (SI units).
  learning::DrivingSample sampleAt(std::size_t begin, const Place& place) const {
    const traffic::TrafficSnapshot& snapshot = session_.decisions[begin];
    const std::string& id = place.drive.first;
    const traffic::VehicleState& start = snapshot.find(id)->state;
    learning::DrivingSample sample;
    sample.speed = start.speed;
    sample.session = core::hashText(session_.name);
    sample.vehicle = id;
    sample.tick = snapshot.tick;
    sample.recovering = recovers(begin, place);
    sample.route =
        diffusion::routeTokens(options_.architecture, session_.routes.at(place.drive).path(),
                               place.arc_length, start.pose());
    sample.rollout.resize(static_cast<Eigen::Index>(horizon_), traffic::kRolloutColumns);
    double heading = 0.0;
    double last_heading = start.heading;
    for (std::size_t t = 0; t < horizon_; ++t) {
      const traffic::Vehicle& vehicle = *session_.decisions[begin + t + 1].find(id);
      heading += core::angleDifference(vehicle.state.heading, last_heading);
      last_heading = vehicle.state.heading;
      const Eigen::Vector2d position = start.pose().toBody(vehicle.state.position);
      const traffic::ControlAction& action = *vehicle.applied_action;
      sample.rollout.row(static_cast<Eigen::Index>(t)) << position.x(), position.y(), heading,
          vehicle.state.speed, action.throttle, action.steer, action.brake;
    }
    return sample;
  }

  /// Whether a disturbance or the take-over of the vehicle lies at most 2 s back.
  bool recovers(std::size_t begin, const Place& place) const {
    constexpr std::size_t kMemory = 20;  // decisions
    if (place.drive.first != session_.decisions[begin].vehicles.front().id &&
        place.decisions <= kMemory)
      return true;
    for (std::size_t back = 1; back <= std::min(kMemory, begin); ++back) {
      const std::uint64_t tick = session_.decisions[begin - back].tick;
      if (session_.disturbed.count({place.drive.first, tick}) != 0) return true;
    }
    return false;
  }

  /// Draws whether a sample of a vehicle that only stands is kept.
  bool keepsStanding(const learning::DrivingSample& sample) const {
    const core::RandomKey key{core::hashText(sample.vehicle),
                              static_cast<std::uint32_t>(sample.tick), 0};
    return thinning_.uniform(key, 0) < options_.standing_share;
  }

  const DrivenSession& session_;
  const DatasetOptions& options_;
  DatasetStatistics& statistics_;
  std::size_t horizon_;
  core::RandomStream thinning_;
  core::RandomStream offsets_;
  DisplacedSamples displaced_samples_;
  std::optional<PolicyPlans> plans_;
  std::map<std::uint64_t, std::size_t> index_;             ///< of the decision, by tick
  std::map<std::pair<std::uint64_t, int>, Place> places_;  ///< by tick and slot
  std::set<std::string> driven_;                           ///< ids of vehicles
};

}  // namespace

std::vector<learning::DrivingSample> samplesOf(const DrivenSession& session,
                                               const DatasetOptions& options,
                                               DatasetStatistics& statistics) {
  return SampleMaker(session, options, statistics).make();
}

}  // namespace cdiff::collection
