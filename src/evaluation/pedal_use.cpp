// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "evaluation/pedal_use.h"

#include <algorithm>
#include <set>

#include "core/file.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/run_record.h"

namespace cdiff::evaluation {
namespace {

namespace fs = std::filesystem;
using dynamics::BicycleModel;
using dynamics::PedalUse;

/// In the order of the table, with what each is called there.
constexpr std::array<std::pair<PedalUse, const char*>, 4> kUses = {
    {{PedalUse::kBraking, "brake"},
     {PedalUse::kCoasting, "coasting: throttle below 0.3, or 0"},
     {PedalUse::kNotch, "notch: throttle from 0.3 up that brakes"},
     {PedalUse::kDriving, "above: throttle that drives"}}};

}  // namespace

void PedalCounts::addTick(double speed, const traffic::ControlAction& action) {
  Use& use = uses_[dynamics::pedalUse(model_, speed, action)];
  ++use.ticks;
  ++ticks_;
  use.acceleration_sum += (model_.nextSpeed(speed, action) - speed) / BicycleModel::kTick;
  if (action.brake > 0.0) return;
  const auto bin = static_cast<std::size_t>(action.throttle * kThrottleBins);
  ++throttles_[std::min(bin, kThrottleBins - 1)];
}

/// The action of a row is the one that led to its state.
void PedalCounts::add(const std::vector<record::TraceRow>& rows) {
  std::map<std::string, const record::TraceRow*> before;
  for (const record::TraceRow& row : rows) {
    const record::TraceRow*& last = before[row.id];
    const bool driven = row.role == traffic::VehicleRole::kCbv && row.action;
    if (driven && last != nullptr && last->tick + 1 == row.tick) addTick(last->speed, *row.action);
    last = &row;
  }
}

std::size_t PedalCounts::count(PedalUse use) const {
  const auto found = uses_.find(use);
  return found == uses_.end() ? 0 : found->second.ticks;
}

double PedalCounts::meanAcceleration(PedalUse use) const {
  const auto found = uses_.find(use);
  if (found == uses_.end()) return 0.0;
  return found->second.acceleration_sum / static_cast<double>(found->second.ticks);
}

namespace {

/// Factors with more than one level, but those that every table pools.
std::vector<std::string> pooledFactors(const std::vector<BatchRun>& runs) {
  std::vector<std::string> names;
  for (const std::string& name : factorNames()) {
    if (name == "scenario" || name == "seed" || name == "repetition") continue;
    std::set<std::string> levels;
    for (const BatchRun& run : runs) levels.insert(run.record.factors.at(name));
    if (levels.size() > 1) names.push_back(name);
  }
  return names;
}

std::map<std::string, PedalCounts> countsOfBatch(const fs::path& results) {
  const std::vector<BatchRun> runs = readBatchRuns(results);
  const std::vector<std::string> factors = pooledFactors(runs);
  std::map<std::string, PedalCounts> counts;
  for (const BatchRun& run : runs) {
    if (!run.record.complete()) continue;
    std::vector<std::string> levels;
    for (const std::string& factor : factors) levels.push_back(run.record.factors.at(factor));
    counts[factors.empty() ? "all runs" : core::joinText(levels, ", ")].add(
        record::readTrace(run.folder / "trace.csv"));
  }
  if (counts.empty()) {
    throw core::InputError("'" + results.string() + "' holds no complete run; run the evaluation");
  }
  return counts;
}

/// "12.3 %".
std::string shareText(std::size_t part, std::size_t whole) {
  if (whole == 0) return "-";
  return core::formatFixed(100.0 * static_cast<double>(part) / static_cast<double>(whole), 1) +
         " %";
}

std::string binText(std::size_t bin) {
  constexpr double kWidth = 1.0 / static_cast<double>(kThrottleBins);
  return core::formatFixed(static_cast<double>(bin) * kWidth, 2) + " to " +
         core::formatFixed(static_cast<double>(bin + 1) * kWidth, 2);
}

/// A line of a table: the first cell, then one for each entry of `counts`.
template <class Cell>
std::string tableLine(const std::string& head, const std::map<std::string, PedalCounts>& counts,
                      Cell&& cell) {
  std::string line = "| " + head + " |";
  for (const auto& [name, entry] : counts) line += " " + cell(name, entry) + " |";
  return line + "\n";
}

}  // namespace

std::map<std::string, PedalCounts> pedalCounts(const fs::path& results) {
  if (core::isFile(results / "matrix.yaml")) return countsOfBatch(results);
  const fs::path session = results / "session.yaml";
  const fs::path trace = results / "trace.csv";
  if (!core::isFile(session) || !core::isFile(trace)) {
    throw core::InputError("'" + results.string() +
                           "' is neither the result of a session (session.yaml, trace.csv) nor of "
                           "an evaluation (matrix.yaml)");
  }
  std::map<std::string, PedalCounts> counts;
  counts[results.filename().string()].add(record::readTrace(trace));
  return counts;
}

std::string pedalMarkdown(const std::map<std::string, PedalCounts>& counts) {
  const auto name = [](const std::string& label, const PedalCounts&) { return label; };
  const auto rule = [](const std::string&, const PedalCounts&) { return std::string("---"); };
  std::string text = tableLine("pedals of CBVs", counts, name) + tableLine("---", counts, rule) +
                     tableLine("ticks", counts, [](const std::string&, const PedalCounts& entry) {
                       return std::to_string(entry.ticks());
                     });
  for (const auto& [use, title] : kUses) {
    text += tableLine(title, counts, [use = use](const std::string&, const PedalCounts& entry) {
      return shareText(entry.count(use), entry.ticks()) + " (" +
             core::formatFixed(entry.meanAcceleration(use), 2) + " m/s^2)";
    });
  }
  text += "\n" + tableLine("throttle without brake", counts, name) + tableLine("---", counts, rule);
  for (std::size_t bin = 0; bin < kThrottleBins; ++bin) {
    text += tableLine(binText(bin), counts, [bin](const std::string&, const PedalCounts& entry) {
      return shareText(entry.throttles()[bin], entry.ticks());
    });
  }
  return text;
}

}  // namespace cdiff::evaluation
