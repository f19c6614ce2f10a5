// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <pugixml.hpp>
#include <set>

#include "map/route_source.h"
#include "page/pictures/edge_map.h"
#include "support/error_text.h"
#include "support/network_text.h"

namespace cdiff::page {
namespace {

/// Texts of the elements <text> of a picture, without their tool tips.
std::multiset<std::string> textsOf(const std::string& svg) {
  pugi::xml_document document;
  EXPECT_TRUE(document.load_string(svg.c_str()));
  std::multiset<std::string> texts;
  for (const pugi::xpath_node& found : document.select_nodes("//text"))
    texts.insert(found.node().text().get());
  return texts;
}

map::RoadNetwork twoRoads() {
  return test::NetworkText()
      .edge("10#0", {"0,0 100,0"}, "a", "b")
      .edge("-<b>&", {"100,5 0,5"}, "b", "a")
      .edge("path", {"0,30 100,30"}, "a", "b", {2.0, 3.0, "pedestrian"})
      .network();
}

TEST(EdgeMap, NamesEachRoadForCarsOnceWithItsDirection) {
  const std::multiset<std::string> texts = textsOf(edgeMapSvg(twoRoads(), std::nullopt));
  EXPECT_EQ(texts.count("10#0 \u2192"), 1U);
  EXPECT_EQ(texts.count("\u2190 -<b>&"), 1U) << "it leads west, and is not upside down";
  for (const std::string& text : texts) EXPECT_EQ(text.find("path"), std::string::npos);
}

TEST(EdgeMap, ShowsTheRouteWithStartAndGoal) {
  const map::RoadNetwork network = twoRoads();
  const map::LaneGraph graph(network);
  const std::string with = edgeMapSvg(network, map::routeAlongEdges(graph, {"10#0"}, 5.0, 5.0));
  pugi::xml_document document;
  ASSERT_TRUE(document.load_string(with.c_str()));
  const auto marks = document.select_nodes("//g[@class='route']/circle");
  ASSERT_EQ(marks.size(), 2U);
  // 15 m of margin; from x = 5 m to x = 95 m, south of the other road, 5 m above y = 0.
  EXPECT_EQ(marks[0].node().attribute("cx").as_double(), 20.0);
  EXPECT_EQ(marks[1].node().attribute("cx").as_double(), 110.0);
  EXPECT_EQ(marks[0].node().attribute("cy").as_double(), 20.0);
}

TEST(EdgeMap, OfFootpathsIsRefused) {
  const map::RoadNetwork paths =
      test::NetworkText().edge("path", {"0,0 100,0"}, "a", "b", {2.0, 3.0, "pedestrian"}).network();
  EXPECT_NE(test::errorOf([&] { edgeMapSvg(paths, std::nullopt); }).find("no lane for cars"),
            std::string::npos);
}

}  // namespace
}  // namespace cdiff::page
