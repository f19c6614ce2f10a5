// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The panel's client beside stand-ins for a session's services and topics, in a namespace for each
// case.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>

#include "dynamic_reconfigure/Reconfigure.h"
#include "e2e_cdiff/GetSimulationState.h"
#include "e2e_cdiff/SetSimulationState.h"
#include "e2e_cdiff/SteerSession.h"
#include "e2e_cdiff/StepSimulation.h"
#include "session_client.h"

namespace cdiff::rviz_panel {
namespace {

namespace msgs = ::e2e_cdiff;
using State = SessionFigures::State;

/// Services of a session that note what is called.
class FakeSession {
 public:
  explicit FakeSession(const std::string& name) : node(name) {
    node.setCallbackQueue(&queue_);
    serve<msgs::SetSimulationState>("set_simulation_state", [this](auto& request, auto& response) {
      note("state " + std::to_string(request.state.state));
      state_ = request.state.state;
      response.result.result = msgs::Result::RESULT_OK;
    });
    serve<msgs::GetSimulationState>("get_simulation_state", [this](auto&, auto& response) {
      response.state.state = state_;
      response.result.result = msgs::Result::RESULT_OK;
    });
    serve<msgs::StepSimulation>("step_simulation", [this](auto& request, auto& response) {
      note("step " + std::to_string(request.steps));
      response.result.result = msgs::Result::RESULT_OK;
    });
    serve<msgs::SteerSession>("steer", [this](auto& request, auto& response) {
      note(request.what + " " + request.value);
      const bool known = request.value != "nonsense";
      response.result.result =
          known ? msgs::Result::RESULT_OK : msgs::Result::RESULT_OPERATION_FAILED;
      if (!known) response.result.error_message = "expected a profile";
    });
    serve<dynamic_reconfigure::Reconfigure>(
        "traffic_simulator_node/set_parameters", [this](auto& request, auto& response) {
          while (held) ros::WallDuration(0.01).sleep();
          for (const auto& parameter : request.config.doubles)
            note(parameter.name + " " + std::to_string(std::lround(parameter.value)));
          response.config = request.config;
        });
    threads_.start();
  }

  std::vector<std::string> calls() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return calls_;
  }

  ros::NodeHandle node;
  std::atomic<bool> held{false};  ///< whether parameters are not answered yet

 private:
  template <class Service, class Answer>
  void serve(const std::string& name, Answer answer) {
    const boost::function<bool(typename Service::Request&, typename Service::Response&)> call =
        [answer](auto& request, auto& response) {
          answer(request, response);
          return true;
        };
    servers_.push_back(node.advertiseService(name, call));
  }
  void note(const std::string& call) {
    const std::lock_guard<std::mutex> lock(mutex_);
    calls_.push_back(call);
  }

  ros::CallbackQueue queue_;
  std::vector<ros::ServiceServer> servers_;
  std::atomic<std::uint8_t> state_{msgs::SimulationState::STATE_PLAYING};
  mutable std::mutex mutex_;
  std::vector<std::string> calls_;
  ros::AsyncSpinner threads_{4, &queue_};
};

/// Whether it comes true within 20 s.
template <class Condition>
bool eventually(Condition condition) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(20.0);
  while (!condition() && ros::WallTime::now() < end) ros::WallDuration(0.02).sleep();
  return condition();
}

msgs::Vehicle vehicle(const std::string& id, std::uint8_t role, double x) {
  msgs::Vehicle made;
  made.id = id;
  made.role = role;
  made.state.x = x;
  return made;
}

TEST(SessionClient, PlayPauseStepAndPaceCallTheirServices) {
  FakeSession session("plays");
  SessionClient client(session.node);
  EXPECT_TRUE(eventually([&] { return client.figures().state == State::kPlaying; }));
  client.pause();
  EXPECT_TRUE(eventually([&] { return client.figures().state == State::kPaused; }));
  client.step(5);
  EXPECT_TRUE(eventually([&] { return session.calls().size() == 2; }));
  client.setPace(0.5);
  EXPECT_TRUE(eventually([&] { return session.calls().size() == 3; }));
  EXPECT_EQ(session.calls(), (std::vector<std::string>{"state 2", "step 5", "pace 0.5"}));
  EXPECT_TRUE(eventually([&] { return client.figures().answer == "pace: done"; }));
}

