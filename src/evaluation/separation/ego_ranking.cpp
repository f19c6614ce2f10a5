// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/separation/ego_ranking.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>

#include "core/file.h"
#include "core/json_file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/executor.h"
#include "evaluation/intervals/pooled_estimate.h"
#include "evaluation/run_record.h"
#include "metrics/formulas/rank_correlation.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr double kStandingSpeed = 0.1;  // [m/s]
constexpr double kSlowSpeed = 1.0;      // [m/s]

/// Minutes that the ego stood, from its rows of a trace.
double standingMinutes(std::string_view trace, double step) {
  constexpr std::string_view kEgo = ",ego,ego,";
  std::size_t ticks = 0;
  for (std::size_t at = trace.find(kEgo); at != std::string_view::npos;
       at = trace.find(kEgo, at + kEgo.size())) {
    std::size_t cell = at + kEgo.size();
    for (int skipped = 0; skipped < 3; ++skipped) cell = trace.find(',', cell) + 1;
    const auto speed = core::parseNumber(trace.substr(cell, trace.find(',', cell) - cell));
    if (speed.value_or(1.0) < kStandingSpeed) ++ticks;
  }
  return static_cast<double>(ticks) * step / 60.0;
}

/// Who takes over, and when: answers of different times are not one count.
std::string driverIn(const json& answer) {
  return answer.at("driver").get<std::string>() + ", " +
         core::formatNumber(answer.at("before_s").get<double>()) + " s before";
}

/// Adds what `cdiff what_if` found about the contacts of a session.
void addAnswers(const fs::path& folder, const std::string& trace_sha256, EgoRun& run) {
  std::error_code none;
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder / record::kWhatIfFolder, none)) {
    if (entry.path().extension() == ".json") files.insert(entry.path());
  }
  for (const fs::path& file : files) {
    const json answer = core::readJson(file, "answer");
    if (answer.at("trace_sha256") != trace_sha256 || !answer.contains("contact")) continue;
    const std::size_t number = answer.at("contact").at("number");
    if (number < 1 || number > run.contacts.size()) continue;
    const bool open = answer.at("open").at("avoids");
    bool shifted = open;
    for (const json& shift : answer.at("open_shifted"))
      shifted = shifted && shift.at("avoids").get<bool>();
    run.contacts[number - 1].avoided[driverIn(answer)] = {
        answer.at("closed").at("avoids").get<bool>(), open, shifted};
  }
}

void addContacts(const fs::path& folder, const json& summary, double step, EgoRun& run) {
  const json& contacts = summary.at("ego").at("contacts");
  if (contacts.empty()) return;
  const std::vector<record::TraceRow> trace = record::readTrace(folder / "trace.csv");
  for (const json& contact : contacts) {
    run.contacts.push_back(
        {contact.at("seconds"),
         traceContact(trace, contact.at("tick"), contact.at("with"), contact.at("ego_side"), step),
         contact.at("ego_speed_mps").get<double>() < kStandingSpeed,
         {}});
  }
}

double numberAt(const json& object, const char* key) {
  const json value = object.value(key, json());
  return value.is_number() ? value.get<double>() : 0.0;
}

void addChallenges(const json& summary, EgoRun& run) {
  const json challenge = summary.value("challenge", json::object());
  run.challenges = challenge.value("decisions", std::size_t{0});
  const json withdrawn = challenge.value("withdrawn", json::object());
  for (const json& count : withdrawn) run.withdrawn += count.get<std::size_t>();
}

/// Time between ticks [s]: the session's length over its last tick.
double stepOf(std::string_view trace, double seconds) {
  const std::size_t last = trace.size() < 2 ? 0 : trace.rfind('\n', trace.size() - 2) + 1;
  const auto tick = core::parseNumber(trace.substr(last, trace.find(',', last) - last));
  return tick.value_or(0.0) > 0.0 ? seconds / *tick : 0.0;
}

/// "naturalistic, CBVs diffusion", and the method where it is not the default one.
std::string settingOf(const json& summary) {
  const std::string usual = session::ScenarioOptions().method;
  const std::string method = summary.value("method_preset", usual);
  return summary.at("mode").get<std::string>() + ", CBVs " +
         summary.at("cbv_planner").get<std::string>() +
         (method == usual ? "" : ", method " + method);
}

