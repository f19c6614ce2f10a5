// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

constexpr FigureDefinition kTicks = {
    "test_ticks",       "", "Ticks", "count", Direction::kNeither, Subject::kEgo,
    "Number of ticks.", "", 0,
};

/// Counts ticks; reports `figure`.
class Ticks final : public Metric {
 public:
  explicit Ticks(const FigureDefinition& figure) : figure_(figure) {}
  void observe(const MetricTick&) override { ++ticks_; }
  void report(MetricSink& sink) const override {
    sink.set(figure_, {static_cast<double>(ticks_), ticks_, "furlongs", ""});
  }

 private:
  const FigureDefinition& figure_;
  std::size_t ticks_ = 0;
};

MetricDescriptor ticksMetric(const std::string& source) {
  return {"test_ticks",
          "Counts ticks.",
          {kTicks},
          [](const MetricContext&) { return std::make_unique<Ticks>(kTicks); },
          source};
}

/// The registration below stays for the program's life: each test that needs it calls this.
void registerOnce() {
  if (findFigure(kTicks.name) == nullptr) registerMetric(ticksMetric("ticks_plugin.so"));
}

std::string refusalOf(const MetricDescriptor& descriptor) {
  try {
    registerMetric(descriptor);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FigureDefinitions, HaveUniqueNamesAndPlaces) {
  std::set<std::string> names;
  std::set<std::string> places;
  const std::regex name("[a-z][a-z0-9_]*");
  for (const FigureDefinition& figure : figureDefinitions()) {
    EXPECT_TRUE(std::regex_match(figure.name, name)) << figure.name;
    EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
    EXPECT_TRUE(places.insert(figure.place).second) << figure.place;
    const std::string definition = figure.definition;
    EXPECT_GT(definition.size(), 15U) << figure.name;
    EXPECT_EQ(definition.back(), '.') << figure.name;
    EXPECT_STRNE(figure.label, "") << figure.name;
    EXPECT_EQ(findFigure(figure.name), &figure);
  }
  EXPECT_EQ(findFigure("no_figure"), nullptr);
}

TEST(FigureDefinitions, AreAllReportedByTheirMetrics) {
  const test::StraightRoad road;
  const SessionMeasures measures = SessionMetrics({}, road.drivable_area, road.route).measures();
  for (const FigureDefinition& figure : figureDefinitions()) {
    const Measure measure = measures.at(figure);
    EXPECT_NE(measure.reason, "not computed") << figure.name;
    EXPECT_EQ(measure.unit, figure.unit) << figure.name;
    EXPECT_EQ(measure.value.has_value(), measure.reason.empty()) << figure.name;
  }
}

TEST(FigureDefinitions, OfAGroupAreInTheOrderOfTheirNames) {
  std::vector<std::string> names;
  for (const FigureDefinition& figure : figureDefinitions()) {
    if (std::string(figure.place).rfind("/metrics/rift_compat/", 0) == 0)
      names.emplace_back(figure.name);
  }
  EXPECT_EQ(names.size(), 17U);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(MetricRegistry, MeasuresWhatAPluginRegisters) {
  registerOnce();
  ASSERT_NE(findFigure("test_ticks"), nullptr);
  EXPECT_STREQ(findFigure("test_ticks")->place, "/metrics/test_ticks/value");
  const test::StraightRoad road;
  SessionMetrics metrics({}, road.drivable_area, road.route);
  for (std::uint64_t tick = 0; tick < 3; ++tick)
    metrics.observe(test::snapshot(tick, {test::ego(0, 0, 5)}), nullptr);
  EXPECT_EQ(*metrics.measures().at("test_ticks").value, 3.0);
  EXPECT_EQ(metrics.measures().at("test_ticks").unit, "count");
}

TEST(MetricRegistry, NamesBothSourcesOfANameThatIsTaken) {
  registerOnce();
  const std::string same = refusalOf(ticksMetric("other_plugin.so"));
  EXPECT_NE(same.find("metric 'test_ticks'"), std::string::npos) << same;
  EXPECT_NE(same.find("ticks_plugin.so"), std::string::npos) << same;
  EXPECT_NE(same.find("other_plugin.so"), std::string::npos) << same;
  MetricDescriptor shipped = ticksMetric("other_plugin.so");
  shipped.name = "my_collisions";
  shipped.figures.front().name = "ego_collisions";
  const std::string figure = refusalOf(shipped);
  EXPECT_NE(figure.find("figure 'ego_collisions'"), std::string::npos) << figure;
  EXPECT_NE(figure.find("e2e_cdiff"), std::string::npos) << figure;
  shipped.figures.front().name = "my_collisions";
  shipped.figures.front().place = "/ego/collisions";
  EXPECT_NE(refusalOf(shipped).find("figure 'my_collisions'"), std::string::npos);
  EXPECT_EQ(findFigure("my_collisions"), nullptr);
}

TEST(MetricRegistry, RefusesADescriptorThatLacksSomething) {
  MetricDescriptor descriptor = ticksMetric("a_plugin.so");
  descriptor.name = "other_ticks";
  descriptor.figures.clear();
  EXPECT_NE(refusalOf(descriptor).find("a_plugin.so lacks"), std::string::npos);
  descriptor = ticksMetric("a_plugin.so");
  descriptor.name = "other_ticks";
  descriptor.make = nullptr;
  EXPECT_NE(refusalOf(descriptor).find("a_plugin.so lacks"), std::string::npos);
}

TEST(MetricRegistry, RefusesNamesAndPlacesThatNoFileCouldHold) {
  MetricDescriptor descriptor = ticksMetric("a_plugin.so");
  descriptor.name = "other_ticks";
  for (const char* name : {"", "Other ticks", "other/ticks", "_x"}) {
    descriptor.figures.front().name = name;
    EXPECT_NE(refusalOf(descriptor).find("must be snake_case"), std::string::npos) << name;
  }
  descriptor.figures.front().name = "other_ticks";
  for (const char* place : {"ticks", "/ticks/other", "/ego", "/ego/", "ego/ticks", "/"}) {
    descriptor.figures.front().place = place;
    EXPECT_NE(refusalOf(descriptor).find("must lie below"), std::string::npos) << place;
  }
  EXPECT_EQ(findFigure("other_ticks"), nullptr);
}

// Last: from here on every session has a metric that reports a figure of another one.
TEST(MetricRegistryWithAMistake, NamesAMetricThatReportsWhatIsNotIts) {
  static constexpr FigureDefinition kOwn = {
      "test_own", "", "Own", "", Direction::kNeither, Subject::kEgo, "A figure.", "", 3,
  };
  static const FigureDefinition other = *findFigure("ego_collisions");
  registerMetric({"test_mistake",
                  "Reports a figure of another metric.",
                  {kOwn},
                  [](const MetricContext&) { return std::make_unique<Ticks>(other); },
                  "mistake.so"});
  const test::StraightRoad road;
  const SessionMetrics metrics({}, road.drivable_area, road.route);
  try {
    metrics.measures();
    FAIL();
  } catch (const core::Error& error) {
    EXPECT_STREQ(error.what(),
                 "metric 'test_mistake' of mistake.so reports 'ego_collisions', which is not among "
                 "its figures");
  }
}

}  // namespace
}  // namespace cdiff::metrics
