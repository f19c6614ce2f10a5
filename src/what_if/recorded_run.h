// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "e2e_cdiff/traffic/vehicle.h"
#include "session/session_setup.h"

namespace cdiff::what_if {

/// A contact of the ego as a session's result records it.
struct RecordedContact {
  std::size_t number = 0;  ///< from 1, in the order of time
  std::uint64_t tick = 0;  ///< first tick with overlap
  double seconds = 0.0;    ///< its time [s]
  std::string partner;     ///< id of the other vehicle
  std::string ego_side;    ///< side of the ego that was touched
};

/// The result folder of a session, read back so that the session can run again: resolved scenario,
/// contacts of the ego, trace (map frame, SI units).
class RecordedRun {
 public:
  /// Throws InputError naming the file: no session's result, that of a replay, a session that the
  /// wall clock paced (it cannot be repeated), one that broke, a trace that is not the summary's.
  explicit RecordedRun(const std::filesystem::path& folder);

  const std::filesystem::path& folder() const { return folder_; }
  /// With what was steered, by hand too; without limit of pace, without video.
  const session::ScenarioOptions& scenario() const { return scenario_; }
  const std::vector<RecordedContact>& contacts() const { return contacts_; }
  const std::string& traceSha256() const { return trace_sha256_; }
  /// Last tick that the session drove to.
  std::uint64_t lastTick() const { return last_tick_; }
  /// Rows of a tick as trace.csv holds them; empty for a tick that it does not have.
  std::string_view rowsAt(std::uint64_t tick) const;
  /// The action with which a vehicle was driven from this tick on; nullopt where it was not driven.
  std::optional<traffic::ControlAction> actionAt(std::uint64_t tick, const std::string& id) const;

  /// Throws InputError naming what is not as it was: program, simulator, network, libraries,
  /// instruction sets, weights of the CBVs' planner. The ego's planner is not asked, so that its
  /// weights do not matter.
  void requireUnchanged(const session::SessionSetup& setup,
                        const std::string& simulator_version) const;

 private:
  void readSession();
  void readSummary();
  void readTrace();

  std::filesystem::path folder_;
  std::map<std::string, std::string> facts_;  ///< of session.yaml, by "section.key"
  session::ScenarioOptions scenario_;
  std::vector<RecordedContact> contacts_;
  std::string trace_sha256_;
  std::string trace_;
  bool cut_off_ = false;  ///< the last tick repeats the one before: the session ended from outside
  std::uint64_t last_tick_ = 0;
  std::unordered_map<std::uint64_t, std::pair<std::size_t, std::size_t>> rows_;  ///< begin, end
  std::unordered_map<std::uint64_t, std::unordered_map<std::string, traffic::ControlAction>>
      actions_;  ///< by the tick that they led to
};

}  // namespace cdiff::what_if
