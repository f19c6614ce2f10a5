// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cbv/cbv_selector.h"
#include "core/file.h"
#include "metrics/formulas/driving_score.h"
#include "realism/continuation.h"
#include "realism/recording.h"
#include "session/session_observer.h"

namespace cdiff::realism {

// Recordings from sessions, tick by tick.

/// Wraps another selector: returns its selections up to the first hand-over; from then on only the
/// vehicles of that hand-over stay selected, for as long as the other selector keeps them. Used by
/// continueSession.
class HandOverSelector : public cbv::VehicleSelector {
 public:
  /// `hands_over` false: the first hand-over is remembered in first(), but not made.
  HandOverSelector(std::unique_ptr<cbv::VehicleSelector> inner, bool hands_over);

  void observe(const traffic::TrafficSnapshot& snapshot) override { inner_->observe(snapshot); }
  cbv::CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;
  /// Assignments of the first hand-over; empty before it.
  const std::vector<cbv::CbvAssignment>& first() const { return first_; }

 private:
  bool isFirst(const std::string& vehicle_id) const;

  std::unique_ptr<cbv::VehicleSelector> inner_;
  bool hands_over_;
  std::vector<cbv::CbvAssignment> first_;
};

/// Builds a recording, one step per snapshot (map frame, SI units). A vehicle that was not in the
/// previous step starts a new track; with `by_role`, so does one whose role has changed.
class RecordingBuilder {
 public:
  explicit RecordingBuilder(bool by_role) : by_role_(by_role) {}
  void add(const traffic::TrafficSnapshot& snapshot);
  /// Records which vehicles overlap in a snapshot, that of the latest step or of a tick after it.
  void noteContacts(const traffic::TrafficSnapshot& snapshot);
  std::size_t steps() const { return steps_; }
  Recording take() { return std::move(recording_); }

 private:
  Track& trackOf(const traffic::Vehicle& vehicle);

  bool by_role_;
  std::size_t steps_ = 0;
  Recording recording_;
  std::map<std::string, std::size_t> latest_;  ///< track of each vehicle
};

/// Records all decisions of a session, live or from its bag, with the vehicles' roles, and the
/// contacts of every tick.
class SessionRecorder : public session::SessionObserver {
 public:
  void observe(const session::TickRecord& record) override;
  Recording take() { return builder_.take(); }

 private:
  RecordingBuilder builder_{true};
};

/// Records the course of the vehicles of a session's first hand-over for some steps of 0.1 s
/// (features as in Continuation), then stops the session. Used by continueSession.
class CourseRecorder : public session::SessionObserver {
 public:
  /// Sets `stop` after `steps` steps. `sumo_drives`: the vehicles stay with SUMO, so they are
  /// followed whatever their role. All references must outlive the recorder.
  CourseRecorder(const session::SessionSetup& setup, const HandOverSelector& selector,
                 std::size_t steps, bool sumo_drives, std::atomic<bool>& stop);

  void observe(const session::TickRecord& record) override;
  /// Empty without a hand-over. Call once.
  std::optional<Continuation> take();
  /// Texts of the faults that ended the session; empty where none did.
  const std::string& error() const { return error_; }

 private:
  /// What is recorded of one vehicle of the hand-over at every tick. An indicator is 1 if it was
  /// true at any tick since the last step, else 0.
  struct Object {
    std::string id;
    metrics::StopLines lines;
    bool gone = false;
    double collided = 0.0;       ///< indicator
    double off_road = 0.0;       ///< indicator
    double red_light = 0.0;      ///< indicator
    std::size_t red_lights = 0;  ///< run so far
    Course course = {};          ///< indicators and features of the map, step by step
  };

  void handOver(const traffic::TrafficSnapshot& snapshot);
  void hash(const traffic::TrafficSnapshot& snapshot);
  void note(const traffic::TrafficSnapshot& snapshot, Object& object) const;
  /// Appends the indicators and `edge`, the signed distance to the road's edge [m], to its course.
  static void closeStep(double edge, Object& object);
  /// Largest signed distance of a corner to the drivable area's border, positive outside [m].
  double edgeDistance(const traffic::Vehicle& vehicle) const;
  const traffic::Vehicle* find(const traffic::TrafficSnapshot& snapshot,
                               const Object& object) const;

  const session::SessionSetup& setup_;
  const HandOverSelector& selector_;
  std::size_t steps_;
  bool sumo_drives_;
  std::atomic<bool>& stop_;
  core::Sha256 hash_;
  std::deque<traffic::TrafficSnapshot> before_;  ///< the last decisions before the hand-over
  RecordingBuilder builder_{false};
  std::size_t first_step_ = 0;  ///< of the recording, after the hand-over
  std::optional<Continuation> found_;
  std::vector<Object> objects_;
  std::string error_;
};

}  // namespace cdiff::realism
