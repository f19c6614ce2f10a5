// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <stdexcept>

#include "e2e_cdiff/core/exceptions.h"
#include "metrics/metric_registry.h"
#include "metrics/session_metrics.h"
#include "metrics/straight_road.h"

namespace cdiff::metrics {
namespace {

constexpr MeasureDefinition kTicks = {
    "test_ticks",       "", "Ticks", "count", Direction::kNeither, Subject::kEgo,
    "Number of ticks.", "", 0,
};

/// Counts ticks; reports `measure`.
class Ticks final : public Metric {
 public:
  explicit Ticks(const MeasureDefinition& row) : definition_(row) {}
  void observe(const MetricTick&) override { ++ticks_; }
  void report(MetricSink& sink) const override {
    sink.set(definition_, {static_cast<double>(ticks_), ticks_, "furlongs", ""});
  }

 private:
  const MeasureDefinition& definition_;
  std::size_t ticks_ = 0;
};

MetricDescriptor ticksMetric(const std::string& source) {
  return {"test_ticks",
          "Counts ticks.",
          {kTicks},
          [](const MetricContext&) { return std::make_unique<Ticks>(kTicks); },
          source};
}

std::string list_place;  ///< of the list that `Lister` reports

/// Reports nothing but a list.
class Lister final : public Metric {
 public:
  void observe(const MetricTick&) override {}
  void report(MetricSink& sink) const override { sink.setList(list_place, {}); }
};

/// The registration below stays for the program's life: each test that needs it calls this.
void registerOnce() {
  if (findMeasure(kTicks.name) == nullptr) registerMetric(ticksMetric("ticks_plugin.so"));
}

std::string refusalOf(const MetricDescriptor& descriptor) {
  try {
    registerMetric(descriptor);
  } catch (const core::InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MeasureDefinitions, HaveUniqueNamesAndPlaces) {
  std::set<std::string> names;
  std::set<std::string> places;
  const std::regex name("[a-z][a-z0-9_]*");
  for (const MeasureDefinition& row : measureDefinitions()) {
    EXPECT_TRUE(std::regex_match(row.name, name)) << row.name;
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    EXPECT_TRUE(places.insert(row.place).second) << row.place;
    const std::string definition = row.definition;
    EXPECT_GT(definition.size(), 15U) << row.name;
    EXPECT_EQ(definition.back(), '.') << row.name;
    EXPECT_STRNE(row.label, "") << row.name;
    EXPECT_EQ(findMeasure(row.name), &row);
  }
  EXPECT_EQ(findMeasure("no_measure"), nullptr);
}

TEST(MeasureDefinitions, AreAllReportedByTheirMetrics) {
  const test::StraightRoad road;
  const SessionMeasures measures = SessionMetrics({}, road.drivable_area, road.route).measures();
  for (const MeasureDefinition& row : measureDefinitions()) {
    const Measure measure = measures.at(row);
    EXPECT_NE(measure.reason, "not computed") << row.name;
    EXPECT_EQ(measure.unit, row.unit) << row.name;
    EXPECT_EQ(measure.value.has_value(), measure.reason.empty()) << row.name;
  }
}

TEST(MeasureDefinitions, OfAGroupAreInTheOrderOfTheirNames) {
  std::vector<std::string> names;
  for (const MeasureDefinition& row : measureDefinitions()) {
    if (std::string(row.place).rfind("/metrics/rift_compat/", 0) == 0) names.emplace_back(row.name);
  }
  EXPECT_EQ(names.size(), 17U);
  EXPECT_TRUE(std::is_sorted(names.begin(), names.end()));
}

TEST(MetricRegistry, MeasuresWhatAPluginRegisters) {
  registerOnce();
  ASSERT_NE(findMeasure("test_ticks"), nullptr);
  EXPECT_STREQ(findMeasure("test_ticks")->place, "/metrics/test_ticks/value");
  const test::StraightRoad road;
  SessionMetrics metrics({}, road.drivable_area, road.route);
  for (std::uint64_t tick = 0; tick < 3; ++tick)
    metrics.observe(test::snapshot(tick, {test::ego(0, 0, 5)}), nullptr);
  EXPECT_EQ(*metrics.measures().at("test_ticks").value, 3.0);
  EXPECT_EQ(metrics.measures().at("test_ticks").unit, "count");
}

/// Throws at its third tick, or when it reports.
class Thrower final : public Metric {
 public:
  explicit Thrower(bool in_report) : in_report_(in_report) {}
  void observe(const MetricTick&) override {
    if (!in_report_ && ++ticks_ == 3) throw std::runtime_error("no third tick was expected");
  }
  void report(MetricSink&) const override {
    if (in_report_) throw 7;
  }

 private:
  bool in_report_;
  int ticks_ = 0;
};

constexpr MeasureDefinition kThrown = {
    "test_thrown", "", "Thrown", "m", Direction::kNeither, Subject::kEgo, "Has no value.", "", 0,
};

TEST(MetricRegistry, LeavesOutAMetricThatThrowsAndNamesItsPlugin) {
  static bool in_report = false;
  registerMetric({"test_thrown",
                  "Throws.",
                  {kThrown},
                  [](const MetricContext&) { return std::make_unique<Thrower>(in_report); },
                  "thrower_plugin.so"});
  const test::StraightRoad road;
  for (const bool now : {false, true}) {
    in_report = now;
    SessionMetrics metrics({}, road.drivable_area, road.route);
    // 1 m a tick of 0.05 s: the ego is at 4 m after five of them.
    for (std::uint64_t tick = 0; tick < 5; ++tick)
      metrics.observe(test::snapshot(tick, {test::ego(static_cast<double>(tick), 0, 20)}), nullptr);
    const SessionMeasures measures = metrics.measures();
    EXPECT_NEAR(*measures.at("ego_completion_percent").value, 4.0, 1e-9);  // of 100 m
    ASSERT_EQ(measures.faults.size(), 1U);
    const traffic::Fault& fault = measures.faults.front();
    EXPECT_EQ(fault.tick, in_report ? 4U : 2U);
    EXPECT_EQ(fault.source, "metric:test_thrown");
    EXPECT_EQ(fault.text.rfind(in_report ? "report() of metric 'test_thrown' of thrower_plugin.so "
                                           "threw: an exception of an unknown type"
                                         : "observe() of metric 'test_thrown' of thrower_plugin.so "
                                           "threw: no third tick was expected",
                               0),
              0U)
        << fault.text;
    EXPECT_FALSE(measures.at(kThrown).value);
    EXPECT_EQ(measures.at(kThrown).reason, fault.text);
    in_report = false;
  }
}

TEST(MetricRegistry, NamesBothSourcesOfANameThatIsTaken) {
  registerOnce();
  const std::string same = refusalOf(ticksMetric("other_plugin.so"));
  EXPECT_NE(same.find("metric 'test_ticks'"), std::string::npos) << same;
  EXPECT_NE(same.find("ticks_plugin.so"), std::string::npos) << same;
  EXPECT_NE(same.find("other_plugin.so"), std::string::npos) << same;
  MetricDescriptor shipped = ticksMetric("other_plugin.so");
  shipped.name = "my_collisions";
  shipped.measures.front().name = "ego_collisions";
  const std::string refusal = refusalOf(shipped);
  EXPECT_NE(refusal.find("measure 'ego_collisions'"), std::string::npos) << refusal;
  EXPECT_NE(refusal.find("e2e_cdiff"), std::string::npos) << refusal;
  shipped.measures.front().name = "my_collisions";
  shipped.measures.front().place = "/ego/collisions";
  EXPECT_NE(refusalOf(shipped).find("measure 'my_collisions'"), std::string::npos);
  EXPECT_EQ(findMeasure("my_collisions"), nullptr);
  // A place that another measure has by default, of another metric and of the same.
  shipped.measures.front().place = "/metrics/test_ticks/value";
  EXPECT_NE(refusalOf(shipped).find("measure 'my_collisions'"), std::string::npos);
  shipped.measures.front().place = "";
  shipped.measures.push_back(shipped.measures.front());
  shipped.measures.back().name = "your_collisions";
  shipped.measures.back().place = "/metrics/my_collisions/value";
  EXPECT_NE(refusalOf(shipped).find("measure 'your_collisions'"), std::string::npos);
}

TEST(MetricRegistry, RefusesADescriptorThatLacksSomething) {
  MetricDescriptor descriptor = ticksMetric("a_plugin.so");
  descriptor.name = "other_ticks";
  descriptor.measures.clear();
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
    descriptor.measures.front().name = name;
    EXPECT_NE(refusalOf(descriptor).find("must be snake_case"), std::string::npos) << name;
  }
  descriptor.measures.front().name = "other_ticks";
  for (const char* place : {"ticks", "/ticks/other", "/ego", "/ego/", "ego/ticks", "/"}) {
    descriptor.measures.front().place = place;
    EXPECT_NE(refusalOf(descriptor).find("must lie below"), std::string::npos) << place;
  }
  EXPECT_EQ(findMeasure("other_ticks"), nullptr);
}

TEST(MetricRegistry, RefusesAListThatFitsNowhereInTheSummary) {
  static constexpr MeasureDefinition kOwn = {
      "test_lists", "", "Lists", "", Direction::kNeither, Subject::kEgo, "A measure.", "", 4,
  };
  registerMetric({"test_lister",
                  "Reports a list.",
                  {kOwn},
                  [](const MetricContext&) { return std::make_unique<Lister>(); },
                  "lister.so"});
  const test::StraightRoad road;
  for (const char* place :
       {"", "/", "/cbv", "/cbv/", "/nowhere/list", "/cbv/list/below", "/ego/collisions"}) {
    list_place = place;
    const SessionMeasures measures = SessionMetrics({}, road.drivable_area, road.route).measures();
    ASSERT_EQ(measures.faults.size(), 1U) << place;
    EXPECT_EQ(measures.faults.front().source, "metric:test_lister");
    EXPECT_EQ(measures.lists.count(place), 0U);
  }
  list_place = "/cbv/test_list";
  const SessionMeasures measures = SessionMetrics({}, road.drivable_area, road.route).measures();
  EXPECT_TRUE(measures.faults.empty());
  EXPECT_EQ(measures.lists.count(list_place), 1U);
}

// Last: from here on every session has a metric that reports a measure of another one.
TEST(MetricRegistryWithAMistake, NamesAMetricThatReportsWhatIsNotIts) {
  static constexpr MeasureDefinition kOwn = {
      "test_own", "", "Own", "", Direction::kNeither, Subject::kEgo, "A measure.", "", 3,
  };
  static const MeasureDefinition other = *findMeasure("ego_collisions");
  registerMetric({"test_mistake",
                  "Reports a measure of another metric.",
                  {kOwn},
                  [](const MetricContext&) { return std::make_unique<Ticks>(other); },
                  "mistake.so"});
  const test::StraightRoad road;
  const SessionMeasures measures = SessionMetrics({}, road.drivable_area, road.route).measures();
  ASSERT_EQ(measures.faults.size(), 1U);
  EXPECT_NE(measures.faults.front().text.find(
                "metric 'test_mistake' of mistake.so reports 'ego_collisions', which is not among "
                "its measures"),
            std::string::npos)
      << measures.faults.front().text;
  EXPECT_EQ(measures.at(kOwn).reason, measures.faults.front().text);
  EXPECT_EQ(measures.at(other).value, 0.0);  // of the metric that has it
}

}  // namespace
}  // namespace cdiff::metrics
