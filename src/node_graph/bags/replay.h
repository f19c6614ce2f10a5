// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "e2e_cdiff/SessionInfo.h"
#include "node_graph/bags/recorded_session.h"
#include "record/session_result.h"
#include "session/session_observer.h"

namespace cdiff::node_graph {

/// As results name who replayed a bag.
inline constexpr const char* kReplayCommand = "cdiff replay";
inline constexpr const char* kReplayLaunch = "replay.launch";

/// Shows observers every tick of a recording in order; returns the number of snapshots. Call once.
std::size_t showTicks(RecordedSession& session,
                      const std::vector<session::SessionObserver*>& observers);

/// Deployment of a replayed session, for SessionInfo: who replays it, and who recorded it.
std::string replayDeployment(const std::string& by, const ::e2e_cdiff::SessionInfo& recorded);
/// Whether a session is a replayed one.
bool isReplay(const ::e2e_cdiff::SessionInfo& info);
/// What results say about a session, live or replayed.
record::RunFacts factsOf(const ::e2e_cdiff::SessionInfo& info, bool deterministic);

/// Throws InputError when a replay may not write into the folder: it holds an earlier result that
/// is not to be overwritten, or the bag itself.
void requireReplayFolder(const std::filesystem::path& bag, const std::filesystem::path& results,
                         bool overwrite = false);

/// The result folder of a recorded session, made from its bag alone by the code that makes the live
/// one; no master, no simulator, no network file.
struct ReplayResult {
  int exit_code = 0;  ///< the session's; 2 when the recording is damaged or a video is missing
  std::string table;  ///< what a terminal shows
  std::vector<std::string> findings;  ///< what of the recording is damaged or missing
  std::string video_error;            ///< why the video that the scenario asks for is missing
  std::string failure;                ///< why the result is not whole (disk full); else empty
};

/// Reads the bag and writes the result folder, with a video where the scenario asks for one.
/// `wall_seconds` of the result is what this took. Throws InputError when the bag holds nothing to
/// evaluate, or the folder cannot be made, is in use or refused (requireReplayFolder; nothing is
/// written then), core::Error when the result cannot be written to its end, core::Interrupted when
/// a stop was requested before the last tick (core::stopRequested; nothing is kept then).
ReplayResult replayBag(const std::filesystem::path& bag, const std::filesystem::path& results,
                       bool overwrite = false);

}  // namespace cdiff::node_graph
