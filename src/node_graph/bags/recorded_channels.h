// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "node_graph/bags/bag_reader.h"
#include "node_graph/messages/topics.h"

namespace cdiff::node_graph {

/// Which topic of a session a connection of its bag is, and whether it holds the type that it must.
struct RecordedTopic {
  std::optional<Topic> topic;  ///< nullopt for what no measure is made of
  std::string wrong_type;      ///< what is wrong with the type; empty when nothing is
};

/// What a connection holds; `name` is its topic without the session's namespace. `graph` says how
/// many slots there are and whose images planners saw; `all_images`: those of others count too.
RecordedTopic recordedTopic(const BagConnection& connection, const std::string& name,
                            const SessionGraph& graph, bool all_images);

/// Namespace of the recorded session with its last slash: topic of the first connection of
/// SessionInfo's type, less its name. Throws InputError listing what the bag holds when none is of
/// that type and definition.
std::string sessionPrefix(const std::vector<BagConnection>& connections);

}  // namespace cdiff::node_graph
