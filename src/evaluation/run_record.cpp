// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

RunRecord fromJson(const Json& json) {
  RunRecord record;
  record.id = json.at("id");
  for (const auto& [factor, level] : json.at("factors").items()) record.factors[factor] = level;
  for (const std::string& factor : factorNames()) {
    if (record.factors.count(factor) == 0) record.factors[factor] = "";
  }
  record.scenario_sha256 = json.at("scenario_sha256");
  if (json.contains("inputs")) record.inputs = json.at("inputs").get<InputHashes>();
  record.status = json.at("status");
  record.cause = json.at("cause");
  record.exit_code = json.at("exit_code");
  record.attempts = json.at("attempts");
  record.wall_seconds = json.at("wall_seconds");
  record.simulated_seconds = json.at("simulated_seconds");
  record.verdict = record::outcomeOf(json.at("verdict"));
  record.reasons = json.at("reasons").get<std::vector<std::string>>();
  record.decided_by = json.value("decided_by", std::vector<std::string>());
  for (const auto& [name, value] : json.at("figures").items()) record.figures[name] = value;
  return record;
}

}  // namespace

bool RunRecord::complete() const {
  return status != "error" && status != "interrupted" && status != "not_run";
}

std::string causeToRepeat(const RunRecord& earlier, const PlannedRun& planned) {
  if (earlier.status == "not_run") return "not run yet";
  if (!earlier.complete()) return "status " + earlier.status;
  if (earlier.scenario_sha256 != planned.scenario_sha256) return "scenario changed";
  if (earlier.inputs.empty() && !planned.inputs.empty())
    return "recorded by a version that kept no hashes of its inputs";
  const std::string changed = changedInputs(earlier.inputs, planned.inputs);
  return changed.empty() ? "" : changed + " changed";
}

RunRecord recordOf(const PlannedRun& run) {
  RunRecord record;
  record.id = run.id;
  record.factors = run.factors;
  record.scenario_sha256 = run.scenario_sha256;
  record.inputs = run.inputs;
  return record;
}

std::string recordJson(const RunRecord& record) {
  Json factors = Json::object();
  for (const std::string& factor : factorNames()) factors[factor] = record.factors.at(factor);
  Json figures = Json::object();
  for (const auto& [name, value] : record.figures) figures[name] = value;
  const Json json = {{"schema_version", 1},
                     {"id", record.id},
                     {"factors", factors},
                     {"scenario_sha256", record.scenario_sha256},
                     {"inputs", record.inputs},
                     {"status", record.status},
                     {"cause", record.cause},
                     {"exit_code", record.exit_code},
                     {"attempts", record.attempts},
                     {"wall_seconds", record.wall_seconds},
                     {"simulated_seconds", record.simulated_seconds},
                     {"verdict", record::toText(record.verdict)},
                     {"reasons", record.reasons},
                     {"decided_by", record.decided_by},
                     {"figures", figures}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<RunRecord> readRecord(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  try {
    return fromJson(Json::parse(core::readFile(file, "record")));
  } catch (const Json::exception& error) {
    throw core::InputError("'" + file.string() + "' is no record of a run: " + error.what() +
                           "; delete the file to have the run repeated");
  }
}

std::vector<RunRecord> readRecords(const fs::path& results) {
  std::vector<RunRecord> records;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(results / "runs", error)) {
    if (auto record = readRecord(entry.path() / "record.json")) records.push_back(*record);
  }
  if (records.empty()) {
    throw core::InputError("'" + results.string() +
                           "' holds no records of an evaluation (runs/*/record.json)");
  }
  std::sort(records.begin(), records.end(),
            [](const RunRecord& left, const RunRecord& right) { return left.id < right.id; });
  return records;
}

}  // namespace cdiff::evaluation
