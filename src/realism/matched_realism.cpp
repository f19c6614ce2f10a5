// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/matched_realism.h"

#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/worker.h"

namespace cdiff::realism {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr const char* kScoreFile = "score.json";
constexpr const char* kSumo = "sumo";
constexpr const char* kSumoRow = "SUMO background";

/// A session whatever drives its CBVs.
using SessionKey = std::pair<std::string, std::string>;

SessionKey sessionOf(const MatchedJob& job) {
  return {job.run.factors.at("scenario"), job.run.factors.at("seed")};
}

/// What every row is called by: the variant, else planner and mode.
std::string shortDriver(const evaluation::PlannedRun& run) {
  const std::string& variant = run.factors.at("variant");
  if (!variant.empty()) return variant;
  const std::string& name = run.factors.at("cbv_planner");
  const planning::PlannerDescriptor* planner = planners::findPlanner(name);
  return (planner == nullptr ? name : planner->title) + ", " + run.factors.at("mode");
}

/// Names of the drivers of runs: the short one, and the levels in which drivers that share it
/// differ.
class DriverNames {
 public:
  explicit DriverNames(const std::vector<evaluation::PlannedRun>& runs) {
    for (const evaluation::PlannedRun& run : runs)
      for (const char* factor : kFactors)
        levels_[{shortDriver(run), factor}].insert(level(run, factor));
  }

  std::string of(const evaluation::PlannedRun& run) const {
    std::string name = shortDriver(run);
    for (const char* factor : kFactors) {
      if (levels_.at({shortDriver(run), factor}).size() > 1)
        name +=
            std::string(", ") + factor + " " + evaluation::levelName(factor, level(run, factor));
    }
    return name;
  }

 private:
  static constexpr const char* kFactors[] = {"cbv_planner", "mode", "method", "guidance_profile"};

  static std::string level(const evaluation::PlannedRun& run, const std::string& factor) {
    const auto found = run.factors.find(factor);
    return found == run.factors.end() ? "" : found->second;
  }

  std::map<std::pair<std::string, std::string>, std::set<std::string>>
      levels_;  ///< by name, factor
};

void requireOneEgo(const std::vector<evaluation::PlannedRun>& runs) {
  for (const evaluation::PlannedRun& run : runs) {
    const std::string& ego = run.factors.at("ego_planner");
    const std::string& first = runs.front().factors.at("ego_planner");
    if (ego == first) continue;
    throw InputError("the matrix has the egos '" + first + "' and '" + ego +
                     "'; matched realism compares drivers of CBVs, expected one ego planner");
  }
}

/// The run of a driver's job.
evaluation::PlannedRun runOf(const evaluation::PlannedRun& run, const std::string& driver,
                             const ContinuationOptions& options) {
  evaluation::PlannedRun job = run;
  job.factors["cbv_planner"] = driver;
  job.command = {{"realism", "continue", "{run}/scenario.yaml", "--driver", driver, "--rollouts",
                  std::to_string(options.rollouts), "--seconds",
                  core::formatNumber(options.seconds), "--out", std::string("{run}/") + kScoreFile},
                 kScoreFile};
  return job;
}

/// What is gathered of one driver.
struct Gathered {
  MatchedRow row;
  std::vector<Likelihoods> all;
  std::map<std::string, std::vector<double>> by_scenario;  ///< meta-metrics
};

void gather(const MatchedJob& job, const MatchedEnd& end, Gathered& gathered) {
  gathered.row.driver = job.driver;
  gathered.row.ceiling = job.planner == planners::kDefaultEgoPlanner;
  if (!end.score) {
    ++gathered.row.broken;
  } else if (!end.score->hand_over_tick || end.score->log_steps == 0) {
    ++gathered.row.without;
  } else {
    ++gathered.row.hand_overs;
    gathered.all.push_back(likelihoodsOf(end.score->sums));
    const auto meta = metaMetric(gathered.all.back());
    if (meta) gathered.by_scenario[job.run.factors.at("scenario")].push_back(*meta);
  }
}

MatchedRow rowOf(const Gathered& gathered) {
  MatchedRow row = gathered.row;
  row.likelihoods = meanOf(gathered.all);
  std::vector<double> means;
  for (const auto& [scenario, values] : gathered.by_scenario)
    means.push_back(*evaluation::statisticsOf(values).mean);
  row.meta = evaluation::statisticsOf(means);
  return row;
}

}  // namespace

