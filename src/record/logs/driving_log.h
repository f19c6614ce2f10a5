// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/planning/planner.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "metrics/formulas/sample_statistics.h"

namespace cdiff::record {

/// A sample counted in bins of equal width, with its mean and standard deviation (n - 1, Welford
/// 1962); values beyond the ends count in the outermost bins, values that are not finite nowhere.
class Histogram {
 public:
  /// `bins` (at least 1) bins of `width` (positive), the first from `low`.
  Histogram(double low, double width, std::size_t bins);
  void add(double value);

  double low() const { return low_; }
  double width() const { return width_; }
  std::size_t n() const { return statistics_.count(); }
  const std::vector<std::size_t>& counts() const { return counts_; }
  /// Share of the sample in a bin; 0 when the sample is empty.
  double share(std::size_t bin) const;
  /// Of the values themselves, not of their bins; absent when n = 0.
  std::optional<double> mean() const { return statistics_.mean(); }
  /// Likewise, with n - 1; absent when n < 2.
  std::optional<double> standardDeviation() const { return statistics_.standardDeviation(); }

 private:
  double low_;
  double width_;
  std::vector<std::size_t> counts_;
  metrics::SampleStatistics statistics_;
};

/// How fast CBVs and background vehicles drove and accelerated: histograms over all decisions and
/// vehicles, of speed [m/s] and acceleration [m/s^2].
class DrivingLog {
 public:
  struct Role {
    Histogram speed{0.0, 0.5, 70};           ///< to 35 m/s
    Histogram acceleration{-8.0, 0.25, 64};  ///< to 8 m/s^2
  };
  /// Every tick in order; decisions count.
  void observe(const traffic::TrafficSnapshot& snapshot);
  const Role& cbv() const { return cbv_; }
  const Role& background() const { return background_; }

 private:
  Role cbv_;
  Role background_;
};

/// A vehicle that was seen at any time.
struct TimelineVehicle {
  std::string id;
  double length = 0.0;  ///< [m]
  double width = 0.0;   ///< [m]
};

/// One vehicle in one frame.
struct TimelinePose {
  double x = 0.0;        ///< [m]
  double y = 0.0;        ///< [m]
  float heading = 0.0F;  ///< [rad]
  float speed = 0.0F;    ///< [m/s]
  float throttle = 0.0F;
  float steer = 0.0F;
  float brake = 0.0F;
  bool driven = false;        ///< whether the three commands are there
  std::uint32_t vehicle = 0;  ///< index in Timeline::vehicles()
  traffic::VehicleRole role = traffic::VehicleRole::kBackground;
  int slot = -1;      ///< slot of a CBV
  float gap = -1.0F;  ///< gap from a CBV to the ego's box [m]; negative: not defined
  /// 2D-TTC [s] of a CBV and the ego; of the ego and any vehicle; negative: not defined.
  float time_to_collision = -1.0F;
};

/// How much the planner of one vehicle looked at another (planning::AttendedVehicle).
struct TimelineAttention {
  std::uint32_t driver = 0;  ///< index in Timeline::vehicles(), as is the next
  std::uint32_t vehicle = 0;
  float weight = 0.0F;  ///< [0, 1]
};

/// Poses of all vehicles at one time.
struct TimelineFrame {
  double time = 0.0;  ///< [s]
  std::pmr::vector<TimelinePose> poses;
  std::pmr::vector<TimelineAttention>
      gazes;                        ///< the largest of each driver, of planners that say them
  planning::Perception perception;  ///< of the ego's planner; of forecasts the likeliest alone
  bool event = false;  ///< a contact, or the closest approach of a CBV: thinning keeps it
};

/// The frame of a snapshot by itself: its poses count in its own vehicles.
struct LoneFrame {
  TimelineFrame frame;
  std::pmr::vector<TimelineVehicle> vehicles;  ///< of the poses, in their order
};

LoneFrame loneFrame(const traffic::TrafficSnapshot& snapshot);

/// A contact of two vehicles, with its place in the map frame [m].
struct TimelineContact {
  double time = 0.0;  ///< [s]
  std::string first;
  std::string second;
  std::optional<Eigen::Vector2d>
      position;  ///< midway between the two; absent when one was not in the snapshot
};

/// The smallest gap between the boxes of the ego and a CBV.
struct SmallestGap {
  double time = 0.0;      ///< [s]
  double distance = 0.0;  ///< [m]
  std::string vehicle_id;
};

/// The session thinned to what pictures need: poses of all vehicles every 0.2 s and at each contact
/// (map frame) with times to collision, contacts, and the smallest gap between ego and CBVs over
/// all ticks.
class Timeline {
 public:
  /// What grows with the session lies in `memory`, which must outlive the timeline.
  explicit Timeline(double simulation_step,
                    std::pmr::memory_resource* memory = std::pmr::get_default_resource());
  void observe(const traffic::TrafficSnapshot& snapshot);
  /// What the planners looked at, after `observe` of the snapshot that they decided on. Of each
  /// driver the eight largest weights are kept, those below 0.02 not.
  void observeAttention(const traffic::TrafficSnapshot& snapshot,
                        const std::vector<planning::PlannedAction>& actions);
  /// What the ego's planner believed to see, likewise.
  void observePerception(const traffic::TrafficSnapshot& snapshot,
                         const std::vector<planning::PlannedAction>& actions);

  /// Adds the frame of an earlier tick that turned out to be an event, after the last `observe`. It
  /// has the attention and perception of the frame before it.
  void addEvent(const LoneFrame& event);
  /// A frame of a snapshot, which is not kept; its vehicles are.
  TimelineFrame frameOf(const traffic::TrafficSnapshot& snapshot);

  /// In order of appearance.
  const std::pmr::vector<TimelineVehicle>& vehicles() const { return vehicles_; }
  const std::pmr::vector<TimelineFrame>& frames() const { return frames_; }
  const std::vector<TimelineContact>& contacts() const { return contacts_; }
  const std::optional<SmallestGap>& smallestGap() const { return smallest_gap_; }
  /// Id of the vehicle that another one touched last in [begin, end] [s]; nullopt when none.
  std::optional<std::string> lastContactOf(const std::string& id, double begin, double end) const;
  /// Time of the last snapshot [s].
  double duration() const { return duration_; }

 private:
  void addContacts(const traffic::TrafficSnapshot& snapshot);
  void updateGap(const traffic::TrafficSnapshot& snapshot);
  TimelineFrame kept(const TimelineFrame& frame);
  TimelineFrame adopt(LoneFrame lone);
  std::uint32_t indexOf(const TimelineVehicle& vehicle);

  std::uint64_t ticks_per_frame_;
  double duration_ = 0.0;
  std::pmr::vector<TimelineVehicle> vehicles_;
  std::pmr::unordered_map<std::string, std::uint32_t> index_by_id_;
  std::pmr::vector<TimelineFrame> frames_;
  std::vector<TimelineContact> contacts_;
  std::optional<SmallestGap> smallest_gap_;
};

}  // namespace cdiff::record
