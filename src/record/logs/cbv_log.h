// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <map>
#include <memory_resource>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "e2e_cdiff/cbv/cbv_selection.h"
#include "e2e_cdiff/geometry/shapes.h"
#include "e2e_cdiff/traffic/traffic_snapshot.h"
#include "record/logs/driving_log.h"
#include "rendering/front_camera.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::record {

// Camera images inside a page that needs nothing from outside: "data:image/png;base64,..." without
// loss, JPEG where there are many.

/// Whether the image has pixels, as many bytes as its size says.
bool isWhole(const traffic::CameraImage& image);

/// A PNG as a data URI. Throws InputError when the image is incomplete.
std::string pngDataUri(const traffic::CameraImage& image);

/// JPEG (JFIF), 4:2:0. Throws InputError when the image is incomplete.
std::vector<std::uint8_t> jpegOf(const traffic::CameraImage& image);

/// RFC 4648, padded, one line.
std::string base64(const std::vector<std::uint8_t>& bytes);

/// All views of a session take at most this much [bytes]; as text a third more.
inline constexpr std::size_t kFrontViewBytes = 2'400'000;

/// The front view of a slot's vehicle at one tick, as JPEG.
struct FrontView {
  std::uint64_t tick = 0;
  double time = 0.0;  ///< [s]
  int slot = 0;
  std::string vehicle_id;
  std::vector<std::uint8_t> jpeg;
  bool contact = false;  ///< whether the vehicle touches another at this tick
};

/// The camera of the planners with `width` x `height` pixels, vehicles painted by role.
rendering::FrontCamera cameraForPeople(const session::SessionSetup& setup, std::int64_t width,
                                       std::int64_t height);
/// The ego's cameras with `width` x `height` pixels each, likewise.
rendering::RigRenderer rigForPeople(const session::SessionSetup& setup, std::int64_t width,
                                    std::int64_t height);

/// The front view of each CBV through the session, drawn for people: 320 x 192 pixels, JPEG, evenly
/// spaced in time, as many as a fixed number of bytes holds; and at the first kMostContactViews
/// contacts of CBVs.
class FrontViewLog {
 public:
  /// `setup` must outlive the log. Its report.front_view_rate 0 keeps the log empty.
  explicit FrontViewLog(const session::SessionSetup& setup);
  /// Every tick in order. Vehicles whose state is not finite are passed over.
  void observe(const traffic::TrafficSnapshot& snapshot);

  static constexpr std::size_t kMostContactViews = 40;

  /// By time, then slot.
  const std::vector<FrontView>& views() const { return views_; }
  /// As cameraForPeople; it shares the shapes of the log's own camera: one thread may use both.
  rendering::FrontCamera camera(std::int64_t width, std::int64_t height) const;
  /// Between views: as asked for, or a power of two of it where they would not fit [s].
  double period() const;

 private:
  void add(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& vehicle, bool contact);
  void thinOut();

  const session::SessionSetup& setup_;
  std::size_t contact_views_ = 0;
  std::uint64_t ticks_per_view_ = 0;              ///< 0: none are wanted
  std::optional<rendering::FrontCamera> camera_;  ///< made when the first CBV is driven
  std::vector<FrontView> views_;
  std::size_t bytes_ = 0;
};

/// Reason of a CBV that was still driven when the session ended.
inline constexpr const char* kSessionEnd = "session_end";

/// One stay of a vehicle in a slot.
struct CbvRecord {
  int slot = 0;
  std::string vehicle_id;
  std::uint64_t selected_tick = 0;
  double interaction_score = 0.0;
  cbv::ConflictPoint conflict_point;  ///< as of the selection
  std::size_t decisions_driven =
      0;  ///< decisions that found it driven as CBV: not yet that of its selection
  std::optional<std::uint64_t> released_tick;  ///< absent when the session ended first
  std::string release_reason = kSessionEnd;
  double route_length = 0.0;                ///< length of the conflict-aware route [m]
  std::pmr::vector<Eigen::Vector3d> route;  ///< points of the conflict-aware route, map frame [m]
  /// Reached on the conflict-aware route, as of the decisions of the stay and that of its release
  /// [m].
  double arc_length = 0.0;
  bool conflict_point_passed = false;  ///< its center came that far along the conflict-aware route

  /// 100 arc_length / route_length; 100 when released because its route ended.
  double routeCompletionPercent() const;
  /// Released because its route ended, at least 95 % of the route driven, or the conflict point
  /// passed.
  bool routeCompleted() const;
};

