// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// A metric that a plug-in registers, by the public headers alone, is in everything that a session
/// and a batch write.
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "e2e_cdiff/metrics/metric.h"
#include "evaluation/run_record.h"
#include "metrics/metric_registry.h"
#include "page/result_writer.h"
#include "record/seen_session.h"

namespace cdiff::evaluation {
namespace {

constexpr metrics::MeasureDefinition kDecisions = {
    "my_decisions",
    "",
    "Decisions that I count",
    "count",
    metrics::Direction::kNeither,
    metrics::Subject::kEgo,
    "Number of decision ticks.",
    "",
    0,
};
constexpr metrics::MeasureDefinition kActions = {
    "my_actions",
    "/cbv/my_actions",
    "Actions that I count",
    "count",
    metrics::Direction::kNeither,
    metrics::Subject::kCbvs,
    "Number of actions of CBVs.",
    "",
    0,
};

class MyMetric final : public metrics::Metric {
 public:
  void observe(const metrics::MetricTick& tick) override {
    if (tick.snapshot.decision_tick) ++decisions_;
    for (const metrics::CbvSighting& cbv : tick.cbvs)
      actions_ += cbv.vehicle->applied_action.has_value();
  }
  void report(metrics::MetricSink& sink) const override {
    sink.set(kDecisions, {static_cast<double>(decisions_), decisions_, {}, {}});
    sink.set(kActions, {static_cast<double>(actions_), actions_, {}, {}});
  }

 private:
  std::size_t decisions_ = 0;
  std::size_t actions_ = 0;
};

TEST(RegisteredMetric, IsInEveryFileOfSessionsAndBatches) {
  metrics::registerMetric(
      {"my_metric",
       "Counts decisions and actions.",
       {kDecisions, kActions},
       [](const metrics::MetricContext&) { return std::make_unique<MyMetric>(); },
       "my_plugin.so"});
  const test::TemporaryFolder scratch;
  const test::SampleSetup sample;
  page::ResultWriter writer(sample.setup, test::sampleFacts(), scratch.path());
  test::playSession(writer, sample.setup, 120, traffic::SessionStatus::kTimedOut);
  writer.finish(2.0);
  const std::string text = core::readFile(scratch.path() / "summary.json", "summary");
  const nlohmann::json summary = nlohmann::json::parse(text);
  // Ticks 0 to 120; every second one is a decision.
  EXPECT_EQ(summary["metrics"]["my_decisions"]["value"], 61.0);
  EXPECT_TRUE(summary["cbv"]["my_actions"].is_number_unsigned());
  const std::string report = core::readFile(scratch.path() / "report.html", "report");
  EXPECT_NE(report.find("Decisions that I count"), std::string::npos);
  EXPECT_NE(metrics::measureList().find("### `my_actions`"), std::string::npos);
  const auto& columns = measureNames();  // of runs.csv
  EXPECT_EQ(std::count(columns.begin(), columns.end(), "my_decisions"), 1);
  EXPECT_EQ(readSummary(text, "summary.json").measures.at("my_decisions"), 61.0);
}

}  // namespace
}  // namespace cdiff::evaluation
