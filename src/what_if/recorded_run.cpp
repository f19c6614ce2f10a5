// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "what_if/recorded_run.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/result_folder.h"
#include "record/session_yaml.h"
#include "session/steering_file.h"

namespace cdiff::what_if {
namespace {

namespace fs = std::filesystem;
using core::InputError;

/// What a key of session.yaml is to people; nullptr where it does not decide how a session runs.
const char* subjectOf(const std::string& key) {
  const std::pair<const char*, const char*> subjects[] = {
      {"package.", "the program"},
      {"simulator.", "the simulator"},
      {"network.source_sha256", "the network"},
      {"network.imported_sha256", "the imported network"},
      {"libraries.", "a library of the program"},
      {"processor.instruction_set", "the program's instruction set"},
      {"inference.cbv_model_files_sha256", "the weights of the CBVs' planner"},
      {"inference.cbv_", "the inference of the CBVs' planner"}};
  for (const auto& [prefix, subject] : subjects) {
    if (key.compare(0, std::string(prefix).size(), prefix) == 0) return subject;
  }
  return nullptr;
}

}  // namespace

RecordedRun::RecordedRun(const fs::path& folder) : folder_(folder) {
  if (!core::isFile(folder / "session.yaml")) {
    throw InputError("'" + folder.string() +
                     "' is no result folder of a session: it has no session.yaml" +
                     (core::isFile(folder / "matrix.yaml")
                          ? "; it holds a batch: give --all, or one of its folders runs/ID"
                          : ""));
  }
  readSession();
  readSummary();
  readTrace();
}

void RecordedRun::readSession() {
  const std::string file = (folder_ / "session.yaml").string();
  record::SessionFile session = record::readSessionYaml(file);
  facts_ = std::move(session.facts);
  scenario_ = std::move(session.scenario);
  if (facts_.count("recorded_by") > 0) {
    throw InputError(file +
                     ": is the result of a replay, which does not say with which weights the "
                     "session ran; give the result folder of the session itself");
  }
  if (facts_["deterministic"] != "true" || scenario_.real_time_factor > 0.0) {
    throw InputError(file + ": the session was paced by the wall clock (real_time_factor " +
                     core::formatNumber(scenario_.real_time_factor) +
                     "), so it cannot be repeated; run it again with real_time_factor 0");
  }
  if (scenario_.cbv_planner == planning::kExternalPlanner) {
    throw InputError(file +
                     ": a node of the user's own drove the CBVs (cbv_planner external), and "
                     "what_if cannot ask it again; give a session whose CBVs a planner drove");
  }
  scenario_.at_most = 0.0;
  scenario_.video = false;
}

void RecordedRun::readSummary() {
  const std::string file = (folder_ / "summary.json").string();
  try {
    const auto summary = core::readJson(file, "summary");
    trace_sha256_ = summary.at("trace_sha256");
    const std::string status = summary.at("status");
    if (status == "error")
      throw InputError(file + ": the session broke (status error); what_if needs one that ran");
    cut_off_ = status == "interrupted";
    if (summary.contains("steering")) scenario_.steering = session::readSteering(file);
    for (const auto& contact : summary.at("ego").at("contacts")) {
      contacts_.push_back({contacts_.size() + 1, contact.at("tick"), contact.at("seconds"),
                           contact.at("with"), contact.at("ego_side")});
    }
  } catch (const nlohmann::json::exception& error) {
    throw InputError("'" + file + "' is no summary of a session: " + core::jsonFault(error) +
                     "; expected the result of a session of this version");
  }
}

void RecordedRun::readTrace() {
  const fs::path file = folder_ / "trace.csv";
  trace_ = core::readFile(file, "trace");
  if (core::sha256(trace_) != trace_sha256_) {
    throw InputError("'" + file.string() +
                     "' is not the trace that summary.json names (trace_sha256); give a result "
                     "folder as the session left it");
  }
  for (record::TraceRow& row : record::readTrace(file)) {
    last_tick_ = std::max(last_tick_, row.tick);
    if (row.action) actions_[row.tick][row.id] = *row.action;
  }
  for (const core::CsvRow& row : core::csvRows(trace_)) {
    if (row.line == 1) continue;  // the header
    const auto tick = core::parseNumber(row.text.substr(0, row.text.find(',')));
    const auto begin = static_cast<std::size_t>(row.text.data() - trace_.data());
    const auto [place, added] =
        rows_.try_emplace(static_cast<std::uint64_t>(tick.value()), begin, 0);
    place->second.second = begin + row.text.size() + 1;
  }
  if (cut_off_ && last_tick_ > 0) --last_tick_;
}

std::string_view RecordedRun::rowsAt(std::uint64_t tick) const {
  const auto found = rows_.find(tick);
  if (found == rows_.end()) return {};
  const auto& [begin, end] = found->second;
  return std::string_view(trace_).substr(begin, end - begin);
}

std::optional<traffic::ControlAction> RecordedRun::actionAt(std::uint64_t tick,
                                                            const std::string& id) const {
  const auto next = actions_.find(tick + 1);
  if (next == actions_.end()) return std::nullopt;
  const auto found = next->second.find(id);
  return found == next->second.end() ? std::nullopt
                                     : std::optional<traffic::ControlAction>(found->second);
}

void RecordedRun::requireUnchanged(const session::SessionSetup& setup,
                                   const std::string& simulator_version) const {
  auto now =
      record::sessionFacts(record::sessionYaml(setup, {"cdiff what_if", simulator_version, true}));
  for (const auto& [key, value] : facts_) {
    const char* subject = subjectOf(key);
    if (subject == nullptr || now[key] == value) continue;
    throw InputError((folder_ / "session.yaml").string() + ": key '" + key + "' is " + value +
                     ", but here it is " + (now[key].empty() ? "absent" : now[key]) + ": " +
                     subject + " is not what the session ran with; run the session again, or use " +
                     "what it ran with");
  }
}

}  // namespace cdiff::what_if
