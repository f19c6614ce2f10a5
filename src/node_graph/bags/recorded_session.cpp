// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/bags/recorded_session.h"

#include <functional>
#include <map>
#include <string_view>

#include "core/file.h"
#include "core/text.h"
#include "node_graph/bags/recorded_channels.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

using core::InputError;

constexpr std::size_t kWindow = 50;         // snapshots that wait for late answers
constexpr std::size_t kMostFindings = 100;  // the rest is counted

bool running(const msgs::TrafficSnapshot& snapshot) {
  return snapshot.status == msgs::TrafficSnapshot::RUNNING;
}

/// Whether a session broke, so that its last ticks may lack something.
bool broke(const msgs::TrafficSnapshot& snapshot) {
  return snapshot.status == msgs::TrafficSnapshot::ERROR ||
         snapshot.status == msgs::TrafficSnapshot::INTERRUPTED;
}

std::string tickText(std::uint64_t tick) { return "tick " + std::to_string(tick); }

/// What the metrics node of the session waited for. Earlier versions recorded no decision records,
/// so none is waited for; one that is there says what else came.
ChannelSet awaitedInBag(SessionGraph graph) {
  graph.paced = false;
  graph.external_ego = false;
  return awaitedBy(Party::kMetrics, graph);
}

std::string gapText(std::uint64_t first, std::uint64_t last) {
  if (first == last) return tickText(first) + " is missing";
  return "ticks " + std::to_string(first) + " to " + std::to_string(last) + " (" +
         std::to_string(last - first + 1) + ") are missing";
}

}  // namespace

/// What each connection of the bag is.
struct RecordedSession::Topics {
  std::map<const BagConnection*, RecordedTopic> known;
};

RecordedSession::RecordedSession(const std::filesystem::path& bag, RecordedImages images)
    : reader_(bag), images_(images), topics_(std::make_unique<Topics>()) {
  try {
    readInfo();
    requireReadableTicks();
    setup_ = setupOf(*info_);
    const session::ScenarioOptions& options = setup_->options();
    graph_ = info_->participants.empty() ? graphOf(options, GraphRequest()) : graphOf(*info_);
    answers_ = TickAnswers(options.simulation_step, awaitedInBag(graph_), setup_->rigs());
  } catch (const std::exception& error) {
    std::string text = "bag '" + bag.string() + "': " + error.what();
    for (const std::string& damage : reader_.damage()) text += "; " + damage;
    throw InputError(text);
  }
}

RecordedSession::~RecordedSession() = default;

/// Finds the session wherever it is in the bag, then goes back to its first message.
void RecordedSession::readInfo() {
  BagMessage message;
  while (!info_ && reader_.next(message)) {
    if (message.connection->type != channel(ChannelId::kSession).type.name) continue;
    prefix_ = sessionPrefix({*message.connection});
    info_ = decode<msgs::SessionInfo>(message);
  }
  if (!info_) {
    sessionPrefix(reader_.connections());
    throw InputError("the message that describes the session is lost");
  }
  if (core::sha256(info_->network_text) != info_->network_text_sha256)
    throw InputError("the network in it has not the SHA-256 that was recorded beside it");
  reader_.rewind();
}

/// A version whose ticks are others can replay the bag; this one cannot.
void RecordedSession::requireReadableTicks() const {
  const Topic traffic(ChannelId::kTraffic);
  const MessageType& type = traffic.row().type;
  for (const BagConnection& connection : reader_.connections()) {
    if (connection.topic != prefix_ + traffic.name() || connection.type != type.name ||
        connection.md5sum == type.md5sum)
      continue;
    throw InputError("e2e_cdiff " + info_->package_version + " recorded it, and its " + type.name +
                     " (MD5 sum " + connection.md5sum + ") is another than that of this version, " +
                     E2E_CDIFF_VERSION + "; replay it with e2e_cdiff " + info_->package_version +
                     ", or record the session again");
  }
}

void RecordedSession::find(const std::string& text) {
  if (findings_.size() < kMostFindings)
    findings_.push_back(text);
  else if (findings_.size() == kMostFindings)
    findings_.emplace_back("more than " + std::to_string(kMostFindings) +
                           " findings; the rest is not named");
}

void RecordedSession::copyDamage() {
  const std::vector<std::string>& damage = reader_.damage();
  while (damage_copied_ < damage.size()) find(damage[damage_copied_++]);
}

bool RecordedSession::readMessage() {
  BagMessage message;
  const bool found = !session_over_ && reader_.next(message);
  copyDamage();
  if (found) take(message);
  return found;
}

void RecordedSession::take(const BagMessage& message) {
  if (topics_->known.count(message.connection) == 0) {
    const std::string& name = message.connection->topic;
    RecordedTopic topic;
    if (name.compare(0, prefix_.size(), prefix_) == 0)
      topic = recordedTopic(*message.connection, name.substr(prefix_.size()), graph_,
                            images_ == RecordedImages::kAll);
    if (!topic.wrong_type.empty()) find(topic.wrong_type);
    topics_->known[message.connection] = topic;
  }
  const RecordedTopic& known = topics_->known.at(message.connection);
  if (!known.topic || !known.wrong_type.empty()) return;
  try {
    dispatch(*known.topic, message);
  } catch (const InputError& error) {
    find(error.what());
  }
}

