// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/output_folder.h"
#include "e2e_cdiff/SessionInfo.h"
#include "e2e_cdiff/rendering/camera_options.h"
#include "nav_msgs/Path.h"
#include "node_graph/lockstep/tick_answers.h"
#include "node_graph/messages/display.h"
#include "rosbag/bag.h"
#include "session/scenario_options.h"
#include "session/session_observer.h"
#include "session/session_setup.h"

namespace cdiff::node_graph {

/// The file session.bag, whoever writes it: the topics of a session in a fixed order, tick by tick,
/// with simulated stamps. While it is written, the file is called FILE.active.
class BagFile {
 public:
  /// Name in the bag of a topic whose name is relative.
  using Naming = std::function<std::string(const std::string& topic)>;

  enum class Content {
    kWhole,       ///< compressed, with what tools need besides the session
    kSessionOnly  ///< as fast as it goes: what a replay reads
  };

  /// Makes the file's folder. Throws InputError naming the file when it cannot be written, or when
  /// this program did not make the one that is there.
  BagFile(const std::filesystem::path& file, const session::ScenarioOptions& options, Naming naming,
          Content content = Content::kWhole);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  void write(const ::e2e_cdiff::SessionInfo& info);
  void write(const nav_msgs::Path& ego_route);
  /// What the table of channels records of a tick, and at decisions what tools need beside `rosbag
  /// play`. The snapshot must be among the messages.
  void write(const TickMessages& tick);
  /// Gives the file its name. Without this call it stays FILE.active; one that could not be written
  /// (disk full) is removed instead, and its room is free again.
  void finish();
  /// Nothing of it stays.
  void discard();

 private:
  void guard(const std::function<void()>& writing);
  void writeTick(const TickMessages& tick);
  void put(const Topic& topic, const ros::Time& stamp, const AnyMessage& message);
  void putOnce(ChannelId channel, const AnyMessage& message);

  std::string activeName() const { return name_ + ".active"; }

  core::OutputFolder folder_;
  std::string name_;
  int max_cbv_;  ///< slots
  TickReading reading_;
  Naming naming_;
  Content content_;
  std::unique_ptr<rosbag::Bag> bag_;
  bool failed_ = false;
};

/// What is added to the name of the planner of an action that carries noise.
inline constexpr const char* kNoiseMark = "+noise";

/// Who made the session, for SessionInfo.
struct BagOrigin {
  std::string deployment;         ///< "cdiff run", "cdiff collect"
  std::string simulator_version;  ///< "SUMO 1.15.0"
};

/// The bag of a session that one process drives: the same topics, stamps and order as the
/// recorder's, and the images that planners or records were given.
class SessionBagWriter : public session::SessionObserver {
 public:
  /// `setup` must outlive the object. `content` of the session only: without images and metrics,
  /// too. Throws InputError naming the file when it cannot be written.
  SessionBagWriter(const session::SessionSetup& setup, const std::filesystem::path& file,
                   const BagOrigin& origin, BagFile::Content content = BagFile::Content::kWhole);
  ~SessionBagWriter() override;

  /// Asked at each action whether it carries noise; without it none does.
  void setNoiseQuery(std::function<bool(const std::string& vehicle_id)> query) {
    noisy_ = std::move(query);
  }
  void observe(const session::TickRecord& record) override;
  /// Gives the file its name. Without this call it stays FILE.active.
  void finish();
  /// Nothing of the bag stays.
  void discard() { file_.discard(); }

 private:
  std::vector<Answer> answersOf(const session::TickRecord& record) const;
  std::string plannerOf(int slot) const;
  void addMetrics(const session::TickRecord& record, TickMessages& messages);

  const session::SessionSetup& setup_;
  BagFile::Content content_;
  BagFile file_;
  metrics::SessionMetrics metrics_;
  MetricReporter reporter_;
  std::function<bool(const std::string&)> noisy_;
};

}  // namespace cdiff::node_graph