/// What happened to every vehicle that was selected as CBV: where and when, for how many decisions,
/// how far along its conflict-aware route, why released; and how often which reason rejected a
/// candidate.
class CbvLog {
 public:
  /// How often each vehicle was rejected: by reason, then by id.
  using RejectedVehicles = std::pmr::map<std::string, std::pmr::map<std::string, std::size_t>>;

  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit CbvLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : rejected_vehicles_(memory) {}
  /// One decision in order.
  void observe(const traffic::TrafficSnapshot& snapshot, const cbv::CbvSelection& selection);
  /// In order of selection.
  const std::vector<CbvRecord>& records() const { return records_; }
  /// Candidates rejected, over all decisions, by reason.
  const std::map<std::string, std::size_t>& rejected() const { return rejected_; }
  /// The same for each vehicle.
  const RejectedVehicles& rejectedVehicles() const { return rejected_vehicles_; }

 private:
  struct Stay {
    std::size_t record = 0;  ///< index
    geometry::Polyline path;
    double conflict_arc_length = 0.0;  ///< [m]
  };
  CbvRecord& recordOf(const cbv::CbvAssignment& assignment);
  void follow(const traffic::TrafficSnapshot& snapshot);
  void close(const cbv::CbvSelection& selection);

  std::vector<CbvRecord> records_;
  std::map<int, Stay> open_;  ///< slot -> its present stay
  std::map<std::string, std::size_t> rejected_;
  RejectedVehicles rejected_vehicles_;
};

/// The moment at which a CBV came nearest to the ego: the snapshot, and the images of both. Of
/// those that are not among the nearest of the session, a frame alone.
struct Approach {
  std::string vehicle_id;
  double gap = 0.0;                   ///< between the boxes of ego and CBV [m]
  double center_distance = 0.0;       ///< between their centers [m]
  traffic::TrafficSnapshot snapshot;  ///< without vehicles where a frame is kept alone
  LoneFrame frame;                    ///< what is kept then; empty beside a whole snapshot
  traffic::CameraImage
      cbv_image;  ///< image of the latest decision; empty when its planner does not see
  traffic::CameraImage ego_image;  ///< likewise of the ego
  /// The images of all cameras of the latest decision; empty for rigs of one camera.
  std::vector<session::SlotImage> cbv_views;
  std::vector<session::SlotImage> ego_views;

  bool isWhole() const { return !snapshot.vehicles.empty(); }
  double time() const { return isWhole() ? snapshot.time : frame.frame.time; }
  /// The frame of its tick.
  LoneFrame event() const { return isWhole() ? loneFrame(snapshot) : frame; }
};

/// The closest approach of each CBV to the ego while it was driven: the tick with the smallest gap
/// between their boxes (the first of equals), its whole snapshot, and what planners saw then. The
/// kMostWhole nearest are kept whole.
class ApproachLog {
 public:
  static constexpr std::size_t kMostWhole = 4;

  /// What grows with the session lies in `memory`, which must outlive the log.
  explicit ApproachLog(std::pmr::memory_resource* memory = std::pmr::get_default_resource())
      : approaches_(memory) {}
  /// Every tick in order.
  void observe(const session::TickRecord& record);
  /// In the order in which the vehicles were first driven as CBVs on the ego's level.
  const std::pmr::vector<Approach>& approaches() const { return approaches_; }
  /// Those that are kept whole: by gap, the first of equals first.
  std::vector<const Approach*> nearest() const;
  /// The approach of a vehicle, or nullptr.
  const Approach* find(const std::string& vehicle_id) const;
  /// The images of all cameras of a slot's vehicle at the latest decision; empty for rigs of one.
  std::vector<session::SlotImage> latestViews(int slot) const;

 private:
  void compare(const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle& ego,
               const traffic::Vehicle& cbv);
  bool keepsWhole(std::size_t index);
  void keepWhole(const traffic::TrafficSnapshot& snapshot, int slot, Approach& approach);
  traffic::CameraImage imageOf(int slot) const;

  std::vector<session::SlotImage> images_;  ///< of the latest decision
  std::pmr::vector<Approach> approaches_;
  std::vector<std::size_t> whole_;  ///< indices of those that are kept whole
  std::unordered_map<std::string, std::size_t> index_by_id_;
};

}  // namespace cdiff::record
