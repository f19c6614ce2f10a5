// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "e2e_cdiff/core/options.h"
#include "e2e_cdiff/dynamics/bicycle_model.h"
#include "e2e_cdiff/guidance/guidance_options.h"
#include "e2e_cdiff/map/drivable_area.h"
#include "e2e_cdiff/map/route.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "e2e_cdiff/rendering/camera_rig.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"

namespace cdiff::planning {

/// What a planner may keep for the session; all references outlive the planner.
struct PlanningContext {
  const map::RoadNetwork& network;         ///< of the session
  const map::DrivableArea& drivable_area;  ///< of that network
  std::uint64_t seed = 1;                  ///< root seed of the session
  double simulation_step = 0.05;           ///< [s]
  double decision_period = 0.1;            ///< [s]
  const map::Route* ego_route = nullptr;   ///< for forecasts of the ego; may be null
};

/// How a vehicle drives, for planners that follow by IDM (defaults: PDM-Lite's). With an
/// acceleration the style is *even*: smooth pedals in place of full throttle and full brake by
/// turns.
struct DrivingStyle {
  double minimum_gap = 4.0;    ///< s0 behind a leader [m]
  double time_headway = 0.25;  ///< T [s]
  double acceleration = 0.0;   ///< a [m/s^2]; 0: PDM-Lite's own pedals, full or none
  double deceleration = 3.0;   ///< b, comfortable, where a is given [m/s^2]
  /// Whether pedals are smooth.
  bool even() const { return acceleration > 0.0; }
};

/// What the cameras of a vehicle saw at a decision; without a rig for planners that see nothing.
struct CameraViews {
  const rendering::CameraRig* rig = nullptr;  ///< the cameras; null: none
  /// One per camera, in the rig's order; nullptr where none came.
  std::vector<const traffic::CameraImage*> images;

