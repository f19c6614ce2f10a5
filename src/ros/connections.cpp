// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/connections.h"

#include <algorithm>

namespace cdiff::ros {

std::string baseName(const std::string& node) { return node.substr(node.rfind('/') + 1); }

void Connections::expect(const std::string& topic, const std::vector<std::string>& nodes) {
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
  return std::find(left_.begin(), left_.end(), node) != left_.end();
}

std::vector<std::string> Connections::missing() const {
  std::vector<std::string> texts;
  for (const auto& [key, count] : counts_) {
    if (count == 0) texts.push_back(key.second + " does not listen to " + key.first + " yet");
  }
  return texts;
}

}  // namespace cdiff::ros
