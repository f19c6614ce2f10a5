// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "realism/matched_realism.h"

#include <deque>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/file.h"
#include "core/output_folder.h"
#include "core/process_pool.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::realism {
namespace {

namespace fs = std::filesystem;
using core::InputError;
using nlohmann::json;

constexpr const char* kScoreFile = "score.json";
constexpr const char* kJobFile = "job.json";
constexpr const char* kSumo = "sumo";
constexpr const char* kSumoRow = "SUMO background";

/// A session whatever drives its CBVs.
using SessionKey = std::pair<std::string, std::string>;

SessionKey sessionOf(const MatchedJob& job) {
  return {job.run.factors.at("scenario"), job.run.factors.at("seed")};
}

std::string driverOf(const evaluation::PlannedRun& run) {
  const std::string& variant = run.factors.at("variant");
  if (!variant.empty()) return variant;
  const std::string& name = run.factors.at("cbv_planner");
  const planning::PlannerDescriptor* planner = planners::findPlanner(name);
  return (planner == nullptr ? name : planner->title) + ", " + run.factors.at("mode");
}

void requireOneEgo(const std::vector<evaluation::PlannedRun>& runs) {
  for (const evaluation::PlannedRun& run : runs) {
    const std::string& ego = run.factors.at("ego_planner");
    const std::string& first = runs.front().factors.at("ego_planner");
    if (ego == first) continue;
    throw InputError("the matrix has the egos '" + first + "' and '" + ego +
                     "'; matched realism compares drivers of CBVs, expected one ego planner");
  }
}

/// All that a score depends on, as text.
std::string jobText(const MatchedJob& job, const ContinuationOptions& options) {
  const json text = {{"schema_version", 1},
                     {"driver", job.driver},
                     {"planner", job.planner},
                     {"scenario", job.run.factors.at("scenario")},
                     {"seed", job.run.factors.at("seed")},
                     {"scenario_sha256", job.run.scenario_sha256},
                     {"inputs", job.run.inputs},
                     {"rollouts", options.rollouts},
                     {"seconds", options.seconds}};
  return text.dump(2) + "\n";
}

std::string lastLine(const fs::path& log) {
  if (!core::isFile(log)) return "no output";
  const auto lines = core::splitText(core::readFile(log, "log"), '\n');
  return lines.empty() ? "no output" : lines.back();
}

class MatchedRunner {
 public:
  MatchedRunner(const std::vector<MatchedJob>& jobs, const MatchedExecution& execution,
                const std::atomic<bool>& stop)
      : jobs_(jobs), execution_(execution), stop_(stop), ends_(jobs.size()) {}

  std::vector<MatchedEnd> run() {
    std::deque<std::size_t> queue;
    for (std::size_t i = 0; i < jobs_.size(); ++i) {
      ends_[i].cause = "not run";
      if (!stays(i)) queue.push_back(i);
    }
    core::runProcesses(queue, {execution_.jobs, execution_.timeout, 20.0}, stop_,
                       {[this](std::size_t job) { return start(job); },
                        [this](const core::ProcessEnd& end) { return finish(end); }});
    return std::move(ends_);
  }

 private:
  fs::path folderOf(std::size_t job) const { return execution_.results / "runs" / jobs_[job].id; }

  bool stays(std::size_t job) {
    const fs::path folder = folderOf(job);
    const bool same =
        execution_.resume && core::isFile(folder / kJobFile) && core::isFile(folder / kScoreFile) &&
        core::readFile(folder / kJobFile, "job") == jobText(jobs_[job], execution_.options);
    if (!same) return false;
    ends_[job] = {readScore(folder / kScoreFile), "", true};
    if (execution_.ended) execution_.ended(jobs_[job], ends_[job]);
    return true;
  }

  core::ProcessJob start(std::size_t job) {
    core::OutputFolder runs(core::OutputFolder(execution_.results).subfolder("runs"));
    core::OutputFolder output(runs.subfolder(jobs_[job].id));
    const fs::path folder = output.path();
    output.remove({kScoreFile, "log.txt"});
    output.write("scenario.yaml", jobs_[job].run.scenario_text);
    output.write(kJobFile, jobText(jobs_[job], execution_.options));
    const std::string& planner = jobs_[job].planner;
    return {execution_.program,
            {"realism", "continue", (folder / "scenario.yaml").string(), "--driver",
             planner.empty() ? kSumo : planner, "--rollouts",
             std::to_string(execution_.options.rollouts), "--seconds",
             core::formatNumber(execution_.options.seconds), "--out",
             output.claim(kScoreFile).string()},
            output.claim("log.txt")};
  }

  bool finish(const core::ProcessEnd& end) {
    const fs::path folder = folderOf(end.job);
    MatchedEnd& done = ends_[end.job];
    if (end.exit_code == 0 && core::isFile(folder / kScoreFile)) {
      done = {readScore(folder / kScoreFile), "", false};
    } else {
      done.cause = end.interrupted ? "interrupted"
                   : end.timed_out ? "timed out"
                                   : "exit code " + std::to_string(end.exit_code) + ": " +
                                         lastLine(folder / "log.txt");
    }
    if (execution_.ended) execution_.ended(jobs_[end.job], done);
    return false;
  }

  const std::vector<MatchedJob>& jobs_;
  const MatchedExecution& execution_;
  const std::atomic<bool>& stop_;
  std::vector<MatchedEnd> ends_;
};

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

std::vector<MatchedJob> planMatched(const std::vector<evaluation::PlannedRun>& runs) {
  requireOneEgo(runs);
  std::vector<MatchedJob> jobs;
  std::map<SessionKey, bool> with_sumo;
  for (const evaluation::PlannedRun& run : runs) {
    MatchedJob job{run.id, driverOf(run), run.factors.at("cbv_planner"), run};
    if (with_sumo.emplace(sessionOf(job), true).second)
      jobs.push_back({run.id + "__sumo", kSumoRow, "", run});
    jobs.push_back(std::move(job));
  }
  return jobs;
}

std::vector<MatchedEnd> runMatched(const std::vector<MatchedJob>& jobs,
                                   const MatchedExecution& execution,
                                   const std::atomic<bool>& stop) {
  return MatchedRunner(jobs, execution, stop).run();
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
    const json text = json::parse(core::readFile(file, "score"));
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
    throw InputError("'" + file.string() + "' is no score of cdiff realism: " + error.what());
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
    throw InputError("'" + jobs[first].id + "' and '" + jobs[i].id +
                     "' have different first hand-overs: the matrix must change nothing but who "
                     "drives the CBVs (planner, mode, method, guidance)");
  }
  std::vector<MatchedRow> rows;
  for (const Gathered& driver : gathered) rows.push_back(rowOf(driver));
  return rows;
}

}  // namespace cdiff::realism
