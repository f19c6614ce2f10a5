// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A measure's name and place stand as strings in its metric's file alone, so that a metric is in
/// one file.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>

#include "core/file.h"
#include "metrics/metric_registry.h"

namespace cdiff::metrics {
namespace {

namespace fs = std::filesystem;

/// Strings that mean another thing than the measure of the same name, by file.
const std::set<std::pair<std::string, std::string>> kOtherMeanings = {
    {"record/summary.cpp", "cbv_distance_m"},   // of a CBV to its conflict point
    {"record/summary.cpp", "ego_distance_m"}};  // of the ego likewise

/// Texts of sources by path below their folder.
using Sources = std::map<std::string, std::string>;

Sources sourcesBelow(const fs::path& folder) {
  Sources sources;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (kind != ".cpp" && kind != ".h") continue;
    sources[fs::relative(entry.path(), folder).string()] = core::readFile(entry.path(), "source");
  }
  return sources;
}

/// The files with a string of exactly this text.
std::vector<std::string> filesWith(const Sources& sources, const std::string& text) {
  std::vector<std::string> files;
  for (const auto& [path, content] : sources) {
    if (content.find('"' + text + '"') == std::string::npos) continue;
    if (kOtherMeanings.count({path, text}) == 0) files.push_back(path);
  }
  return files;
}

/// The files with the key, which must be a metric's.
std::vector<std::string> metricFilesWith(const Sources& sources, const std::string& key) {
  const std::vector<std::string> files = filesWith(sources, key);
  for (const std::string& file : files) {
    EXPECT_EQ(file.rfind("metrics/", 0), 0U) << key << " stands in " << file;
    EXPECT_NE(file.find("_metric"), std::string::npos) << key << " stands in " << file;
  }
  return files;
}

/// The place that the registry fills in where a measure spells none.
std::string defaultPlace(const MeasureDefinition& definition) {
  return "/metrics/" + std::string(definition.name) + "/value";
}

TEST(MetricKeys, StandInTheFileOfTheirMetricAlone) {
  const Sources sources = sourcesBelow(fs::path(CDIFF_SOURCE_FOLDER) / "src");
  ASSERT_GT(sources.size(), 100U);
  std::size_t spelt_places = 0;
  for (const MetricDescriptor& metric : metricDescriptors()) {
    for (const MeasureDefinition& definition : metric.measures) {
      const auto named = metricFilesWith(sources, definition.name);
      EXPECT_EQ(named.size(), 1U) << definition.name << ": " << ::testing::PrintToString(named);
      const auto placed = metricFilesWith(sources, definition.place);
      spelt_places += placed.size();
      if (definition.place == defaultPlace(definition) && placed.empty()) continue;
      EXPECT_EQ(placed, named) << definition.place;
    }
  }
  EXPECT_GT(spelt_places, 20U);
}

// None for counts, one for the shares of the 2D-TTC by partner, else three.
TEST(MetricKeys, DecimalsFollowFromTheUnit) {
  const std::set<std::string> shares = {"ttc_cbv_share_percent", "ttc_background_share_percent",
                                        "ttc_following_percent", "ttc_following_cbv_percent"};
  for (const MetricDescriptor& metric : metricDescriptors()) {
    for (const MeasureDefinition& measure : metric.measures) {
      const int wanted = measure.unit == std::string("count") ? 0
                         : shares.count(measure.name)         ? 1
                                                              : 3;
      EXPECT_EQ(measure.decimals, wanted) << measure.name;
    }
  }
}

TEST(MetricKeys, AreFoundInEveryFileThatSpellsThem) {
  const Sources sources = {{"a.cpp", "x = \"cbv_count\";"},
                           {"b.cpp", "// as cbv_count\ny = \"cbv_counts\";"},
                           {"record/summary.cpp", "{\"cbv_distance_m\", \"cbv_count\"}"}};
  EXPECT_EQ(filesWith(sources, "cbv_count"),
            (std::vector<std::string>{"a.cpp", "record/summary.cpp"}));
  EXPECT_TRUE(filesWith(sources, "cbv_distance_m").empty());
}

}  // namespace
}  // namespace cdiff::metrics