void RecordedSession::dispatch(const Topic& topic, const BagMessage& message) {
  if (topic.id == ChannelId::kSession) return takeSession(message);
  if (topic.id == ChannelId::kTraffic) return takeSnapshot(message);
  if (topic.id == ChannelId::kSelection) return takeSelection(message);
  answers_.add(topic, topic.row().type.decode(message));
}

/// A latched message may be recorded again; another one starts another session.
void RecordedSession::takeSession(const BagMessage& message) {
  const auto info = decode<msgs::SessionInfo>(message);
  const bool same = info->scenario_yaml == info_->scenario_yaml &&
                    info->results_folder == info_->results_folder &&
                    info->network_text_sha256 == info_->network_text_sha256;
  if (same) return;
  session_over_ = true;
  find("a second session begins in it after tick " + std::to_string(newest_.value_or(0)) +
       "; only the first is evaluated");
}

void RecordedSession::takeSnapshot(const BagMessage& message) {
  const auto snapshot = decode<msgs::TrafficSnapshot>(message);
  const std::string wrong = unusable(*snapshot, setup_->options().simulation_step);
  if (!wrong.empty())
    return find("the snapshot of " + tickText(snapshot->tick) + " cannot be used: " + wrong);
  const std::size_t hash = std::hash<std::string_view>()(message.bytes);
  if (!newest_ || snapshot->tick > *newest_) {
    newest_ = snapshot->tick;
    newest_hash_ = hash;
    snapshots_.push_back(snapshot);
    return;
  }
  const bool again = snapshot->tick == *newest_ && hash == newest_hash_;
  if (again) return;  // sent once more for a late listener
  find("time goes backwards: " + tickText(snapshot->tick) + " (" +
       core::formatNumber(snapshot->time) + " s) comes after " + tickText(*newest_) +
       "; it is left out");
}

void RecordedSession::takeSelection(const BagMessage& message) {
  const auto selection = decode<msgs::CbvSelection>(message);
  const std::string wrong = unusable(*selection, setup_->network());
  if (wrong.empty()) {
    answers_.add(ChannelId::kSelection, selection);
    return;
  }
  find("the selection of " + tickText(selection->tick) + " cannot be used: " + wrong);
}

/// The last snapshot waits for the end of the file, so that it can name all that was found.
bool RecordedSession::frontIsReady() const {
  if (snapshots_.size() < 2 || !running(*snapshots_.front())) return false;
  if (snapshots_.size() > kWindow) return true;
  return images_ == RecordedImages::kSeen && answers_.missing(*snapshots_.front()).empty();
}

RecordedSession::Snapshot RecordedSession::next() {
  if (last_ && !running(*last_)) return nullptr;
  while (!frontIsReady() && readMessage()) {
  }
  if (snapshots_.empty()) return nullptr;
  const Snapshot front = snapshots_.front();
  snapshots_.pop_front();
  if (!running(*front) && !snapshots_.empty())
    find(std::to_string(snapshots_.size()) + " snapshots come after the session's end at " +
         tickText(front->tick) + "; they are left out");
  if (last_) answers_.forgetBefore(last_->tick + 1);
  checkOrder(*front);
  checkAnswers(*front);
  const bool cut_off = running(*front) && snapshots_.empty();
  return handOut(cut_off ? cutOff(front) : front);
}

/// Adds to the snapshot what was found since the last one.
RecordedSession::Snapshot RecordedSession::handOut(const Snapshot& snapshot) {
  last_ = snapshot;
  if (handed_out_ == findings_.size()) return snapshot;
  auto copy = boost::make_shared<msgs::TrafficSnapshot>(*snapshot);
  for (; handed_out_ < findings_.size(); ++handed_out_) {
    copy->faults.emplace_back();
    copy->faults.back().tick = snapshot->tick;
    copy->faults.back().source = kBagSource;
    copy->faults.back().text = findings_[handed_out_];
  }
  return copy;
}

void RecordedSession::checkOrder(const msgs::TrafficSnapshot& snapshot) {
  const std::uint64_t expected = last_ ? last_->tick + 1 : 0;
  if (snapshot.tick == expected) return;
  // A decision that broke the session leaves no snapshot.
  if (snapshot.tick == expected + 1 && broke(snapshot)) return;
  find(gapText(expected, snapshot.tick - 1));
}

/// In lockstep the session goes on when all answers to a decision are there.
void RecordedSession::checkAnswers(const msgs::TrafficSnapshot& snapshot) {
  if (!unanswered_.empty() && !broke(snapshot)) find(unanswered_);
  unanswered_.clear();
  if (!running(snapshot) || setup_->options().real_time_factor > 0.0) return;
  if (images_ == RecordedImages::kAll) return;
  const std::vector<std::string> missing = namesOf(answers_.missing(snapshot));
  if (!missing.empty())
    unanswered_ = tickText(snapshot.tick) + " lacks " + core::joinText(missing, ", ");
}

/// The last snapshot of a recording that was cut off, with the end of the session.
RecordedSession::Snapshot RecordedSession::cutOff(const Snapshot& snapshot) {
  auto end = boost::make_shared<msgs::TrafficSnapshot>(*snapshot);
  end->status = msgs::TrafficSnapshot::INTERRUPTED;
  if (!unanswered_.empty()) {
    find(unanswered_);
    end->decision_tick = false;  // nothing waits for these answers
  }
  find("the recording ends at " + tickText(end->tick) + " (" + core::formatFixed(end->time, 2) +
       " s) while the session was still running");
  return end;
}

}  // namespace cdiff::node_graph
