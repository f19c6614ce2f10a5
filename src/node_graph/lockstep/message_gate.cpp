// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/lockstep/message_gate.h"

#include <algorithm>

#include "node_graph/lockstep/hosted_nodes.h"
#include "node_graph/messages/traffic_conversions.h"

namespace cdiff::node_graph {

std::string baseName(const std::string& node) { return node.substr(node.rfind('/') + 1); }

void Connections::expect(const std::string& topic, const std::vector<std::string>& nodes) {
  if (hostsNodes()) return;
  for (const std::string& node : nodes) counts_.try_emplace({topic, node}, 0);
}

void Connections::connected(const std::string& topic, const std::string& node) {
  ++links_[node];
  once_.insert(node);
  const auto entry = counts_.find({topic, baseName(node)});
  if (entry != counts_.end()) ++entry->second;
}

void Connections::disconnected(const std::string& topic, const std::string& node) {
  if (const auto links = links_.find(node); links != links_.end() && --links->second == 0)
    links_.erase(links);
  const auto entry = counts_.find({topic, baseName(node)});
  if (entry == counts_.end() || entry->second == 0) return;
  if (--entry->second == 0 && !hasLeft(baseName(node))) left_.push_back(baseName(node));
}

bool Connections::hasLeft(const std::string& node) const {
  return std::find(left_.begin(), left_.end(), node) != left_.end() || hostedExitCode(node);
}

std::vector<std::string> Connections::left() const {
  std::vector<std::string> nodes = hostedNodesLeft();
  nodes.insert(nodes.end(), left_.begin(), left_.end());
  return nodes;
}

std::vector<std::string> Connections::missing() const {
  std::vector<std::string> texts;
  for (const auto& [key, count] : counts_) {
    if (count == 0) texts.push_back(key.second + " does not listen to " + key.first + " yet");
  }
  return texts;
}

namespace {

constexpr std::size_t kMostSenders = 100;  // counted one by one
constexpr std::size_t kLongestName = 100;  // characters that are kept
constexpr const char* kOthers = "others";

bool isPowerOfTen(std::uint64_t count) {
  while (count >= 10 && count % 10 == 0) count /= 10;
  return count == 1;
}

std::string countText(std::uint64_t count) {
  return std::to_string(count) + (count == 1 ? " message" : " messages");
}

}  // namespace

std::string siblingNode(const std::string& base_name) {
  if (hostsNodes()) return ros::this_node::getName();
  return ros::names::append(ros::this_node::getNamespace(), base_name);
}

std::vector<std::string> siblingNodes(const std::vector<std::string>& base_names) {
  std::vector<std::string> names;
  for (const std::string& name : base_names) names.push_back(siblingNode(name));
  return names;
}

bool MessageGate::admits(const std::string& topic, const std::vector<std::string>& publishers,
                         const std::string& caller) {
  if (publishers.empty()) {
    const std::string& first = first_.try_emplace(topic, caller).first->second;
    if (first == caller) return true;
    refuse(topic, caller, "the session listens to " + first + ", which was the first to publish");
    return false;
  }
  if (std::find(publishers.begin(), publishers.end(), caller) != publishers.end()) return true;
  refuse(topic, caller, "the session listens to " + publishers.front());
  return false;
}

bool MessageGate::admitsTick(const std::string& topic, const std::string& caller,
                             std::uint64_t tick) {
  if (tick <= newest_tick_) return true;
  refuse(topic, caller, "it is of tick " + std::to_string(tick) + ", which has not been");
  return false;
}

std::uint64_t MessageGate::tickOf(const ros::Time& stamp) const {
  return nearestTick(stamp, simulation_step_);
}

void MessageGate::refuse(const std::string& topic, const std::string& caller,
                         const std::string& why) {
  std::pair<std::string, std::string> key(caller.substr(0, kLongestName), topic);
  if (refused_.size() >= kMostSenders && refused_.count(key) == 0) key = {kOthers, "any topic"};
  const std::uint64_t count = ++refused_[key];
  if (!report_ || !isPowerOfTen(count)) return;
  report_(countText(count) + " on " + key.second + " from " + key.first +
          (count == 1 ? " is ignored: " : " so far are ignored: ") + why);
}

std::vector<std::string> MessageGate::totals() const {
  std::vector<std::string> texts;
  for (const auto& [key, count] : refused_) {
    if (count > 1)
      texts.push_back(countText(count) + " on " + key.second + " from " + key.first +
                      " were ignored in all");
  }
  return texts;
}

}  // namespace cdiff::node_graph