/// The ego is called by its planner. Throws json::exception for a damaged summary.
EgoRun readRun(const fs::path& folder, const fs::path& base) {
  const std::string text = core::readFile(folder / "summary.json", "summary");
  if (readSummary(text, (folder / "summary.json").string()).status == "error")
    throw core::InputError("'" + folder.string() +
                           "' holds a session with status 'error', which no "
                           "ranking may hold; move it elsewhere");
  const json summary = json::parse(text);
  EgoRun run;
  run.setting = settingOf(summary);
  run.ego = summary.at("ego_planner");
  run.scenario = summary.at("scenario");
  run.seed = std::to_string(summary.at("seed").get<std::int64_t>());
  run.report = fs::proximate(folder / "report.html", base).generic_string();
  const json& ego = summary.at("ego");
  run.kilometers = numberAt(ego, "distance_m") / 1000.0;
  run.minutes = summary.at("simulated_seconds").get<double>() / 60.0;
  run.completion_percent = numberAt(ego, "route_completion_percent");
  run.driving_score = numberAt(ego, "driving_score");
  run.near_misses = static_cast<std::size_t>(numberAt(ego, "near_misses"));
  const std::string trace = core::readFile(folder / "trace.csv", "trace");
  const double step = stepOf(trace, 60.0 * run.minutes);
  run.standing_minutes = standingMinutes(trace, step);
  addContacts(folder, summary, step, run);
  addAnswers(folder, summary.at("trace_sha256"), run);
  addChallenges(summary, run);
  return run;
}

EgoRun checkedRun(const fs::path& folder, const fs::path& base) {
  try {
    return readRun(folder, base);
  } catch (const json::exception& error) {
    throw core::InputError("'" + folder.string() +
                           "' holds a damaged result of a session: " + core::jsonFault(error) +
                           "; drive the session again, or move the folder elsewhere");
  }
}

/// Runs of a batch. An ego is called by its variant where the variant decides who it is, else by
/// its planner, with the variant where there are several.
std::vector<EgoRun> readBatch(const fs::path& folder, const fs::path& base) {
  std::vector<EgoRun> runs;
  std::map<std::string, std::set<std::string>> planners;  // by variant
  std::map<std::string, std::set<std::string>> profiles;  // of guidance, by setting
  std::vector<std::string> variants;                      // of the runs
  std::vector<std::string> guidance;                      // of the runs
  for (const RunRecord& record : readRecords(folder)) {
    if (!record.complete()) continue;
    runs.push_back(checkedRun(runFolder(folder, record.id), base));
    const std::string& variant = record.factors.at("variant");
    planners[variant].insert(runs.back().ego);
    variants.push_back(variant);
    guidance.push_back(record.factors.at("guidance_profile"));
    profiles[runs.back().setting].insert(guidance.back());
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    if (profiles[runs[i].setting].size() > 1)
      runs[i].setting += ", guidance " + levelName("guidance_profile", guidance[i]);
  }
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const std::string& variant = variants[i];
    if (variant.empty()) continue;
    runs[i].ego = planners[variant].size() == 1 ? variant : runs[i].ego + ", " + variant;
  }
  return runs;
}

}  // namespace

std::vector<EgoRun> readEgoRuns(const fs::path& folder, const fs::path& base) {
  if (core::isFile(folder / "matrix.yaml")) return readBatch(folder, base);
  std::vector<EgoRun> runs;
  std::error_code none;
  std::set<fs::path> sessions;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (core::isFile(entry.path() / "session.yaml")) sessions.insert(entry.path());
  }
  for (const fs::path& session : sessions) {
    runs.push_back(checkedRun(session, base));
    runs.back().ego = fs::weakly_canonical(folder).filename().string();
  }
  if (!runs.empty()) return runs;
  throw core::InputError("'" + folder.string() +
                         "' holds neither a batch (matrix.yaml) nor folders of sessions "
                         "(*/session.yaml)");
}

