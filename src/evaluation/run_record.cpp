// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/run_record.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_conditions.h"
#include "evaluation/worker.h"
#include "metrics/known_measures.h"
#include "metrics/metric_registry.h"

namespace cdiff::evaluation {
namespace {

using nlohmann::json;

/// Measures that lie at one place of a summary: all that metrics defines, and some of the session.
const std::vector<std::pair<std::string, std::string>>& places() {
  static const std::vector<std::pair<std::string, std::string>> all = [] {
    std::vector<std::pair<std::string, std::string>> list;
    for (const metrics::MeasureDefinition& definition : metrics::measureDefinitions())
      list.emplace_back(definition.name, definition.place);
    list.emplace_back("guidance_trust_region_share", "/guidance_trust_region_share");
    list.emplace_back("simulated_seconds", "/simulated_seconds");
    list.emplace_back("real_time_factor", "/real_time_factor");
    return list;
  }();
  return all;
}

/// Longest post-encroachment time of a close interaction [s].
constexpr double kCloseEncroachment = 3.0;

/// Shares of the vehicles that were CBVs whose path the ego's crossed, and crossed within
/// kCloseEncroachment; one that was selected twice counts once.
void addInteractions(const json& summary, Measures& measures) {
  const json::json_pointer place("/cbv/post_encroachments");
  if (!summary.contains(place) || summary.at(place).empty()) return;
  double crossed = 0.0;
  double close = 0.0;
  for (const json& entry : summary.at(place)) {
    const json time = entry.value("seconds", json());  // null: one of the two never came
    if (!time.is_number()) continue;
    ++crossed;
    close += std::abs(time.get<double>()) <= kCloseEncroachment ? 1.0 : 0.0;
  }
  const auto vehicles = static_cast<double>(summary.at(place).size());
  const auto share = [&](double count) { return 100.0 * count / vehicles; };
  measures["cbv_interactions_percent"] = share(crossed);
  measures["cbv_close_interactions_percent"] = share(close);
}

/// Shares over the CBVs that were selected; absent where the summary does not have the keys.
void addSelectionMeasures(const json& summary, Measures& measures) {
  const json selections = summary.value(json::json_pointer("/cbv/selections"), json::array());
  if (summary.contains(json::json_pointer("/cbv/selections")))
    measures[kSelectionCount] = static_cast<double>(selections.size());
  double passed = 0.0;
  double completion = 0.0;
  std::size_t with_passed = 0;
  std::size_t with_completion = 0;
  for (const json& selection : selections) {
    const json passed_value = selection.value("conflict_point_passed", json());
    const json completion_value = selection.value("route_completion_percent", json());
    if (passed_value.is_boolean()) {
      ++with_passed;
      passed += passed_value.get<bool>() ? 100.0 : 0.0;
    }
    if (completion_value.is_number()) {
      ++with_completion;
      completion += completion_value.get<double>();
    }
  }
  if (with_passed > 0) measures["cbv_passed_percent"] = passed / static_cast<double>(with_passed);
  if (with_completion > 0) {
    measures["cbv_completion_percent"] = completion / static_cast<double>(with_completion);
  }
  addInteractions(summary, measures);
}

std::string lastFault(const json& summary) {
  const json faults = summary.value("faults", json::array());
  return faults.empty() ? "" : faults.back().value("text", "");
}

}  // namespace

const std::vector<std::string>& measureNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, place] : places()) {
      all.emplace_back(name);
      if (all.back() != metrics::known::kCbvMinimumDistance.name) continue;
      all.insert(all.end(), {kSelectionCount, "cbv_passed_percent", "cbv_completion_percent",
                             "cbv_interactions_percent", "cbv_close_interactions_percent"});
    }
    return all;
  }();
  return names;
}

