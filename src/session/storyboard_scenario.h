// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <memory>
#include <string>

#include "map/import/network_import.h"
#include "session/scenario_options.h"
#include "storyboard/storyboard_traffic.h"

namespace cdiff::session {

/// Whether a scenario is an OpenSCENARIO file, by its name (*.xosc).
bool isOpenScenario(const std::string& name_or_file);

/// The scenario that an OpenSCENARIO file describes, on top of `base`: network, storyboard, start
/// speed and target speed of the ego, and who drives its entities. The ego is the entity with a
/// controller `external_control`, else the one named Ego or hero. A controller that is named like
/// one of our planners makes an entity a CBV that this planner may drive. Throws InputError naming
/// file and line; with `own_network` also where the file of the network is not there.
ScenarioOptions openScenarioOptions(const std::string& file, const ScenarioOptions& base,
                                    bool own_network);

/// The storyboard of a scenario, on its network. Throws InputError naming file and line; also for
/// what is not supported, unless `options` say that it is to be ignored.
std::shared_ptr<const storyboard::Play> readPlay(const StoryboardOptions& options,
                                                 const map::ImportedNetwork& import,
                                                 const map::LaneGraph& graph);

/// The ego's route as the storyboard's beginning gives it: from its place through the positions
/// that it is to reach, else along its lane. Throws InputError naming file and line.
map::Route egoRouteOf(const storyboard::Play& play);

}  // namespace cdiff::session
