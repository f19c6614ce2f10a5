// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <regex>
#include <set>

#include "metrics/figure_definitions.h"
#include "metrics/rift_measures.h"

namespace cdiff::metrics {
namespace {

TEST(FigureDefinitions, HaveUniqueNamesAndPlaces) {
  std::set<std::string> names;
  std::set<std::string> places;
  const std::regex name("[a-z][a-z0-9_]*");
  for (const FigureDefinition& figure : figureDefinitions()) {
    EXPECT_TRUE(std::regex_match(figure.name, name)) << figure.name;
    EXPECT_TRUE(names.insert(figure.name).second) << figure.name;
    EXPECT_TRUE(places.insert(figure.place).second) << figure.place;
    const std::string definition = figure.definition;
    EXPECT_GT(definition.size(), 20U) << figure.name;
    EXPECT_EQ(definition.back(), '.') << figure.name;
    EXPECT_STRNE(figure.label, "") << figure.name;
    EXPECT_EQ(findFigure(figure.name), &figure);
  }
  EXPECT_EQ(findFigure("no_figure"), nullptr);
}

TEST(FigureDefinitions, GiveTheUnitThatTheMeasureHas) {
  SessionMeasures measures;
  measures.rift_compat = RiftMeasures().measures();
  for (const FigureDefinition& figure : figureDefinitions()) {
    if (std::string(figure.place).rfind("/metrics/rift_compat/", 0) != 0) continue;
    EXPECT_EQ(figure.measure(measures).unit, figure.unit) << figure.name;
  }
}

TEST(FigureDefinitions, HoldEveryFigureOfRift) {
  std::set<std::string> defined;
  for (const FigureDefinition& figure : figureDefinitions()) defined.insert(figure.name);
  for (const auto& [key, measure] : RiftMeasures().measures())
    EXPECT_EQ(defined.count("rift_compat_" + key), 1U) << key;
}

TEST(FigureDefinitions, ReadTheirFieldOfTheMeasures) {
  SessionMeasures measures;
  measures.cbv_distance_m = 12.5;
  measures.cbv_collisions = 3;
  measures.ttc_2d_cbv.minimum.value = 0.75;
  EXPECT_EQ(*findFigure("cbv_distance_m")->measure(measures).value, 12.5);
  EXPECT_EQ(*findFigure("cbv_collisions")->measure(measures).value, 3.0);
  EXPECT_EQ(findFigure("cbv_collisions")->measure(measures).unit, "count");
  EXPECT_EQ(*findFigure("ttc_cbv_min_s")->measure(measures).value, 0.75);
  EXPECT_FALSE(findFigure("ttc_min_s")->measure(measures).value.has_value());
}

}  // namespace
}  // namespace cdiff::metrics