SummaryFacts readSummary(const std::string& text, const std::string& source) {
  try {
    core::requireShallowJson(text, "'" + source + "'");
    const json summary = json::parse(text);
    if (summary.value(json::json_pointer("/steering/by_hand"), false))
      throw core::InputError("'" + source + "': the session was steered by hand");
    SummaryFacts facts;
    facts.status = summary.at("status");
    facts.fault = lastFault(summary);
    facts.verdict = record::outcomeOf(summary.at("verdict").at("outcome"));
    facts.reasons = summary.at("verdict").at("reasons").get<std::vector<std::string>>();
    facts.decided_by = summary.at("verdict").value("decided_by", std::vector<std::string>());
    facts.simulated_seconds = summary.at("simulated_seconds");
    for (const auto& [name, place] : places()) {
      const json::json_pointer pointer(place);
      if (!summary.contains(pointer)) continue;
      const json& value = summary.at(pointer);
      if (value.is_number()) facts.measures[name] = value;
      if (value.is_boolean()) facts.measures[name] = value.get<bool>() ? 1.0 : 0.0;
    }
    addSelectionMeasures(summary, facts.measures);
    return facts;
  } catch (const json::exception& error) {
    throw core::InputError("'" + source +
                           "' is no summary of a session: " + core::jsonFault(error) +
                           "; expected the result of a session of this version");
  }
}

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Throws InputError for a word that no run ends with.
std::string statusIn(const Json& json) {
  using traffic::SessionStatus;
  const std::string status = json.at("status");
  for (const auto known :
       {SessionStatus::kCompleted, SessionStatus::kBlocked, SessionStatus::kDeviated,
        SessionStatus::kTimedOut, SessionStatus::kCollided, SessionStatus::kInterrupted,
        SessionStatus::kError}) {
    if (status == traffic::toText(known)) return status;
  }
  if (status == RunRecord().status) return status;
  throw core::InputError("'" + core::shortened(status) + "' is no status of a run");
}

RunRecord fromJson(const Json& json) {
  RunRecord record;
  record.id = json.at("id");
  for (const auto& [factor, level] : json.at("factors").items()) record.factors[factor] = level;
  for (const std::string& factor : factorNames()) {
    if (record.factors.count(factor) == 0)
      record.factors[factor] = factor == "method" ? "default" : "";
  }
  record.scenario_sha256 = json.at("scenario_sha256");
  if (json.contains("inputs")) record.inputs = json.at("inputs").get<InputHashes>();
  if (json.contains("command")) {
    json.at("command").at("words").at(0);  // none is damage
    record.command = {json.at("command").at("words"), json.at("command").at("result")};
  }
  record.status = statusIn(json);
  record.cause = json.at("cause");
  record.exit_code = json.at("exit_code");
  record.attempts = json.at("attempts");
  record.wall_seconds = json.at("wall_seconds");
  record.simulated_seconds = json.at("simulated_seconds");
  record.verdict = record::outcomeOf(json.at("verdict"));
  record.reasons = json.at("reasons").get<std::vector<std::string>>();
  record.decided_by = json.value("decided_by", std::vector<std::string>());
  for (const auto& [name, value] : json.at("figures").items()) record.measures[name] = value;
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
  if (!(earlier.command == planned.command)) return "command changed";
  if (earlier.inputs.empty() && !planned.inputs.empty())
    return "recorded by a version that kept no hashes of its inputs";
  const std::string changed = changedInputs(earlier.inputs, planned.inputs);
  return changed.empty() ? "" : changed + " changed";
}

bool isOfAnotherScenario(const RunRecord& earlier, const PlannedRun& planned) {
  if (earlier.scenario_sha256 != planned.scenario_sha256) return true;
  if (earlier.inputs.empty()) return false;
  return !changedInputs(earlier.inputs, planned.inputs, {"program", "ego_weights", "cbv_weights"})
              .empty();
}

RunRecord recordOf(const PlannedRun& run) {
  RunRecord record;
  record.id = run.id;
  record.factors = run.factors;
  record.scenario_sha256 = run.scenario_sha256;
  record.inputs = run.inputs;
  record.command = run.command;
  return record;
}

std::string recordJson(const RunRecord& record) {
  Json factors = Json::object();
  for (const std::string& factor : factorNames()) factors[factor] = record.factors.at(factor);
  Json measures = Json::object();
  for (const auto& [name, value] : record.measures) measures[name] = value;
  Json json = {{"schema_version", 1},
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
               {"figures", measures}};
  if (!record.command.isSession())
    json["command"] = {{"words", record.command.words}, {"result", record.command.result}};
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

std::optional<RunRecord> readRecord(const fs::path& file) {
  if (!fs::exists(file)) return std::nullopt;
  const std::string text = core::readFile(file, "record");
  const auto fail = [&file](const std::string& fault) {
    throw core::InputError("'" + file.string() + "' is no record of a run: " + fault +
                           "; delete the file to have the run repeated");
  };
  try {
    core::requireShallowJson(text, "the file");
    return fromJson(Json::parse(text));
  } catch (const Json::exception& error) {
    fail(core::jsonFault(error));
  } catch (const core::InputError& error) {
    fail(error.what());
  }
  return std::nullopt;
}

std::vector<RunRecord> readRecords(const fs::path& results) {
  std::vector<RunRecord> records;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(results / "runs", error)) {
    const auto record = readRecord(entry.path() / kRecordFile);
    if (record && record->command.isSession()) records.push_back(*record);
  }
  if (records.empty()) {
    throw core::InputError("'" + results.string() +
                           "' holds no records of an evaluation (runs/*/record.json)");
  }
  std::sort(records.begin(), records.end(),
            [](const RunRecord& left, const RunRecord& right) { return left.id < right.id; });
  return records;
}