TEST(SessionClient, ShowsWhyACallWasRefused) {
  FakeSession session("refuses");
  SessionClient client(session.node);
  client.steer("profile", "nonsense");
  EXPECT_TRUE(eventually([&] { return client.figures().refused; }));
  EXPECT_NE(client.figures().answer.find("expected a profile"), std::string::npos);
}

TEST(SessionClient, OfASliderThatMovesTheLastValueComesLast) {
  FakeSession session("slides");
  SessionClient client(session.node);
  session.held = true;
  for (int value = 1; value <= 100; ++value) client.setParameter("speed_weight", value);
  session.held = false;
  EXPECT_TRUE(eventually(
      [&] { return !session.calls().empty() && session.calls().back() == "speed_weight 100"; }));
  EXPECT_LE(session.calls().size(), 2U) << "those between were overtaken while one was called";
}

TEST(SessionClient, AClickChoosesTheNearestVehicleButNeverTheEgo) {
  FakeSession session("clicks");
  ros::Publisher traffic = session.node.advertise<msgs::TrafficSnapshot>("traffic", 1, true);
  msgs::TrafficSnapshot snapshot;
  snapshot.tick = 7;
  snapshot.header.stamp = ros::Time(0.35);
  snapshot.vehicles = {vehicle("ego", msgs::Vehicle::EGO, 0.0),
                       vehicle("bg_1", msgs::Vehicle::BACKGROUND, 4.0),
                       vehicle("bg_2", msgs::Vehicle::BACKGROUND, 9.0)};
  snapshot.faults.resize(1);
  snapshot.faults[0].source = "planner";
  traffic.publish(snapshot);
  SessionClient client(session.node);
  ASSERT_TRUE(eventually([&] { return client.figures().tick == 7; }));
  EXPECT_EQ(client.figures().vehicles, (std::vector<std::string>{"bg_1", "bg_2"}));
  EXPECT_EQ(client.figures().faults.size(), 1U);
  client.chooseAt(0.5, 0.0);
  EXPECT_TRUE(eventually([&] { return !session.calls().empty(); }));
  EXPECT_EQ(session.calls().front(), "choose bg_1");
  client.chooseAt(50.0, 0.0);
  EXPECT_TRUE(eventually([&] { return client.figures().refused; }));
  EXPECT_EQ(session.calls().size(), 1U) << "nothing is there";
}

TEST(SessionClient, ASlotShowsItsCbvAndParametersTheirRange) {
  FakeSession session("shows");
  auto selections = session.node.advertise<msgs::CbvSelection>("cbv/selection", 1, true);
  auto times = session.node.advertise<std_msgs::Float64>("cbv_1/ttc", 1, true);
  auto descriptions = session.node.advertise<dynamic_reconfigure::ConfigDescription>(
      "traffic_simulator_node/parameter_descriptions", 1, true);
  msgs::CbvSelection selection;
  selection.assignments.resize(1);
  selection.assignments[0].slot = 1;
  selection.assignments[0].vehicle_id = "bg_4";
  selections.publish(selection);
  std_msgs::Float64 time;
  time.data = 2.5;
  times.publish(time);
  dynamic_reconfigure::ConfigDescription description;
  for (auto* config : {&description.dflt, &description.min, &description.max}) {
    config->doubles.resize(1);
    config->doubles[0].name = "target_speed";
    config->doubles[0].value = config == &description.max ? 40.0 : 8.0;
  }
  descriptions.publish(description);
  SessionClient client(session.node);
  EXPECT_TRUE(eventually([&] {
    const SessionFigures figures = client.figures();
    return figures.slots.count(1) == 1 && figures.slots.at(1).ttc == 2.5 &&
           figures.parameters.count("target_speed") == 1;
  }));
  EXPECT_EQ(client.figures().slots.at(1).vehicle_id, "bg_4");
  EXPECT_EQ(client.figures().parameters.at("target_speed").maximum, 40.0);
}

TEST(SessionClient, SaysThatNoSessionRuns) {
  SessionClient client(ros::NodeHandle("nobody"));
  client.play();
  EXPECT_TRUE(eventually([&] { return client.figures().refused; }));
  EXPECT_NE(client.figures().answer.find("no session is running"), std::string::npos);
}

}  // namespace
}  // namespace cdiff::rviz_panel

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "session_client_answers");
  const ros::NodeHandle node;  // keeps the node alive between the cases
  return RUN_ALL_TESTS();
}
