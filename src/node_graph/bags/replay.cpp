// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/replay.h"

#include <chrono>
#include <memory>
#include <optional>

#include "core/output_folder.h"
#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/lockstep/tick_record.h"
#include "page/result_writer.h"
#include "record/result_folder.h"
#include "record/session_text.h"
#include "video/session_video.h"

namespace cdiff::node_graph {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kRecordedBy = ", recorded by ";

void showTick(const RecordedSession& session, const ::e2e_cdiff::TrafficSnapshot& message,
              const std::vector<session::SessionObserver*>& observers) {
  const TickRecordView tick(message, session.answers(), session.setup().network());
  for (session::SessionObserver* observer : observers) observer->observe(tick.record());
}

[[noreturn]] void refuseEmpty(const std::filesystem::path& bag, const RecordedSession& session) {
  std::string text = "bag '" + bag.string() +
                     "' holds a session, but nothing to evaluate: no snapshot of it can be used";
  for (const std::string& finding : session.findings()) text += "; " + finding;
  throw core::InputError(text);
}

void removeSettings(const std::filesystem::path& results) {
  try {
    core::OutputFolder(results).remove({"session.yaml"});
  } catch (const core::InputError&) {
    // It stays on the record, and goes with the next session.
  }
}

void endWhereStopped() {
  if (core::stopRequested()) throw core::Interrupted("interrupted; there is no result");
}

/// Ends a replay at a stop signal.
class StopWatch : public session::SessionObserver {
 public:
  void observe(const session::TickRecord& /*record*/) override { endWhereStopped(); }
};

/// Shows every tick to the result and to the video, which goes when the disk is full.
void writeReplay(RecordedSession& session, const ::e2e_cdiff::TrafficSnapshot& first,
                 page::ResultWriter& writer, std::unique_ptr<video::SessionVideo>& video) {
  StopWatch stop_watch;
  std::vector<session::SessionObserver*> observers = {&stop_watch, &writer};
  if (video) observers.push_back(video.get());
  try {
    showTick(session, first, observers);
    showTicks(session, observers);
  } catch (const core::Interrupted&) {
    removeSettings(writer.folder());  // the other files, which are not whole, go by themselves
    throw;
  } catch (const std::exception& error) {
    if (writer.failure().empty()) throw core::Error(error.what());
    video.reset();
  }
}

}  // namespace

std::size_t showTicks(RecordedSession& session,
                      const std::vector<session::SessionObserver*>& observers) {
  std::size_t count = 0;
  for (; const auto message = session.next(); ++count) showTick(session, *message, observers);
  return count;
}

std::string replayDeployment(const std::string& by, const ::e2e_cdiff::SessionInfo& recorded) {
  return by + kRecordedBy + recorded.deployment + " of e2e_cdiff " + recorded.package_version;
}

bool isReplay(const ::e2e_cdiff::SessionInfo& info) {
  return info.deployment.find(kRecordedBy) != std::string::npos;
}

record::RunFacts factsOf(const ::e2e_cdiff::SessionInfo& info, bool deterministic) {
  record::RunFacts facts{info.deployment, info.simulator_version, deterministic};
  const std::size_t at = info.deployment.find(kRecordedBy);
  if (at == std::string::npos) return facts;
  facts.deployment = info.deployment.substr(0, at);
  facts.recorded_by = info.deployment.substr(at + std::string(kRecordedBy).size());
  return facts;
}

void requireReplayFolder(const std::filesystem::path& bag, const std::filesystem::path& results,
                         bool overwrite) {
  std::error_code none;
  const std::filesystem::path recorded = std::filesystem::weakly_canonical(bag, none);
  if (std::filesystem::equivalent(recorded.parent_path(), results, none) ||
      std::filesystem::equivalent(bag, results / "session.bag", none)) {
    throw core::InputError("'" + results.string() +
                           "' holds the bag that is replayed; give another folder");
  }
  record::requireFreeFolder(results, overwrite);
}

ReplayResult replayBag(const std::filesystem::path& bag, const std::filesystem::path& results,
                       bool overwrite) {
  const Clock::time_point begin = Clock::now();
  requireReplayFolder(std::filesystem::absolute(bag), results, overwrite);
  RecordedSession session(bag);
  endWhereStopped();
  const auto first = session.next();
  if (!first) refuseEmpty(bag, session);
  ::e2e_cdiff::SessionInfo info;
  info.deployment = replayDeployment(kReplayCommand, session.info());
  info.simulator_version = session.info().simulator_version;
  const bool deterministic = session.setup().options().real_time_factor == 0.0;
  const record::ResultFolder folder(results, kReplayCommand, overwrite);
  page::ResultWriter writer(session.setup(), factsOf(info, deterministic), results);
  std::unique_ptr<video::SessionVideo> video;
  if (session.setup().options().video)
    video = std::make_unique<video::SessionVideo>(session.setup(), results);
  writeReplay(session, *first, writer, video);
  try {
    writer.finish(std::chrono::duration<double>(Clock::now() - begin).count());
  } catch (const core::InputError& error) {
    throw core::Error(error.what());  // of the disk
  }
  if (video) video->finish(writer.result());
  const std::string video_error = video ? video->error() : "";
  const bool whole = session.findings().empty() && video_error.empty();
  return {whole ? writer.exitCode() : core::ExitCode::kRunTimeError,
          writer.table() + record::fileRow("video", results / video::kVideoFile),
          session.findings(), video_error, writer.failure()};
}

}  // namespace cdiff::node_graph
