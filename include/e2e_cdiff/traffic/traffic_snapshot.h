// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "e2e_cdiff/traffic/steering_change.h"
#include "e2e_cdiff/traffic/vehicle.h"

namespace cdiff::traffic {

/// Colors of one traffic light, one letter per link as SUMO writes them (r y g G ...).
struct SignalState {
  std::string id;     ///< of the traffic light
  std::string state;  ///< its letters
};

/// Two boxes that began to overlap at this tick (ids in ascending order). A pair counts again only
/// 5 s after its last overlap.
struct Contact {
  std::string first;   ///< id of one vehicle
  std::string second;  ///< id of the other
};

/// Source of a fault that the user's input is to blame for: a session that ends with it is bad
/// input, no error at run time.
inline constexpr const char* kInputFault = "input";

/// Something that went wrong and was survived or ended the session.
struct Fault {
  std::uint64_t tick = 0;  ///< when it was noticed
  std::string source;      ///< node, planner, simulator or kInputFault
  std::string text;        ///< what happened, with the offending value
};

/// How a session stands. All but kRunning are final.
enum class SessionStatus {
  kRunning,
  kCompleted,
  kBlocked,
  kDeviated,
  kTimedOut,
  kCollided,
  kInterrupted,
  kError
};

/// "running", "completed", "blocked", "deviated", "timed_out", "collided", "interrupted" or
/// "error".
const char* toText(SessionStatus status);

/// Everything that is true of the world at one tick; the one input of CBV identification, planners,
/// metrics and records.
struct TrafficSnapshot {
  std::uint64_t tick = 0;            ///< counted from 0
  double time = 0.0;                 ///< tick x simulation step [s]
  bool decision_tick = false;        ///< whether planners are asked at this tick
  std::vector<Vehicle> vehicles;     ///< ego first, then CBVs by slot, then background by id
  std::vector<SignalState> signals;  ///< by id
  std::vector<Contact> contacts;     ///< that began at this tick
  std::vector<std::string>
      removed;  ///< ids that left the simulation since the last tick (contact or end of route)
  SessionStatus status = SessionStatus::kRunning;  ///< of the session, after this tick's events
  std::vector<Fault> faults;                       ///< recorded at this tick
  std::vector<SteeringChange> steering;            ///< in force from this tick on, in order

  /// The vehicle with this id, or nullptr.
  const Vehicle* find(const std::string& id) const;
  /// The ego, or nullptr.
  const Vehicle* ego() const;
  /// The CBV of a slot, or nullptr.
  const Vehicle* cbv(int slot) const;
};

/// What a camera saw: rgb8, row-major from the top left, `height` x `width` x 3 bytes.
struct CameraImage {
  int width = 0;                  ///< [px]
  int height = 0;                 ///< [px]
  std::uint64_t tick = 0;         ///< tick of the snapshot that it shows
  std::vector<std::uint8_t> rgb;  ///< height x width x 3

  /// Whether it holds no pixel.
  bool empty() const { return rgb.empty(); }
};

}  // namespace cdiff::traffic