  /// The image of a camera, or nullptr.
  const traffic::CameraImage* find(const std::string& camera) const;
  /// Name of the first camera whose image did not come; empty when all came.
  std::string missing() const;
};

/// One vehicle to drive at this decision.
struct PlanningTask {
  int slot = traffic::kEgoSlot;                 ///< that, or of a CBV
  const traffic::Vehicle* vehicle = nullptr;    ///< in the snapshot; never null
  const map::Route* route = nullptr;            ///< ego route, or the CBV's conflict-aware route
  double target_speed = 8.0;                    ///< v* before the lane's limit [m/s]
  const traffic::CameraImage* image = nullptr;  ///< of its camera "front", for planners that see
  DrivingStyle style = {};                      ///< for planners that follow by IDM
  CameraViews views = {};                       ///< of all its cameras, for planners that see
};

/// A state and the action that leads to it; a plan is a list of these (plan step 0.1 s), for
/// display.
struct RolloutPoint {
  traffic::VehicleState state;    ///< map frame
  traffic::ControlAction action;  ///< during the plan step before it
};

/// How much a planner looked at a vehicle when it decided.
struct AttendedVehicle {
  std::string vehicle_id;  ///< in the snapshot
  double weight = 0.0;     ///< share of the planner's attention, in [0, 1]; all together at most 1
};

/// Time from one place of a candidate to the next [s].
inline constexpr double kCandidateStep = 0.5;

/// A plan that a planner weighed against others (map frame).
struct PlannedCandidate {
  std::vector<Eigen::Vector2d> places;  ///< kCandidateStep apart, the first one that far ahead [m]
  double score = 0.0;                   ///< in the planner's own measure; the larger the better
  bool chosen = false;                  ///< the rollout comes from it
};

/// A way that a planner thinks another vehicle may take (map frame).
struct PerceivedForecast {
  std::vector<Eigen::Vector2d> places;  ///< kCandidateStep apart, the first one that far ahead [m]
  double probability = 0.0;             ///< in [0, 1]
};

/// A vehicle that a planner believes to see (map frame).
struct PerceivedVehicle {
  traffic::VehicleState state;               ///< as it is believed to be
  traffic::VehicleDimensions dimensions;     ///< likewise
  double score = 0.0;                        ///< in [0, 1]
  std::vector<PerceivedForecast> forecasts;  ///< in the planner's own order
};

/// A line of the road that a planner believes to see (map frame).
struct PerceivedLine {
  std::string kind;                     ///< "edge", "divider" or "center"
  std::vector<Eigen::Vector2d> points;  ///< [m]
  double score = 0.0;                   ///< in [0, 1]
};

/// Which cells around the vehicle a planner expects to be occupied, at one time ahead: row-major,
/// rows along the vehicle's x, columns along its y; the first cell's corner lies at `origin`.
struct PerceivedOccupancy {
  double time = 0.0;                                 ///< ahead [s]
  geometry::Pose2d frame;                            ///< of the vehicle now (map frame)
  Eigen::Vector2d origin = Eigen::Vector2d::Zero();  ///< in `frame` [m]
  double cell = 1.0;                                 ///< side of a cell [m]
  int rows = 0;                                      ///< number of cells along x
  int columns = 0;                                   ///< number of cells along y
  std::vector<float> probability;                    ///< [rows x columns], in [0, 1]
};

/// What a planner believes to see when it decides, for people who look: markers, report, video.
struct Perception {
  std::vector<PerceivedVehicle> vehicles;     ///< in the planner's own order
  std::vector<PerceivedLine> lines;           ///< likewise
  std::vector<PerceivedOccupancy> occupancy;  ///< by time
  /// Whether it holds nothing.
  bool empty() const { return vehicles.empty() && lines.empty() && occupancy.empty(); }
};

/// What a planner decided for one vehicle: the action to apply, with the rollout and the report it
/// comes from.
struct PlannedAction {
  int slot = traffic::kEgoSlot;         ///< of the task
  std::string vehicle_id;               ///< of the task's vehicle
  traffic::ControlAction action;        ///< to apply until the next decision
  std::vector<RolloutPoint> rollout;    ///< may be empty
  std::string fault{};                  ///< why `action` is the fail-safe action; empty when none
  guidance::GuidanceReport guidance{};  ///< what guidance did; set by planners that are guided
  double state_mismatch = 0.0;  ///< largest distance of planned states from what the dynamics does
                                ///< with the planned actions [m]
  std::vector<PlannedCandidate>
      candidates{};                         ///< in the planner's own order; empty: it weighs none
  std::vector<AttendedVehicle> attended{};  ///< in the planner's own order; empty: it does not say
  Perception perception{};                  ///< empty: it sees nothing, or does not say
};

/// The fail-safe action for a task; with a reason it is a fault, "vehicle 'ID': REASON; full
/// braking instead".
PlannedAction failSafeAction(const PlanningTask& task, const std::string& reason = "");

/// The one interface of everything that drives: at a decision, an action for each of its vehicles.
class Planner {
 public:
  virtual ~Planner() = default;
  /// Actions for all tasks of a decision, in their order (slot order). Deterministic: same calls,
  /// same actions.
  virtual std::vector<PlannedAction> plan(const traffic::TrafficSnapshot& snapshot,
                                          const std::vector<PlanningTask>& tasks) = 0;
  /// Whether its tasks must come with images.
  virtual bool needsImages() const { return false; }
};

/// Name of the ego's planner where a node of the user's own drives it.
inline constexpr const char* kExternalPlanner = "external";

/// Options of one planner, whatever their type. In a scenario file they are the group of the
/// planner's name.
class PlannerOptions {
 public:
  virtual ~PlannerOptions() = default;
  /// Visits every option.
  virtual void describe(core::OptionsVisitor& visitor) = 0;
  /// Throws InputError for values that contradict each other.
  virtual void validate() const = 0;
  /// A copy.
  virtual std::unique_ptr<PlannerOptions> clone() const = 0;
};

/// Options held in a struct with `describe` and `validate`.
template <class Options>
class PlannerOptionsOf final : public PlannerOptions {
 public:
  /// Visits every option.
  void describe(core::OptionsVisitor& visitor) override { values.describe(visitor); }
  void validate() const override { values.validate(); }
  /// A copy.
  std::unique_ptr<PlannerOptions> clone() const override {
    return std::make_unique<PlannerOptionsOf>(*this);
  }
  Options values;  ///< the struct
};

/// The options of all planners of a scenario. Copies are deep.
class PlannerOptionsTable {
 public:
  /// A planner's name with a sentence about it, and its options.
  struct Entry {
    std::string name;                         ///< of the planner
    std::string help;                         ///< the sentence
    std::unique_ptr<PlannerOptions> options;  ///< never null
  };