namespace {

void addNumbers(const json& object, const std::string& place, SummaryNumbers& numbers) {
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) addNumbers(value, place + "/" + key, numbers);
    if (value.is_number()) numbers[place + "/" + key] = value;
  }
}

}  // namespace

std::string RunContact::partnerText() const {
  if (!with_cbv) return partner;
  return (*with_cbv ? "CBV " : "background vehicle ") + partner;
}

std::vector<RunContact> contactsIn(const std::string& text, const std::string& source) {
  std::vector<RunContact> contacts;
  try {
    core::requireShallowJson(text, "'" + source + "'");
    const json summary = json::parse(text);
    for (const json& entry : summary.value(json::json_pointer("/ego/contacts"), json::array())) {
      contacts.push_back({entry.at("seconds"), entry.at("with"), entry.at("ego_at_fault"),
                          entry.at("why"), entry.at("ego_speed_mps"), entry.at("other_speed_mps")});
      if (entry.contains("with_cbv")) contacts.back().with_cbv = entry.at("with_cbv").get<bool>();
    }
  } catch (const json::exception& error) {
    throw core::InputError("'" + source +
                           "' is no summary of a session: " + core::jsonFault(error) +
                           "; expected the result of a session of this version");
  }
  return contacts;
}

SummaryNumbers summaryNumbers(const std::string& text, const std::string& source) {
  core::requireShallowJson(text, "'" + source + "'");
  const json summary = json::parse(text, nullptr, false);
  if (!summary.is_object()) {
    throw core::InputError("'" + source +
                           "' is no summary of a session; delete the folder's "
                           "record.json to have the run repeated");
  }
  SummaryNumbers numbers;
  addNumbers(summary, "", numbers);
  return numbers;
}

std::optional<double> BatchRun::number(const std::string& pointer) const {
  const auto found = numbers.find(pointer);
  return found == numbers.end() ? std::nullopt : std::optional<double>(found->second);
}

session::ScenarioOptions scenarioOf(const BatchRun& run) {
  const auto file = run.folder / "scenario.yaml";
  session::ScenarioOptions options;
  core::loadOptions({file.string(), core::readFile(file, "scenario", core::kLargestOptionsFile)},
                    options);
  return options;
}

std::vector<BatchRun> readBatchRuns(const std::filesystem::path& results) {
  std::vector<BatchRun> runs;
  for (RunRecord& record : readRecords(results)) {
    BatchRun run;
    run.folder = runFolder(results, record.id);
    const auto file = run.folder / "summary.json";
    if (record.complete()) {
      const std::string summary = core::readFile(file, "summary");
      run.numbers = summaryNumbers(summary, file.string());
      run.contacts = contactsIn(summary, file.string());
      const session::ScenarioOptions scenario = scenarioOf(run);
      run.settings = settingsOf(scenario);
      run.cbv_conditioning = cbvConditioningOf(scenario);
    }
    run.record = std::move(record);
    runs.push_back(std::move(run));
  }
  return runs;
}

std::string pooledVariant(const std::vector<BatchRun>& runs) {
  std::set<std::string> variants;
  for (const BatchRun& run : runs) variants.insert(run.record.factors.at("variant"));
  return variants.empty() ? "" : *variants.begin();
}

bool hasLevels(const RunRecord& record, const Factors& levels) {
  return std::all_of(levels.begin(), levels.end(), [&](const auto& level) {
    const auto own = record.factors.find(level.first);
    return own != record.factors.end() && own->second == level.second;
  });
}

std::vector<const BatchRun*> runsWith(const std::vector<BatchRun>& runs, const Factors& levels) {
  std::vector<const BatchRun*> found;
  for (const BatchRun& run : runs) {
    if (hasLevels(run.record, levels)) found.push_back(&run);
  }
  return found;
}

}  // namespace cdiff::evaluation
