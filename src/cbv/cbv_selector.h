// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "cbv/cbv_options.h"
#include "cbv/conflict_search.h"
#include "cbv/hand_over.h"
#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "map/lane_graph.h"

namespace cdiff::cbv {

// Reasons of release, besides kOutranked (life cycle "reselect": a better candidate took the slot).

/// It touched another vehicle.
inline constexpr const char* kContact = "contact";
/// It reached the end of its conflict-aware route.
inline constexpr const char* kRouteEnd = "route_end";
/// It is not in the snapshot any more.
inline constexpr const char* kGone = "gone";
/// Life cycle "reselect": no conflict for lost_conflict_time.
inline constexpr const char* kConflictLost = "conflict_lost";
/// Who steers the session released it, took it away, or chose another one for its slot.
inline constexpr const char* kSteered = "steered";

/// Arc length [m] reached on a path by a vehicle that was at `arc_length`: looks as far ahead as
/// map::kRouteWindow, and along the whole rest of the path when the vehicle is more than `far_off`
/// meters from what lies there (it was not followed continuously). Never less than `arc_length`.
double advancedArcLength(const geometry::Polyline& path, double arc_length,
                         const Eigen::Vector2d& position, double far_off = 30.0);

/// Whether a contact of this tick involves the vehicle.
bool inContact(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id);

/// A CBV in its slot: how far it has come along its conflict-aware route, and when it must leave
/// the slot.
class HeldCbv {
 public:
  /// `assignment` as selected; `conflict_arc_length` of the conflict point on its conflict-aware
  /// route [m].
  HeldCbv(CbvAssignment assignment, double conflict_arc_length);

  const CbvAssignment& assignment() const { return assignment_; }
  const std::string& vehicleId() const { return assignment_.vehicle_id; }

  /// Moves along the route; distances and times of the conflict point as of this snapshot, 0 once
  /// passed.
  void update(const traffic::Vehicle& vehicle, const EgoProgress& ego, double minimum_speed);
  /// Where it goes.
  Motion motion(const traffic::Vehicle& vehicle) const {
    return {vehicle, &assignment_.conflict_aware_route.path(), arc_length_};
  }
  /// Reason to release in every life cycle, or nullptr.
  const char* releaseReason(const traffic::TrafficSnapshot& snapshot) const;

  /// Present score, for the life cycle "reselect"; nullopt = no conflict at `time` [s].
  void setPresentScore(std::optional<double> score, double time);
  double presentScore() const { return present_score_; }
  /// Time without a conflict up to `time` [s].
  double lostTime(double time) const { return lost_since_ ? time - *lost_since_ : 0.0; }

 private:
  double remaining() const { return assignment_.conflict_aware_route.length() - arc_length_; }

  CbvAssignment assignment_;
  double conflict_arc_length_;
  double selected_distance_;  ///< along lanes, from where it was selected to the conflict point [m]
  double arc_length_ = 0.0;
  double present_score_;
  std::optional<double> lost_since_;
};

/// Who is driven besides the ego, and along which route: CBV identification in a session, anybody
/// near the ego where data are collected.
/// One per session; called once per tick in order: `update` at decision ticks, `observe` at all
/// others.
class VehicleSelector {
 public:
  virtual ~VehicleSelector() = default;
  /// A tick without decision.
  virtual void observe(const traffic::TrafficSnapshot& snapshot) = 0;
  /// The selection of this decision.
  virtual CbvSelection update(const traffic::TrafficSnapshot& snapshot) = 0;
};

/// CBV identification (paper III-B): for every vehicle the best conflict point with the ego's
/// remaining route by equal distance, equal arrival time and nearness; the best candidates fill the
/// slots and keep them (RIFT's life cycle by default). A vehicle that steering chooses
/// (traffic::steered::kChoose) comes before them where it passes the gates; it is rejected with the
/// reason where it does not.
/// Not copyable; one per session; called once per tick in order: `update` at decision ticks,
/// `observe` at all others.
class CbvSelector : public VehicleSelector {
 public:
  /// Keeps references: the graph's network and the route must outlive the selector. Throws
  /// InputError for bad options or a negative count. `mode` is that of the session's begin; the
  /// life cycle "by_mode" is that of the mode, also of one that steering sets.
  CbvSelector(const CbvOptions& options, int max_cbv, const map::LaneGraph& graph,
              const map::Route& ego_route, const std::string& mode = "naturalistic");
  CbvSelector(const CbvSelector&) = delete;
  CbvSelector& operator=(const CbvSelector&) = delete;

  /// A tick without decision: remembers contacts, so that a release names its reason.
  void observe(const traffic::TrafficSnapshot& snapshot) override;
  /// A pure function of the snapshots seen so far, with the steering in them.
  CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;

 private:
  /// A vehicle with a conflict that may get a slot.
  struct Candidate {
    const traffic::Vehicle* vehicle = nullptr;
    map::LanePosition place;
    Conflict conflict;
    double separation = 0.0;  ///< from the ego, center to center [m]
  };

  bool reselects() const { return options_.life_cycle == "reselect"; }
  void followMode(const traffic::TrafficSnapshot& snapshot);
  void followEgo(const traffic::Vehicle& ego);
  bool selectionDue(double time);
  bool queued(const traffic::Vehicle& vehicle, const map::LanePosition& place) const;
  bool hasContactAhead(const traffic::TrafficSnapshot& snapshot, const Candidate& candidate,
                       const HeldCbv& chosen) const;
  bool holds(const std::string& vehicle_id) const;
  void updateHeld(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection);
  void releaseSteered(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection);
  void chooseSteered(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection);
  void choose(const traffic::TrafficSnapshot& snapshot, const std::string& vehicle_id,
              CbvSelection& selection);
  const char* whyNot(const traffic::TrafficSnapshot& snapshot, const Candidate& candidate,
                     std::optional<HeldCbv>& chosen, int slot) const;
  int weakestSlot(std::uint64_t tick) const;
  bool mayBeTaken(const std::string& vehicle_id) const;
  void releaseLost(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection);
  void release(int slot, const char* reason, CbvSelection& selection);
  void select(const traffic::TrafficSnapshot& snapshot, CbvSelection& selection);
  std::vector<Candidate> rankedCandidates(const traffic::TrafficSnapshot& snapshot,
                                          CbvSelection& selection) const;
  double rankingKey(const Candidate& candidate) const;
  const char* examine(const traffic::TrafficSnapshot& snapshot, Candidate& candidate) const;
  int slotFor(const Candidate& candidate, std::uint64_t tick) const;
  std::optional<HeldCbv> makeHeld(int slot, const Candidate& candidate, std::uint64_t tick) const;

  std::string life_cycle_;  ///< as given; "by_mode" follows the mode
  CbvOptions options_;      ///< with the life cycle of the mode
  int max_cbv_;
  map::LaneGraph graph_;  ///< turns round only where the ego's route does
  const map::Route& ego_route_;
  ConflictSearch search_;
  std::map<int, HeldCbv> slots_;
  std::set<std::string> never_again_;
  std::set<std::string> contacted_;  ///< between decisions
  std::set<std::string> refused_;    ///< chosen by steering at this decision, and rejected
  EgoProgress ego_;
  bool seen_ego_ = false;
  double last_selection_ = -1.0;  ///< index of the last selection period
};

}  // namespace cdiff::cbv
