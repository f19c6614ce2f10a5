// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "e2e_cdiff/core/exceptions.h"
#include "evaluation/suite_selection.h"
#include "support/real_data.h"
#include "support/temporary_folder.h"

namespace cdiff::evaluation {
namespace {

/// Routes 7, 12 (as 7) and dev10's 25378 in Town01, 9 in Town02 without a network.
class Selection : public testing::Test {
 protected:
  Selection() {
    std::ofstream(folder_.path() / "routes.xml")
        << "<routes>" << route("12", "Town01", 1) << route("7", "Town01", 1)
        << route("25378", "Town01", 2) << route("9", "Town02", 1) << "</routes>";
    std::ofstream(folder_.path() / "Town01.net.xml") << "<net/>";
  }
  static std::string route(const std::string& id, const std::string& town, int x) {
    return "<route id=\"" + id + "\" town=\"" + town + "\"><waypoints><position x=\"" +
           std::to_string(x) + "\" y=\"0\" z=\"0\"/></waypoints></route>";
  }
  Bench2DriveSelection select(const std::vector<std::string>& routes) const {
    return selectBench2Drive(
        {(folder_.path() / "routes.xml").string(), folder_.path().string(), routes});
  }
  static std::vector<std::string> idsOf(const Bench2DriveSelection& selection) {
    std::vector<std::string> ids;
    for (const auto& [id, network] : selection.routes) ids.push_back(id);
    return ids;
  }
  using Ids = std::vector<std::string>;
  test::TemporaryFolder folder_;
};

TEST_F(Selection, EqualWayPointsCountOnceUnderTheLowestId) {
  const Bench2DriveSelection all = select({});
  EXPECT_EQ(idsOf(all), (Ids{"7", "25378"}));
  EXPECT_EQ(all.repeated, (std::map<std::string, std::string>{{"12", "7"}}));
  EXPECT_EQ(repeatedText(all),
            "left out, the path is that of another route: 12 (as 7); 2 of 3 routes are run\n");
}

TEST_F(Selection, ARouteNamedWithoutItsTwinIsRun) {
  EXPECT_EQ(idsOf(select({"12"})), Ids{"12"});
  EXPECT_EQ(repeatedText(select({"12"})), "");
  EXPECT_EQ(idsOf(select({"12", "7"})), Ids{"7"});
}

TEST_F(Selection, Dev10StandsForThoseInTheTownsAtHand) {
  EXPECT_EQ(idsOf(select({"dev10"})), Ids{"25378"});
  EXPECT_EQ(idsOf(select({"dev10", "7"})), (Ids{"7", "25378"}));
}

TEST_F(Selection, NamesRoutesThatCannotBeRun) {
  try {
    select({"7", "9", "11"});
    FAIL() << "no error";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("routes 11, 9 are not in"), std::string::npos);
  }
}

TEST(RealBench2Drive, HasThirtyTwoPlacesInTheTownsAtHandAndThreeOfDev10) {
  const auto file = test::realData("bench2drive/bench2drive220.xml");
  const auto networks = test::realData("carla_towns");
  CDIFF_SKIP_WITHOUT(file);
  CDIFF_SKIP_WITHOUT(networks);
  const Bench2DriveSelection all = selectBench2Drive({file.string(), networks.string(), {}});
  EXPECT_EQ(all.routes.size(), 32U);
  const std::map<std::string, std::string> repeated = {
      {"25896", "25854"}, {"26406", "24785"}, {"26435", "25854"}, {"26456", "25854"}};
  EXPECT_EQ(all.repeated, repeated);
  std::vector<std::string> ids;
  for (const auto& [id, network] :
       selectBench2Drive({file.string(), networks.string(), {kDev10}}).routes)
    ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  EXPECT_EQ(ids, (std::vector<std::string>{"25378", "25381", "27494"}));
}

}  // namespace
}  // namespace cdiff::evaluation
