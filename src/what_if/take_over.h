// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/metrics/metric.h"
#include "metrics/formulas/contact_fault.h"
#include "record/logs/driving_log.h"
#include "session/session_observer.h"
#include "what_if/driver.h"

namespace cdiff::what_if {

// One session again with another driver of the ego from a tick on.

/// What is asked of a session that runs again.
struct TakeOver {
  std::uint64_t tick = 0;      ///< decision from which the driver has the ego
  std::uint64_t end_tick = 0;  ///< until then it must have no contact
  std::string partner;         ///< of the recorded contact; empty: none was recorded
};

/// A course of a session: what it came to, and all that pages and files show of it.
struct Course {
  explicit Course(double simulation_step) : timeline(simulation_step) {}

  /// The ego's first contact from the take-over on that speaks against its driver: with the partner
  /// of the recorded contact, or with anyone but a vehicle that runs into its rear.
  std::optional<metrics::EgoContact> contact;
  std::size_t struck_behind = 0;  ///< other vehicles that ran into its rear
  record::Timeline timeline;
  std::string trace;  ///< as trace.csv, up to where the course was followed
};

/// The part of a course that must be as recorded, byte for byte.
struct RecordedPart {
  const RecordedRun& run;
  std::uint64_t last_tick = 0;
};

/// Follows a session tick by tick: holds it against a recording where it must be the same, and
/// looks for contacts of the ego from the take-over on.
class CourseFollower : public session::SessionObserver {
 public:
  /// All references must outlive the object.
  CourseFollower(const session::SessionSetup& setup, const TakeOver& take_over,
                 std::optional<RecordedPart> recorded);

  /// Throws core::Error naming the tick and the first row that is not as recorded, and
  /// SimulatorError where the session breaks.
  void observe(const session::TickRecord& record) override;
  /// Set when there is nothing more to see: a contact, or the last tick.
  const std::atomic<bool>& stop() const { return stop_; }
  /// Snapshots up to the end, by tick.
  std::vector<traffic::TrafficSnapshot>& snapshots() { return snapshots_; }
  Course& course() { return course_; }

 private:
  void requireSame(const traffic::TrafficSnapshot& snapshot, const std::string& rows) const;
  void judge(const traffic::TrafficSnapshot& snapshot);

  TakeOver take_over_;
  std::optional<RecordedPart> recorded_;
  metrics::EgoContacts judged_;
  std::size_t known_ = 0;  ///< contacts that were judged already
  Course course_;
  std::vector<traffic::TrafficSnapshot> snapshots_;
  std::atomic<bool> stop_{false};
};

/// The recorded session again, ego and CBVs by their recorded actions; nothing is inferred.
struct RecordedCourse {
  std::vector<traffic::TrafficSnapshot> snapshots;  ///< by tick
  Course course;
};

/// Throws InputError where something is not as it was, core::Error where the trace differs or the
/// simulator is lost.
RecordedCourse repeatRecorded(const RecordedRun& run, const session::SessionSetup& setup,
                              const TakeOver& take_over);

/// *Closed*: the session again from its seed, in which CBVs and traffic answer to what the driver
/// does. Throws as repeatRecorded does.
Course driveClosed(const RecordedRun& run, const Driver& driver, const session::SessionSetup& setup,
                   const TakeOver& take_over);

/// *Open*: everyone but the ego plays its recorded states; the partner goes on with the speed and
/// heading of the recorded contact. With `shift` the partner is that much later [s] (negative:
/// earlier).
Course driveOpen(const RecordedRun& run, const Driver& driver, const session::SessionSetup& setup,
                 const TakeOver& take_over, const RecordedCourse& recorded, double shift = 0.0);

/// The smallest number of steps before the contact, up to `earliest`, at which a take-over avoids
/// it: of every fifth number the first that does, then of the four below. Who avoids it at one time
/// may fail at an earlier one, so nothing is assumed of the others; a shorter window may be missed.
/// nullopt where none avoids it.
std::optional<int> latestAvoiding(int earliest, const std::function<bool(int)>& avoids);

}  // namespace cdiff::what_if
