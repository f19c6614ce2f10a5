// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/text.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/ttc_2d.h"
#include "metrics/reference_data.h"

#define SKIP_WITHOUT(path) \
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "missing: " << path

namespace cdiff::metrics {
namespace {

/// Cells x y vx vy hx hy length width, from the given one on.
MovingBox boxAt(const std::vector<double>& cells, std::size_t first) {
  MovingBox moving;
  moving.box.center = {cells[first], cells[first + 1]};
  moving.velocity = {cells[first + 2], cells[first + 3]};
  moving.box.heading = std::atan2(cells[first + 5], cells[first + 4]);
  moving.box.length = cells[first + 6];
  moving.box.width = cells[first + 7];
  return moving;
}

TEST(ReferenceData, TimeToCollisionOf900Pairs) {
  const auto path = test::referenceFile("ttc_2d.csv");
  SKIP_WITHOUT(path);
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::size_t pairs = 0;
  double largest = 0.0;
  while (std::getline(file, line)) {
    std::vector<double> cells;
    std::stringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(std::stod(cell));
    ASSERT_EQ(cells.size(), 17U);
    const auto time = timeToCollision2d(boxAt(cells, 0), boxAt(cells, 8));
    ++pairs;
    ASSERT_EQ(time.has_value(), std::isfinite(cells[16])) << "pair " << pairs;
    if (time) largest = std::max(largest, std::abs(*time - cells[16]));
  }
  EXPECT_EQ(pairs, 900U);
  EXPECT_LT(largest, 1e-4);
  RecordProperty("largest_difference_s", core::formatNumber(largest));
}

TEST(ReferenceData, ShapiroWilk) {
  const auto path = test::referenceFile("shapiro_wilk.json");
  SKIP_WITHOUT(path);
  const auto cases = nlohmann::json::parse(std::ifstream(path))["cases"];
  ASSERT_FALSE(cases.empty());
  for (const auto& entry : cases) {
    const auto test = shapiroWilk(entry["x"].get<std::vector<double>>());
    // The reference computes W in single precision: off by up to 3e-5 for large tied samples.
    const bool large_and_tied = entry["kind"] == "ties" && entry["n"] >= 3000;
    EXPECT_NEAR(*test.w, entry["W"].get<double>(), large_and_tied ? 3e-5 : 1e-6) << entry["kind"];
    EXPECT_NEAR(*test.p, entry["p"].get<double>(), 1e-4) << entry["kind"];
  }
}

TEST(ReferenceData, Wasserstein) {
  const auto path = test::referenceFile("wasserstein.json");
  SKIP_WITHOUT(path);
  const auto cases = nlohmann::json::parse(std::ifstream(path))["cases"];
  ASSERT_FALSE(cases.empty());
  for (const auto& entry : cases) {
    const auto distance = wassersteinDistance(entry["a"].get<std::vector<double>>(),
                                              entry["b"].get<std::vector<double>>());
    EXPECT_NEAR(*distance, entry["wasserstein"].get<double>(), 1e-9);
  }
}

}  // namespace
}  // namespace cdiff::metrics
