// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <deque>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/TrafficSnapshot.h"
#include "node_graph/bags/bag_reader.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/topics.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// Source of faults that a damaged bag causes.
inline constexpr const char* kBagSource = "bag";

/// Which images of a recording are read.
enum class RecordedImages {
  kSeen,  ///< those that planners saw; a decision waits for them as in the session
  kAll    ///< all that were recorded; missing ones are not reported
};

/// A session read from its bag tick by tick, as the nodes saw it: the set-up from SessionInfo, then
/// each snapshot with the answers to it. Read by the replay (`cdiff replay`, replay_node) and by
/// whatever turns bags into samples or courses. Parts that are missing or damaged are reported
/// among the faults of the next snapshot, and reading continues with what is left.
class RecordedSession {
 public:
  using Snapshot = ::e2e_cdiff::TrafficSnapshot::ConstPtr;

  /// Throws InputError naming the file when it is not a bag, or holds no session that can be read.
  explicit RecordedSession(const std::filesystem::path& bag,
                           RecordedImages images = RecordedImages::kSeen);
  ~RecordedSession();

  const ::e2e_cdiff::SessionInfo& info() const { return *info_; }
  const session::SessionSetup& setup() const { return *setup_; }
  /// Hands the set-up over to the caller; call nothing else afterward.
  std::unique_ptr<session::SessionSetup> takeSetup() { return std::move(setup_); }
  /// The nodes that took part; for a session that one process drove, those of the same session as a
  /// node graph.
  const SessionGraph& graph() const { return graph_; }

  /// The next snapshot, among whose faults is what was found damaged since the one before. The last
  /// one has a final status, `interrupted` where the recording was cut off. nullptr after the last,
  /// and at once when the bag holds no usable snapshot.
  Snapshot next();
  /// Answers to the snapshot that `next` gave; older ones are forgotten.
  const TickAnswers& answers() const { return answers_; }
  /// What was found damaged or missing so far, one sentence each; empty for an intact recording.
  const std::vector<std::string>& findings() const { return findings_; }

 private:
  struct Topics;
  void readInfo();
  void requireReadableTicks() const;
  bool readMessage();
  void take(const BagMessage& message);
  void dispatch(const Topic& topic, const BagMessage& message);
  void takeSnapshot(const BagMessage& message);
  void takeSelection(const BagMessage& message);
  void takeSession(const BagMessage& message);
  bool frontIsReady() const;
  Snapshot handOut(const Snapshot& snapshot);
  Snapshot cutOff(const Snapshot& snapshot);
  void checkOrder(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void checkAnswers(const ::e2e_cdiff::TrafficSnapshot& snapshot);
  void find(const std::string& text);
  void copyDamage();

  BagReader reader_;
  RecordedImages images_;
  std::unique_ptr<Topics> topics_;
  std::string prefix_;
  ::e2e_cdiff::SessionInfo::ConstPtr info_;
  std::unique_ptr<session::SessionSetup> setup_;
  SessionGraph graph_;
  TickAnswers answers_;
  std::deque<Snapshot> snapshots_;
  Snapshot last_;                        ///< handed out
  std::optional<std::uint64_t> newest_;  ///< largest tick read
  std::size_t newest_hash_ = 0;          ///< hash of that snapshot's bytes
  std::string unanswered_;               ///< what the last decision lacked
  bool session_over_ = false;            ///< a second session starts in the bag
  std::size_t damage_copied_ = 0;        ///< entries of reader_.damage() copied to findings_
  std::size_t handed_out_ = 0;           ///< findings_ that a snapshot has already carried
  std::vector<std::string> findings_;
};

}  // namespace cdiff::node_graph