namespace {

using Runs = std::vector<const EgoRun*>;

/// Contacts over km or minutes, by route.
RouteSums sumsOf(const Runs& runs, double EgoRun::*exposure,
                 const std::set<std::string>& scenarios) {
  std::map<std::string, RouteSum> sums;
  for (const std::string& scenario : scenarios) sums[scenario];
  for (const EgoRun* run : runs) {
    const auto found = sums.find(run->scenario);
    if (found == sums.end()) continue;
    found->second.sum += static_cast<double>(run->contacts.size());
    found->second.weight += run->*exposure;
  }
  RouteSums routes;
  for (const auto& [scenario, sum] : sums) routes.push_back(sum);
  return routes;
}

std::set<std::string> scenariosOf(const Runs& runs) {
  std::set<std::string> scenarios;
  for (const EgoRun* run : runs) scenarios.insert(run->scenario);
  return scenarios;
}

double ratio(double sum, double weight) { return weight > 0.0 ? sum / weight : 0.0; }

void countContact(const EgoRun& run, const EgoRun::Contact& contact, EgoFigures& figures) {
  const ContactKind kind = contact.traced.kind;
  ++figures.kinds[kind];
  if (contact.standing) ++figures.standing;
  if (contact.traced.partner_speed < kSlowSpeed) ++figures.slow;
  const auto worst = figures.worst.find(kind);
  if (worst == figures.worst.end() || contact.traced.impact_speed > figures.worst_speed[kind]) {
    figures.worst[kind] = &run;
    figures.worst_speed[kind] = contact.traced.impact_speed;
    figures.worst_seconds[kind] = contact.seconds;
  }
  for (const auto& [driver, avoided] : contact.avoided) {
    AvoidedShare& share = figures.avoided[driver];
    ++share.asked;
    for (std::size_t i = 0; i < avoided.size(); ++i) share.avoided[i] += avoided[i] ? 1 : 0;
  }
}

/// Of contacts per km or minute, of which there are `sum`; of few routes the exact one alone.
Interval contactInterval(const Runs& runs, double EgoRun::*exposure, double sum,
                         std::size_t contacts, RouteBootstrap& bootstrap) {
  if (sum <= 0.0) return {};
  const std::set<std::string> scenarios = scenariosOf(runs);
  std::optional<Interval> by_routes;
  if (showsIntervals(scenarios.size()))
    by_routes = bootstrap.valueInterval(sumsOf(runs, exposure, scenarios));
  return rateInterval(contacts, sum, by_routes);
}

EgoFigures figuresOf(const std::string& ego, const Runs& runs, RouteBootstrap& bootstrap) {
  EgoFigures figures;
  figures.ego = ego;
  figures.runs = runs.size();
  double standing = 0.0;
  double challenges = 0.0;
  double withdrawn = 0.0;
  for (const EgoRun* run : runs) {
    figures.kilometers += run->kilometers;
    figures.minutes += run->minutes;
    figures.contacts += run->contacts.size();
    figures.near_misses += run->near_misses;
    figures.completion_percent += run->completion_percent / static_cast<double>(runs.size());
    figures.driving_score += run->driving_score / static_cast<double>(runs.size());
    standing += run->standing_minutes;
    challenges += static_cast<double>(run->challenges);
    withdrawn += static_cast<double>(run->withdrawn);
    for (const EgoRun::Contact& contact : run->contacts) countContact(*run, contact, figures);
  }
  const auto contacts = static_cast<double>(figures.contacts);
  figures.standing_percent = 100.0 * ratio(standing, figures.minutes);
  if (challenges > 0.0) figures.withdrawn_percent = 100.0 * withdrawn / challenges;
  figures.per_km = ratio(contacts, figures.kilometers);
  figures.per_minute = ratio(contacts, figures.minutes);
  figures.per_km_interval =
      contactInterval(runs, &EgoRun::kilometers, figures.kilometers, figures.contacts, bootstrap);
  figures.per_minute_interval =
      contactInterval(runs, &EgoRun::minutes, figures.minutes, figures.contacts, bootstrap);
  return figures;
}

/// Contacts per km of each ego on seeds of one parity; absent where an ego has no such seed.
std::optional<std::vector<double>> ratesOfParity(const std::map<std::string, Runs>& egos,
                                                 bool odd) {
  std::vector<double> rates;
  for (const auto& [ego, runs] : egos) {
    double contacts = 0.0;
    double kilometers = 0.0;
    for (const EgoRun* run : runs) {
      if ((run->seed.back() - '0') % 2 != (odd ? 1 : 0)) continue;
      contacts += static_cast<double>(run->contacts.size());
      kilometers += run->kilometers;
    }
    if (kilometers <= 0.0) return std::nullopt;
    rates.push_back(contacts / kilometers);
  }
  return rates;
}

/// Chance that a run of `worse` has more contacts than one of `better`; ties count half.
double areaUnderCurve(const Runs& better, const Runs& worse) {
  double wins = 0.0;
  for (const EgoRun* low : better) {
    for (const EgoRun* high : worse) {
      wins += high->contacts.size() > low->contacts.size()    ? 1.0
              : high->contacts.size() == low->contacts.size() ? 0.5
                                                              : 0.0;
    }
  }
  return ratio(wins, static_cast<double>(better.size() * worse.size()));
}

const EgoFigures* findEgo(const EgoRanking& ranking, const std::string& ego) {
  const auto found = std::find_if(ranking.egos.begin(), ranking.egos.end(),
                                  [&](const EgoFigures& figures) { return figures.ego == ego; });
  return found == ranking.egos.end() ? nullptr : &*found;
}

Runs runsOn(const std::set<std::string>& scenarios, const Runs& runs) {
  Runs chosen;
  for (const EgoRun* run : runs) {
    if (scenarios.count(run->scenario) != 0) chosen.push_back(run);
  }
  return chosen;
}

void separate(const std::map<std::string, Runs>& egos, RouteBootstrap& bootstrap,
              EgoRanking& ranking) {
  const auto careful = egos.find(kReferenceFamily.front());
  const auto constant = egos.find(kReferenceFamily.back());
  if (careful == egos.end() || constant == egos.end()) return;
  std::set<std::string> shared = scenariosOf(careful->second);
  const std::set<std::string> others = scenariosOf(constant->second);
  for (auto at = shared.begin(); at != shared.end();)
    at = others.count(*at) == 0 ? shared.erase(at) : std::next(at);
  const RouteSums low = sumsOf(careful->second, &EgoRun::kilometers, shared);
  const RouteSums high = sumsOf(constant->second, &EgoRun::kilometers, shared);
  const auto low_rate = pooledValue(low);
  const auto high_rate = pooledValue(high);
  if (!low_rate || !high_rate) return;
  ranking.separation = *high_rate - *low_rate;
  if (showsIntervals(shared.size()))
    ranking.separation_interval = bootstrap.differenceInterval(low, high);
  ranking.area_under_curve =
      areaUnderCurve(runsOn(shared, careful->second), runsOn(shared, constant->second));
}

/// Neighbors of the reference family that are not in order, or whose intervals overlap.
std::vector<std::string> orderRemarks(const EgoRanking& ranking) {
  std::vector<std::string> remarks;
  const EgoFigures* before = nullptr;
  for (const char* name : kReferenceFamily) {
    const EgoFigures* now = findEgo(ranking, name);
    if (now == nullptr || now->kilometers <= 0.0) continue;
    if (before != nullptr && now->per_km <= before->per_km) {
      remarks.push_back("out of order: " + before->ego + " has " +
                        core::formatFixed(before->per_km, 2) + " contacts per km, " + now->ego +
                        " " + core::formatFixed(now->per_km, 2));
    } else if (before != nullptr && now->per_km_interval.low <= before->per_km_interval.high) {
      remarks.push_back("intervals overlap: " + before->ego + " and " + now->ego);
    }
    before = now;
  }
  return remarks;
}

EgoRanking rankSetting(const std::string& setting, const std::map<std::string, Runs>& egos,
                       RouteBootstrap& bootstrap) {
  EgoRanking ranking;
  ranking.setting = setting;
  for (const auto& [ego, runs] : egos) ranking.egos.push_back(figuresOf(ego, runs, bootstrap));
  std::stable_sort(ranking.egos.begin(), ranking.egos.end(),
                   [](const EgoFigures& left, const EgoFigures& right) {
                     const bool left_stood = left.kilometers <= 0.0;  // no rate: last
                     const bool right_stood = right.kilometers <= 0.0;
                     return left_stood != right_stood ? right_stood : left.per_km < right.per_km;
                   });
  const auto odd = ratesOfParity(egos, true);
  const auto even = ratesOfParity(egos, false);
  if (odd && even) ranking.odd_even = metrics::rankCorrelation(*odd, *even);
  separate(egos, bootstrap, ranking);
  ranking.remarks = orderRemarks(ranking);
  return ranking;
}

}  // namespace

std::vector<EgoRanking> rankEgos(const std::vector<EgoRun>& runs) {
  std::vector<std::string> order;
  std::map<std::string, std::map<std::string, Runs>> settings;
  for (const EgoRun& run : runs) {
    if (settings.count(run.setting) == 0) order.push_back(run.setting);
    settings[run.setting][run.ego].push_back(&run);
  }
  RouteBootstrap bootstrap;
  std::vector<EgoRanking> rankings;
  for (const std::string& setting : order)
    rankings.push_back(rankSetting(setting, settings[setting], bootstrap));
  return rankings;
}

}  // namespace cdiff::evaluation
