// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "ros/session_bag.h"

#include "planners/registry.h"
#include "ros/conversions.h"

namespace cdiff::ros {
namespace {

namespace fs = std::filesystem;

std::string bagTopic(const std::string& topic) { return "/" + topic; }

double latencyOf(const session::TickRecord& record, const std::string& planner) {
  for (const session::PlannerLatency& latency : record.latencies) {
    if (latency.planner == planner) return latency.milliseconds;
  }
  return 0.0;
}

}  // namespace

SessionBag::SessionBag(const session::SessionSetup& setup, const fs::path& file,
                       const BagOrigin& origin)
    : setup_(setup), file_(file, setup.options(), bagTopic), reporter_(setup) {
  msgs::SessionInfo info = toMsg(setup);
  info.deployment = origin.deployment;
  info.simulator_version = origin.simulator_version;
  info.package_version = E2E_CDIFF_VERSION;
  info.results_folder = fs::absolute(file).parent_path().string();
  file_.write(info);
  file_.write(toPathMsg(setup.egoRoute()));
}

SessionBag::~SessionBag() = default;

void SessionBag::observe(const session::TickRecord& record) {
  const session::ScenarioOptions& options = setup_.options();
  TickValues values{*record.snapshot, &setup_.network(), options.simulation_step,
                    planners::canBeGuided(options.cbv_planner)};
  values.selection = record.selection;
  if (record.actions != nullptr) {
    values.answers = answersOf(record);
    values.images = record.images;
  }
  TickMessages messages = makeMessages(values, static_cast<int>(options.max_cbv));
  if (const auto report = reporter_.observe(*record.snapshot, record.selection))
    messages.add(ChannelId::kMetrics, report);
  file_.write(messages);
}

std::string SessionBag::plannerOf(int slot) const {
  const session::ScenarioOptions& options = setup_.options();
  return slot == kEgoSlot ? "ego:" + options.ego_planner : "cbv:" + options.cbv_planner;
}

std::vector<Answer> SessionBag::answersOf(const session::TickRecord& record) const {
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

void SessionBag::finish() { file_.finish(); }

}  // namespace cdiff::ros
