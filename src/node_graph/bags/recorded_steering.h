// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <vector>

#include "session/steering_file.h"

namespace cdiff::node_graph {

/// The steering that a bag holds, or session::readSteering of any other source. Throws InputError
/// naming the bag also for one that is damaged: what it lost could be steering.
std::vector<session::SteeringEntry> readSteering(const std::filesystem::path& source);

/// The session that a bag recorded, or session::steeredSession of any other source.
session::SteeredSession steeredSession(const std::filesystem::path& source);

}  // namespace cdiff::node_graph
