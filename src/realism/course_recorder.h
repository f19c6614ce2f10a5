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
#include "metrics/measures/driving_score.h"
#include "realism/continuation.h"
#include "realism/recording.h"
#include "session/session_observer.h"

namespace cdiff::realism {

/// Another selector up to its first hand-over; from there on only the vehicles of that hand-over
/// stay selected, as long as the other selector keeps them.
class HandOverSelector : public cbv::VehicleSelector {
 public:
  /// `hands_over` false: the first hand-over is noted, but not made.
  HandOverSelector(std::unique_ptr<cbv::VehicleSelector> inner, bool hands_over);

  void observe(const traffic::TrafficSnapshot& snapshot) override { inner_->observe(snapshot); }
  cbv::CbvSelection update(const traffic::TrafficSnapshot& snapshot) override;
  /// Assignments of the first hand-over; empty before.
  const std::vector<cbv::CbvAssignment>& first() const { return first_; }

 private:
  bool isFirst(const std::string& vehicle_id) const;

  std::unique_ptr<cbv::VehicleSelector> inner_;
  bool hands_over_;
  std::vector<cbv::CbvAssignment> first_;
};

/// Adds the vehicles of a snapshot to a recording as its next step. A vehicle that was not in the
/// step before starts a track; so does one whose role changed where `by_role`.
class RecordingBuilder {
 public:
  explicit RecordingBuilder(bool by_role) : by_role_(by_role) {}
  void add(const traffic::TrafficSnapshot& snapshot);
  /// Notes which vehicles of a snapshot, that of the latest step or of a tick after it, overlap.
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

/// Keeps all decisions of a session or its bag as a recording with roles, and the contacts of every
/// tick.
class SessionRecorder : public session::SessionObserver {
 public:
  void observe(const session::TickRecord& record) override;
  Recording take() { return builder_.take(); }

 private:
  RecordingBuilder builder_{true};
};

/// Follows a session to its first hand-over and for some steps on, then stops it.
class CourseRecorder : public session::SessionObserver {
 public:
  /// `stop` is set when the last step was seen. All references must outlive the recorder.
  CourseRecorder(const session::SessionSetup& setup, const HandOverSelector& selector,
                 std::size_t steps, bool sumo_drives, std::atomic<bool>& stop);

  void observe(const session::TickRecord& record) override;
  /// Empty without a hand-over. Call once.
  std::optional<Continuation> take();
  /// Texts of the faults that ended the session; empty where none did.
  const std::string& error() const { return error_; }

 private:
  /// What is noted of one object at every tick.
  struct Object {
    std::string id;
    metrics::StopLines lines;
    bool gone = false;
    double collided = 0.0;  ///< since the last step
    double off_road = 0.0;
    double red_light = 0.0;
    std::size_t red_lights = 0;  ///< so far
    Course course = {};          ///< indicators and features of the map, step by step
  };

  void handOver(const traffic::TrafficSnapshot& snapshot);
  void hash(const traffic::TrafficSnapshot& snapshot);
  void note(const traffic::TrafficSnapshot& snapshot, Object& object) const;
  static void closeStep(double edge, Object& object);
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