  PlannerOptionsTable() = default;
  /// One entry per planner.
  explicit PlannerOptionsTable(std::vector<Entry> entries) : entries_(std::move(entries)) {}
  PlannerOptionsTable(const PlannerOptionsTable& other);                     ///< deep copy
  PlannerOptionsTable(PlannerOptionsTable&&) noexcept = default;             ///< move
  PlannerOptionsTable& operator=(const PlannerOptionsTable& other);          ///< deep copy
  PlannerOptionsTable& operator=(PlannerOptionsTable&&) noexcept = default;  ///< move

  /// The options of type `Options`; several planners may use those of one. Throws std::logic_error
  /// when no planner has options of this type.
  template <class Options>
  Options& of() {
    for (Entry& entry : entries_) {
      if (auto* found = dynamic_cast<PlannerOptionsOf<Options>*>(entry.options.get()))
        return found->values;
    }
    throw std::logic_error("no planner is registered with these options");
  }
  /// The same, to read.
  template <class Options>
  const Options& of() const {
    return const_cast<PlannerOptionsTable*>(this)->of<Options>();
  }
  /// Visits one group per planner, under its name.
  void describe(core::OptionsVisitor& visitor);
  /// Throws InputError for the first planner whose values contradict each other.
  void validate() const;

 private:
  std::vector<Entry> entries_;
};

/// What a planner is made of. References outlive the planner, as those of the context do.
struct PlannerParts {
  PlanningContext context;                       ///< what it may keep for the session
  const PlannerOptionsTable& options;            ///< of all planners of the scenario
  const dynamics::BicycleModelOptions& vehicle;  ///< how its vehicles move
  const rendering::CameraOptions& camera;        ///< that the vehicle's images come from
  const guidance::GuidanceOptions& guidance;     ///< of planners that are guided
  std::string guidance_group = "guidance.";      ///< before its keys in errors
  rendering::RigOptions rig_options = {};        ///< cameras of the planner's vehicles, as given
  std::string rig_key = "ego_rig";               ///< their key in errors
  rendering::CameraRig rig = {};  ///< what they are, filled in by makePlanner; copy what is kept
};

/// The network behind a planner, for the record of a session.
struct NetworkFacts {
  std::string model;         ///< shipped name, or folder of its weight files
  std::string conditioning;  ///< what it is given, in the planner's own words
  std::string sampling;      ///< how a decision comes from it, likewise
  std::map<std::string, std::string> instruction_sets;  ///< by key in session.yaml
};

/// What is known about a planner before one is made: name, roles, needs, options and constructor.
/// Scenario files, the node graph, reports, tables and error texts read descriptors only.
/// Everything about a planner but the planner itself.
struct PlannerDescriptor {
  std::string name;                  ///< in scenario files, snake_case
  std::string title;                 ///< in tables, as its authors write it
  std::string help;                  ///< one sentence
  bool drives_ego = true;            ///< whether it can be the ego's planner
  bool drives_cbv = true;            ///< whether it can be the planner of CBVs
  std::vector<std::string> cameras;  ///< names of the cameras that it needs; none: it sees nothing
  std::string rig = rendering::kFrontRig;  ///< preset that its vehicles have unless the scenario
                                           ///< says otherwise; holds `cameras`
  bool guided = false;                     ///< follows guidance objectives
  /// Program that runs it for the CBVs in the node graph.
  std::string cbv_node = "cbv_planner_node";
  /// Its options with their defaults.
  std::function<std::unique_ptr<PlannerOptions>()> options;
  /// Throws InputError naming the key of an option that it cannot work with.
  std::function<std::unique_ptr<Planner>(const PlannerParts&)> make;
  /// Empty where the planner has no network.
  std::function<NetworkFacts(const PlannerOptionsTable&, const guidance::GuidanceOptions&)> network;
  /// SHA-256 over the weight files of the network; throws InputError when one cannot be read.
  std::function<std::string(const PlannerOptionsTable&)> weights_sha256;

  /// Whether it needs images.
  bool sees() const { return !cameras.empty(); }
};

/// The usual `options` of a descriptor.
template <class Options>
std::unique_ptr<PlannerOptions> makePlannerOptions() {
  return std::make_unique<PlannerOptionsOf<Options>>();
}

}  // namespace cdiff::planning
