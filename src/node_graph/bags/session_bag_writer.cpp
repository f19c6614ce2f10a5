// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/session_bag_writer.h"

#include <algorithm>
#include <cerrno>

#include "core/program.h"
#include "e2e_cdiff/core/exceptions.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "planners/registry.h"

namespace cdiff::node_graph {
namespace {

namespace fs = std::filesystem;

/// rosbag keeps an entry of some 1.3 kB in RAM for each chunk. A long session gets larger chunks,
/// so that it takes less than 1 MB an hour.
constexpr std::uint64_t kLongBag = std::uint64_t{64} << 20;   // [bytes]
constexpr std::uint32_t kLongChunk = std::uint32_t{3} << 20;  // [bytes]

/// A bag takes no stamp of zero.
ros::Time bagStamp(const ros::Time& stamp) { return std::max(stamp, ros::TIME_MIN); }

}  // namespace

BagFile::BagFile(const fs::path& file, const session::ScenarioOptions& options, Naming naming,
                 Content content)
    : folder_(fs::absolute(file).parent_path()),
      name_(file.filename().string()),
      max_cbv_(static_cast<int>(options.max_cbv)),
      reading_{session::VehicleRigs(options), options.simulation_step},
      naming_(std::move(naming)),
      content_(content),
      bag_(std::make_unique<rosbag::Bag>()) {
  guard([&] {
    core::OutputFolder::requireFree(folder_.path(), {name_});
    folder_.remove({activeName()});
    bag_->open(folder_.claim(activeName()).string(), rosbag::bagmode::Write);
    if (content_ == Content::kWhole) bag_->setCompression(rosbag::compression::LZ4);
  });
}

BagFile::~BagFile() {
  try {
    bag_->close();
  } catch (const std::exception&) {
    // On a full disk. Its destructor would try once more and end the program, so it gets none.
    static_cast<void>(bag_.release());
  }
  if (!failed_) return;
  try {
    folder_.remove({activeName()});
  } catch (const core::InputError&) {
    // It stays on the record, and goes with the next session.
  }
}

void BagFile::discard() { failed_ = true; }

/// Errors of the bag name its file.
void BagFile::guard(const std::function<void()>& writing) {
  errno = 0;
  try {
    writing();
  } catch (const std::exception& error) {
    const std::string reason = errno == 0 ? "" : " (" + core::writeErrorText(errno) + ")";
    failed_ = true;
    throw core::InputError("cannot write the bag '" + (folder_.path() / name_).string() +
                           "': " + error.what() + reason +
                           "; check that the folder exists, is writable and has room");
  }
}

void BagFile::put(const Topic& topic, const ros::Time& stamp, const AnyMessage& message) {
  const std::string name = topic.name();
  topic.row().type.write(*bag_, name.front() == '/' ? name : naming_(name), stamp, message);
}

void BagFile::write(const msgs::SessionInfo& info) {
  guard([&] { putOnce(ChannelId::kSession, shared(info)); });
}

void BagFile::write(const nav_msgs::Path& ego_route) {
  guard([&] { putOnce(ChannelId::kEgoRoute, shared(ego_route)); });
}

/// In a chunk of its own: where the first ticks are damaged, the session is still known.
void BagFile::putOnce(ChannelId channel, const AnyMessage& message) {
  put(channel, ros::TIME_MIN, message);
  bag_->setChunkThreshold(bag_->getChunkThreshold());  // ends the open chunk
}

void BagFile::write(const TickMessages& tick) {
  guard([&] { writeTick(tick); });
}

void BagFile::writeTick(const TickMessages& tick) {
  const auto snapshot = tick.get<msgs::TrafficSnapshot>(ChannelId::kTraffic);
  const ros::Time stamp = bagStamp(snapshot->header.stamp);
  for (const Channel& row : channels()) {
    if (row.recorded != Recorded::kTick && row.recorded != Recorded::kDecision) continue;
    for (const Topic& topic : topicsOf(row, max_cbv_, reading_.rigs)) {
      AnyMessage message = tick.find(topic);
      const bool derives = row.derive != nullptr && content_ == Content::kWhole &&
                           (snapshot->decision_tick || row.recorded == Recorded::kTick);
      if (!message && derives) message = row.derive(tick, reading_, topic);
      if (message) put(topic, stamp, message);
    }
  }
  if (bag_->getSize() > kLongBag && bag_->getChunkThreshold() < kLongChunk)
    bag_->setChunkThreshold(kLongChunk);
}

void BagFile::finish() {
  guard([&] { bag_->close(); });
  const fs::path place = folder_.claim(name_);  // of another by now: the file stays FILE.active
  guard([&] {
    fs::rename(folder_.path() / activeName(), place);
    folder_.remove({activeName()});
  });
}

namespace {

std::string bagTopic(const std::string& topic) { return "/" + topic; }

double latencyOf(const session::TickRecord& record, const std::string& planner) {
  for (const session::PlannerLatency& latency : record.latencies) {
    if (latency.planner == planner) return latency.milliseconds;
  }
  return 0.0;
}

}  // namespace

SessionBagWriter::SessionBagWriter(const session::SessionSetup& setup, const fs::path& file,
                                   const BagOrigin& origin, BagFile::Content content)
    : setup_(setup),
      content_(content),
      file_(file, setup.options(), bagTopic, content),
      metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute()),
      reporter_(setup.options(), [this] { return metrics_.measures(); }) {
  msgs::SessionInfo info = toMsg(setup);
  info.deployment = origin.deployment;
  info.simulator_version = origin.simulator_version;
  info.package_version = E2E_CDIFF_VERSION;
  info.results_folder = fs::absolute(file).parent_path().string();
  file_.write(info);
  file_.write(toPathMsg(setup.egoRoute()));
}

SessionBagWriter::~SessionBagWriter() = default;

void SessionBagWriter::observe(const session::TickRecord& record) {
  const session::ScenarioOptions& options = setup_.options();
  TickValues values{*record.snapshot, &setup_.network(), options.simulation_step,
                    planners::canBeGuided(options.cbv_planner)};
  values.selection = record.selection;
  if (record.actions != nullptr) {
    values.answers = answersOf(record);
    if (content_ == BagFile::Content::kWhole) values.images = record.images;
  }
  TickMessages messages = makeMessages(values, static_cast<int>(options.max_cbv), setup_.rigs());
  if (content_ == BagFile::Content::kWhole) addMetrics(record, messages);
  file_.write(messages);
}

void SessionBagWriter::addMetrics(const session::TickRecord& record, TickMessages& messages) {
  const metrics::TickMeasures measures = metrics_.observe(*record.snapshot, record.selection);
  if (const auto report = reporter_.report(*record.snapshot, measures))
    messages.add(ChannelId::kMetrics, report);
}

std::string SessionBagWriter::plannerOf(int slot) const {
  const session::ScenarioOptions& options = setup_.options();
  return slot == kEgoSlot ? "ego:" + options.ego_planner : "cbv:" + options.cbv_planner;
}

std::vector<Answer> SessionBagWriter::answersOf(const session::TickRecord& record) const {
  std::vector<Answer> answers;
  for (const planning::PlannedAction& action : *record.actions) {
    Answer answer;
    answer.action = action;
    answer.planner = plannerOf(action.slot);
    answer.latency_ms = latencyOf(record, answer.planner);
    if (noisy_ && noisy_(action.vehicle_id)) answer.planner += kNoiseMark;
    answers.push_back(std::move(answer));
  }
  return answers;
}

void SessionBagWriter::finish() { file_.finish(); }

}  // namespace cdiff::node_graph
