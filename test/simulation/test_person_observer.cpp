// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Persons and bicycles of a demand among the vehicles, on a straight road of 300 m along x.
#include <gtest/gtest.h>

#include <fstream>

#include "simulation/person_observer.h"
#include "simulation/sumo_simulator.h"
#include "support/sumo_network.h"

namespace cdiff::simulation {
namespace {

constexpr const char* kDemand = R"(<routes>
<vType id="bike" vClass="bicycle"/>
<person id="walker" depart="0" departPos="50"><walk edges="e" arrivalPos="250"/></person>
<vehicle id="cyclist" type="bike" depart="0" departPos="20" departSpeed="3"><route edges="e"/></vehicle>
</routes>)";

class Persons : public testing::Test {
 protected:
  Persons() {
    std::ofstream(demand_) << kDemand;
    SumoSession session;
    session.network_file = net_.file;
    session.demand_file = demand_;
    simulator_ = std::make_unique<SumoSimulator>(SumoOptions(), session, net_.network);
  }
  const SimulatedVehicle* find(const std::string& id) const {
    return findVehicle(simulator_->vehicles(), id);
  }
  void step(int count) {
    for (int i = 0; i < count; ++i) simulator_->step({});
  }
  test::TemporaryFolder folder_;
  test::SumoNetwork net_ =
      test::makeSumoNetwork(folder_, R"(<node id="a" x="0" y="0"/><node id="b" x="300" y="0"/>)",
                            R"(<edge id="e" from="a" to="b" numLanes="1" speed="14"/>)");
  std::filesystem::path demand_ = folder_.path() / "people.rou.xml";
  std::unique_ptr<SumoSimulator> simulator_;
};

TEST_F(Persons, WalkAmongTheVehicles) {
  step(20);
  const SimulatedVehicle* const walker = find("walker");
  ASSERT_NE(walker, nullptr);
  ASSERT_NE(find("cyclist"), nullptr);
  EXPECT_EQ(simulator_->vehicles().size(), 2U);
  EXPECT_LT(walker->dimensions.length, 1.0);
  EXPECT_LT(find("cyclist")->dimensions.length, 2.0);
  const double x = walker->state.position.x();
  const double speed = walker->state.speed;
  EXPECT_GT(speed, 0.5);
  step(20);  // 1 s
  EXPECT_NEAR(find("walker")->state.position.x(), x + speed, 0.3);
}

TEST_F(Persons, LeaveWhenTheyAreRemoved) {
  step(20);
  simulator_->remove("walker");
  step(2);
  EXPECT_EQ(find("walker"), nullptr);
  EXPECT_NE(find("cyclist"), nullptr);
}

TEST_F(Persons, ADemandWithoutThemHasNone) {
  EXPECT_TRUE(hasPersons(demand_));
  EXPECT_FALSE(hasPersons({}));
  std::ofstream(demand_) << "<routes/>";
  EXPECT_FALSE(hasPersons(demand_));
}

}  // namespace
}  // namespace cdiff::simulation
