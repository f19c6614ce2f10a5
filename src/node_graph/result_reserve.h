// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/output_folder.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/bags/recorded_session.h"
#include "node_graph/bags/session_bag_writer.h"
#include "node_graph/lockstep/tick_answers.h"
#include "record/session_result.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// What the traffic simulator keeps aside while the metrics node writes the session's result: the
/// messages of each tick, as a bag in RESULTS/.reserve. Where that node cannot finish, the bag is
/// replayed into the result. Nothing is measured before that.
class ResultReserve {
 public:
  /// `setup` must outlive the object; `info` names the result folder. Throws InputError where the
  /// folder holds a .reserve that this program did not make.
  ResultReserve(const session::SessionSetup& setup, const ::e2e_cdiff::SessionInfo& info);
  /// Takes RESULTS/.reserve away.
  ~ResultReserve();
  ResultReserve(const ResultReserve&) = delete;
  ResultReserve& operator=(const ResultReserve&) = delete;

  /// Keeps a tick with the answers to it. From a full disk on the ticks are given up, and their
  /// room is free for the result.
  void keep(const ::e2e_cdiff::TrafficSnapshot::ConstPtr& snapshot, const TickAnswers& answers);
  /// Writes the result of what was kept, as far as it can be read, and of the session's end, prints
  /// its table and writes the exit code; nothing where the metrics node has written its own
  /// meanwhile (file exit_code). Returns whether it wrote. Throws InputError when not even a
  /// summary can be written.
  bool adopt(const ::e2e_cdiff::TrafficSnapshot::ConstPtr& end, double wall_seconds);
  /// Leaves what was kept, with the session's end, to writeReservedResult() of another process.
  void handOver(const ::e2e_cdiff::TrafficSnapshot::ConstPtr& end);

 private:
  void giveUp(const std::string& why);
  int replay(RecordedSession& session, double wall_seconds);
  int writeEnd(const ::e2e_cdiff::TrafficSnapshot& end, double wall_seconds);

  const session::SessionSetup& setup_;
  record::RunFacts facts_;
  core::OutputFolder results_;
  std::unique_ptr<BagFile> bag_;  ///< null once it was given up
  std::string lost_;              ///< why it was
};

/// Takes away RESULTS/.reserve of a simulator that died, once its result is written.
void removeReserveOf(const std::filesystem::path& results);

/// What a session in one process keeps aside of its ticks, in RESULTS/.reserve, where that process
/// may crash: another one writes the result then (writeAbandonedResult).
class ProcessReserve : public session::SessionObserver {
 public:
  /// `setup` must outlive the object. Throws InputError where the folder holds a .reserve that this
  /// program did not make, or where nothing can be written.
  ProcessReserve(const session::SessionSetup& setup, const std::filesystem::path& results,
                 const BagOrigin& origin);
  /// Takes RESULTS/.reserve away.
  ~ProcessReserve() override;
  /// From a full disk on the ticks are given up.
  void observe(const session::TickRecord& record) override;

 private:
  core::OutputFolder results_;
  std::unique_ptr<SessionBagWriter> bag_;  ///< null once it was given up
};

/// The end of a session whose process ended before it wrote the result.
struct AbandonedSession {
  traffic::SessionStatus status = traffic::SessionStatus::kError;
  std::string source;  ///< whose fault it is
  std::string text;    ///< of that fault
  double wall_seconds = 0.0;
};

/// Writes the result of such a session into its folder: the ticks of the reserve as far as they can
/// be read, none where there is none, and its end. The reserve goes. Returns the table that a
/// terminal shows. Throws InputError when not even a summary can be written.
std::string writeAbandonedResult(const session::SessionSetup& setup,
                                 const std::filesystem::path& results,
                                 const AbandonedSession& session);

/// Writes the result of a session whose simulator died with its process, from what that kept in
/// RESULTS/.reserve, prints its table and returns its exit code. A session that was running then
/// gets this end. Returns nullopt, and leaves everything as it is, where no tick was kept. Throws
/// InputError when not even a summary can be written.
std::optional<int> writeReservedResult(const std::filesystem::path& results,
                                       traffic::SessionStatus status, const traffic::Fault& fault);

}  // namespace cdiff::node_graph
