// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "collection/dataset_page.h"

#include <algorithm>
#include <iostream>

#include "core/file.h"
#include "core/text.h"
#include "diffusion/architecture.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/traffic/rollout.h"
#include "page/sample_sheet.h"

namespace cdiff::collection {
namespace {

namespace fs = std::filesystem;
using page::CountRow;

constexpr std::size_t kSamplesAKind = 6;

std::string percent(std::uint64_t part, std::uint64_t whole) {
  if (whole == 0) return "-";
  return core::formatFixed(100.0 * static_cast<double>(part) / static_cast<double>(whole), 1);
}

void addRows(std::vector<CountRow>& rows, const std::string& kind,
             const std::map<std::string, std::uint64_t>& counts, std::uint64_t whole) {
  for (const auto& [name, count] : counts)
    rows.push_back({kind + name, std::to_string(count), percent(count, whole)});
}

std::vector<CountRow> rowsOf(const DatasetStatistics& statistics) {
  const std::uint64_t samples = statistics.samples;
  std::vector<CountRow> rows = {{"images", std::to_string(statistics.images), ""}};
  addRows(rows, "dropped: ", statistics.dropped, statistics.images);
  rows.push_back({"samples", std::to_string(samples), percent(samples, statistics.images)});
  addRows(rows, "maneuver: ", statistics.maneuvers, samples);
  addRows(rows, "stop reason: ", statistics.stop_reasons, samples);
  addRows(rows, "", statistics.kinds, samples);
  for (std::size_t i = 0; i < statistics.speeds.size(); ++i) {
    const bool last = i + 1 == statistics.speeds.size();
    const std::string range = last ? " and more" : " to " + std::to_string(2 * i + 2);
    rows.push_back({"speed " + std::to_string(2 * i) + range + " m/s",
                    std::to_string(statistics.speeds[i]), percent(statistics.speeds[i], samples)});
  }
  const auto divisor = static_cast<double>(std::max<std::uint64_t>(1, samples));
  rows.push_back(
      {"mean of absolute steer", core::formatFixed(statistics.steer_sum / divisor, 4), ""});
  rows.push_back({"contacts of driven vehicles", std::to_string(statistics.contacts), ""});
  rows.push_back({"simulated seconds", core::formatFixed(statistics.seconds, 0), ""});
  return rows;
}

/// "12 images, left out: session_end 12", and what helps where most lie too near the end.
std::string lossText(const DatasetStatistics& statistics, const std::string& remedy) {
  std::string text = std::to_string(statistics.images) + " images";
  std::string main_reason;
  std::uint64_t most = 0;
  for (const auto& [reason, count] : statistics.dropped) {
    text += (most == 0 ? ", left out: " : ", ") + reason + " " + std::to_string(count);
    if (count > most) main_reason = reason;
    most = std::max(most, count);
  }
  if (!main_reason.empty() && main_reason != "session_end") return text;
  const double horizon =
      traffic::kRolloutStep * static_cast<double>(diffusion::Architecture{}.horizon);
  return text + "; a sample needs " + core::formatNumber(horizon) +
         " s of driving after its image, so " + remedy + " are needed";
}

}  // namespace

void requireSamples(const StatisticsByName& statistics, const std::string& kind,
                    const std::string& remedy) {
  const DatasetStatistics sum = sumOf(statistics);
  if (sum.samples == 0)
    throw core::InputError("no " + kind + " gave a sample: " + lossText(sum, remedy));
  for (const auto& [name, of_one] : statistics) {
    if (of_one.samples == 0)
      std::cerr << kind << " " << name << " gave no sample: " << lossText(of_one, remedy) << "\n";
  }
}

void describeDataset(const fs::path& folder, const DatasetStatistics& statistics) {
  core::writeFileAtomically(folder / "statistics.json", toJson(statistics));
  const std::vector<CountRow> rows = rowsOf(statistics);
  std::cout << "| | number | % |\n|---|---|---|\n";
  for (const CountRow& row : rows)
    std::cout << "| " << row.name << " | " << row.number << " | " << row.share << " |\n";
  std::cout << std::flush;
  if (statistics.samples == 0) return;
  const fs::path page = folder / "samples.html";
  const std::string title = fs::weakly_canonical(folder).filename().string();
  const learning::Dataset stored(folder / "shards", 0.0);
  const learning::DrivingDataset dataset(stored);
  core::writeFileAtomically(page, page::sampleSheet(title, rows, dataset, kSamplesAKind));
  std::cerr << "pictures: " << page.string() << "\n";
}

}  // namespace cdiff::collection