std::vector<MatchedJob> planMatched(const std::vector<evaluation::PlannedRun>& runs,
                                    const ContinuationOptions& options) {
  requireOneEgo(runs);
  std::vector<MatchedJob> jobs;
  const DriverNames drivers(runs);
  std::set<std::string> taken;  // ids of SUMO's jobs
  std::map<SessionKey, bool> with_sumo;
  for (const evaluation::PlannedRun& run : runs) {
    const std::string& planner = run.factors.at("cbv_planner");
    MatchedJob job{drivers.of(run), planner, runOf(run, planner, options)};
    if (with_sumo.emplace(sessionOf(job), true).second) {
      jobs.push_back({kSumoRow, "", runOf(run, kSumo, options)});
      const std::string id =
          core::fileName(run.factors.at("scenario") + "__seed" + run.factors.at("seed") + "__sumo");
      jobs.back().run.id = id;
      for (int i = 2; !taken.insert(jobs.back().run.id).second; ++i)
        jobs.back().run.id = id + "__" + std::to_string(i);
    }
    jobs.push_back(std::move(job));
  }
  return jobs;
}

std::vector<MatchedEnd> endsOf(const std::vector<evaluation::RunRecord>& records,
                               const fs::path& results) {
  std::vector<MatchedEnd> ends;
  for (const evaluation::RunRecord& record : records) {
    MatchedEnd end;
    if (record.complete())
      end.score = readScore(evaluation::runFolder(results, record.id) / kScoreFile);
    else
      end.cause = record.cause.empty() ? record.status : record.cause;
    ends.push_back(std::move(end));
  }
  return ends;
}

std::string scoreJson(const ContinuationScore& score) {
  json features = json::object();
  for (std::size_t i = 0; i < kFeatures; ++i)
    features[featureDefinitions()[i].key] = {{"log_sum", score.sums[i].log_sum},
                                             {"n", score.sums[i].n}};
  json text = {{"schema_version", 1},
               {"hand_over_tick", nullptr},
               {"objects", score.objects},
               {"log_steps", score.log_steps},
               {"rollout_steps", score.rollout_steps},
               {"features", features}};
  if (score.hand_over_tick) text["hand_over_tick"] = *score.hand_over_tick;
  return text.dump(2) + "\n";
}

ContinuationScore readScore(const fs::path& file) {
  try {
    const json text = core::readJson(file, "score");
    ContinuationScore score;
    if (!text.at("hand_over_tick").is_null())
      score.hand_over_tick = text.at("hand_over_tick").get<std::uint64_t>();
    score.objects = text.at("objects").get<std::vector<std::string>>();
    score.log_steps = text.at("log_steps").get<std::size_t>();
    score.rollout_steps = text.at("rollout_steps").get<std::size_t>();
    for (std::size_t i = 0; i < kFeatures; ++i) {
      const json& feature = text.at("features").at(featureDefinitions()[i].key);
      score.sums[i] = {feature.at("log_sum").get<double>(), feature.at("n").get<std::size_t>()};
    }
    return score;
  } catch (const json::exception& error) {
    throw InputError("'" + file.string() + "' is no score of cdiff realism: " +
                     core::jsonFault(error) + "; delete the file to have its run repeated");
  }
}

std::vector<MatchedRow> matchedRows(const std::vector<MatchedJob>& jobs,
                                    const std::vector<MatchedEnd>& ends) {
  std::map<SessionKey, std::size_t> firsts;  // job with the session's hand-over
  std::vector<Gathered> gathered;
  std::map<std::string, std::size_t> places;
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    const std::size_t place = places.try_emplace(jobs[i].driver, gathered.size()).first->second;
    if (place == gathered.size()) gathered.emplace_back();
    gather(jobs[i], ends[i], gathered[place]);
    if (!ends[i].score) continue;
    const std::size_t first = firsts.try_emplace(sessionOf(jobs[i]), i).first->second;
    if (ends[first].score->hand_over_tick == ends[i].score->hand_over_tick &&
        ends[first].score->objects == ends[i].score->objects) {
      continue;
    }
    throw InputError("'" + jobs[first].run.id + "' and '" + jobs[i].run.id +
                     "' have different first hand-overs: the matrix must change nothing but who "
                     "drives the CBVs (planner, mode, method, guidance)");
  }
  std::vector<MatchedRow> rows;
  for (const Gathered& driver : gathered) rows.push_back(rowOf(driver));
  return rows;
}

}  // namespace cdiff::realism
