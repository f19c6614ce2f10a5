// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The result folder of a recorded session, made from its bag alone by the code that makes the live
/// one; no master, no simulator, no network file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/report/session_result.h"
#include "e2e_cdiff/ros/recorded_session.h"
#include "e2e_cdiff/scenario/session_observer.h"

namespace cdiff::ros {

/// As results name who replayed a bag.
inline constexpr const char* kReplayCommand = "cdiff replay";
inline constexpr const char* kReplayLaunch = "replay.launch";

/// Shows observers every tick of a recording in order; answers the number of snapshots. Call once.
std::size_t showTicks(RecordedSession& session,
                      const std::vector<scenario::SessionObserver*>& observers);

/// Deployment of a session that is told again, for SessionInfo: who tells it, and who recorded it.
std::string replayDeployment(const std::string& by, const ::e2e_cdiff::SessionInfo& recorded);
/// What results say of a session, live or told again.
report::RunFacts factsOf(const ::e2e_cdiff::SessionInfo& info, bool deterministic);

/// Whether the folder holds the result of a session that was driven, not told again.
bool holdsRecording(const std::filesystem::path& results);
/// Throws InputError for such a folder: a replay would take the place of what was recorded.
void requireNoRecording(const std::filesystem::path& results);

struct ReplayResult {
  int exit_code = 0;  ///< the session's; 2 when the recording is damaged or a video is missing
  std::string table;  ///< what a terminal shows
  std::vector<std::string> findings;  ///< what of the recording is damaged or missing
  std::string video_error;            ///< why the video that the scenario asks for is missing
};

/// Reads the bag and writes the result folder, with a video where the scenario asks for one.
/// `wall_seconds` of the result is what this took. Throws InputError when the bag holds nothing to
/// evaluate, or the folder cannot be made or holds a recording (nothing is written then),
/// core::Error when the result cannot be written to its end.
ReplayResult replayBag(const std::filesystem::path& bag, const std::filesystem::path& results);

}  // namespace cdiff::ros
