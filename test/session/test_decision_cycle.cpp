// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// The decision cycle with parts of a test: who is asked, how a planner's failure ends, which
// images a record holds, how long it waits. The ego stands at x = 100 m, the CBV "car" 100 m ahead
// of it.
#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <new>
#include <stdexcept>
#include <thread>
#include <tuple>

#include "e2e_cdiff/core/exceptions.h"
#include "session/closed_loop.h"
#include "session/scripted_session.h"

namespace cdiff::session {
namespace {

using planning::PlannedAction;
using planning::PlanningTask;
using test::ScriptedSession;

/// Names the same selection at every decision, and counts its calls.
class Always : public cbv::VehicleSelector {
 public:
  explicit Always(cbv::CbvSelection selection) : selection_(std::move(selection)) {}
  void observe(const traffic::TrafficSnapshot&) override { ++observed; }
  cbv::CbvSelection update(const traffic::TrafficSnapshot&) override {
    ++updated;
    return selection_;
  }
  int observed = 0;
  int updated = 0;

 private:
  cbv::CbvSelection selection_;
};

/// Brakes gently, after `check` has seen the task.
class Braking : public planning::Planner {
 public:
  using Check = std::function<void(const PlanningTask&)>;
  explicit Braking(Check check = {}) : check_(std::move(check)) {}
  std::vector<PlannedAction> plan(const traffic::TrafficSnapshot&,
                                  const std::vector<PlanningTask>& tasks) override {
    std::vector<PlannedAction> actions;
    for (const PlanningTask& task : tasks) {
      if (check_) check_(task);
      actions.push_back({task.slot, task.vehicle->id, {0.0, 0.0, 0.25}, {}});
    }
    return actions;
  }

 private:
  Check check_;
};

/// What records show: actions and slots of images by decision, and all faults.
class Record : public SessionObserver {
 public:
  void observe(const TickRecord& record) override {
    for (const traffic::Fault& fault : record.snapshot->faults) faults.push_back(fault.source);
    if (record.actions == nullptr) return;
    actions.push_back(*record.actions);
    images.emplace_back();
    for (const SlotImage& image : *record.images) images.back().push_back(image.slot);
  }
  std::vector<std::vector<PlannedAction>> actions;
  std::vector<std::vector<int>> images;
  std::vector<std::string> faults;
};

/// Runs three ticks of a session, decisions at 0 and 2, then is stopped at tick 3.
class Cycle {
 public:
  explicit Cycle(double at_most = 0.0) : scripted_(0.0, at_most) {
    scripted_.simulator().place("car", {200.0, 0.0, 0.0, 5.0});
    auto selector = std::make_unique<Always>(scripted_.selectionOf("car"));
    selector_ = selector.get();
    parts.selector = std::move(selector);
    parts.ego_planner = {std::make_unique<Braking>()};
    parts.cbv_planner = {std::make_unique<Braking>()};
  }
  Record run() {
    class Stop : public SessionObserver {
     public:
      void observe(const TickRecord& record) override { stop = record.snapshot->tick == 3; }
      std::atomic<bool> stop{false};
    } stop;
    return run(stop, stop.stop);
  }
  Record run(SessionObserver& observer, const std::atomic<bool>& stop,
             const std::function<void(ClosedLoop&)>& before = {}) {
    parts.world = scripted_.makeWorld();
    ClosedLoop loop(scripted_.setup(), std::move(parts));
    if (before) before(loop);
    Record record;
    loop.addObserver(record);
    loop.addObserver(observer);
    EXPECT_EQ(loop.run(stop), traffic::SessionStatus::kInterrupted);
    updated = selector_->updated;
    observed = selector_->observed;
    return record;
  }
  const SessionSetup& setup() { return scripted_.setup(); }
  double secondsSinceMade() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - made_).count();
  }

  LoopParts parts;
  int updated = 0;
  int observed = 0;

 private:
  ScriptedSession scripted_;
  Always* selector_;
  std::chrono::steady_clock::time_point made_ = std::chrono::steady_clock::now();
};

TEST(DecisionCycle, AsksEgoAndCbvAtEverySecondTick) {
  Cycle cycle;
  const Record record = cycle.run();
  EXPECT_EQ(cycle.updated, 2);
  EXPECT_EQ(cycle.observed, 3) << "ticks 1, 3 and the last one";
  ASSERT_EQ(record.actions.size(), 2U);
  for (const auto& actions : record.actions) {
    ASSERT_EQ(actions.size(), 2U);
    EXPECT_EQ(actions[0].vehicle_id, "ego");
    EXPECT_EQ(actions[1].vehicle_id, "car");
  }
  EXPECT_EQ(record.images, (std::vector<std::vector<int>>{{}, {}}));
  EXPECT_EQ(record.faults, std::vector<std::string>{"user"});
}

/// Notes tick, place of the ego and number of actions of each record; begins once it is let go.
class Late : public SessionObserver {
 public:
  explicit Late(std::future<void> begin) : begin_(std::move(begin)) {}
  void observe(const TickRecord& record) override {
    if (seen.empty()) begin_.wait();
    const double x = record.snapshot->ego()->state.position.x();
    const std::size_t actions = record.actions == nullptr ? 0 : record.actions->size();
    seen.emplace_back(record.snapshot->tick, x, actions);
  }
  std::vector<std::tuple<std::uint64_t, double, std::size_t>> seen;

 private:
  std::future<void> begin_;
};

/// What is seen of a session that its ego's second decision stops: at once, or beside the session
/// and only from that decision on.
auto seenOf(bool beside) {
  Cycle cycle;
  std::promise<void> begin;
  Late late(begin.get_future());
  if (!beside) begin.set_value();
  std::atomic<bool> stop{false};
  int decisions = 0;
  cycle.parts.ego_planner = {std::make_unique<Braking>([&](const PlanningTask&) {
    stop = ++decisions == 2;
    if (stop && beside) begin.set_value();
  })};
  cycle.run(late, stop, [&](ClosedLoop& loop) {
    if (beside) loop.observeBeside();
  });
  return late.seen;
}

TEST(DecisionCycle, ObserversThatLagSeeEachTickAsItWas) {
  const auto seen = seenOf(true);
  ASSERT_EQ(seen.size(), 4U) << "ticks 0 to 2 and the end";
  EXPECT_EQ(std::get<0>(seen[0]), 0U);
  EXPECT_EQ(std::get<2>(seen[2]), 2U) << "ego and CBV";
  EXPECT_EQ(seen, seenOf(false));
}

TEST(DecisionCycle, WhatAnObserverBesideThrowsEndsTheSession) {
  class Broken : public SessionObserver {
   public:
    void observe(const TickRecord&) override { throw std::runtime_error("the disk is full"); }
  } broken;
  Cycle cycle;
  const std::atomic<bool> stop{false};
  EXPECT_THROW(cycle.run(broken, stop, [](ClosedLoop& loop) { loop.observeBeside(); }),
               std::runtime_error);
}

TEST(DecisionCycle, APlannerThatThrowsIsFullBrakingAndOneFaultADecision) {
  Cycle cycle;
  cycle.parts.cbv_planner = {
      std::make_unique<Braking>([](const PlanningTask&) { throw std::runtime_error("no idea"); })};
  const Record record = cycle.run();
  EXPECT_EQ(record.actions[0][0].action.brake, 0.25) << "the ego's planner goes on";
  EXPECT_EQ(record.actions[0][1].action, traffic::ControlAction::failSafe());
  EXPECT_EQ(record.actions[0][1].fault, "no idea");
  const std::string planner = "cbv:" + ScenarioOptions().ego_planner;  // that of the scenario
  EXPECT_EQ(record.faults, (std::vector<std::string>{planner, planner, "user"}));
}

TEST(DecisionCycle, SoIsOneThatThrowsAnExceptionWithoutAText) {
  Cycle cycle;
  cycle.parts.cbv_planner = {
      std::make_unique<Braking>([](const PlanningTask&) { throw std::runtime_error(""); })};
  const Record record = cycle.run();
  EXPECT_EQ(record.actions[0][1].action, traffic::ControlAction::failSafe());
  EXPECT_FALSE(record.actions[0][1].fault.empty());
}

TEST(DecisionCycle, SoIsOneThatThrowsWhatIsNoException) {
  Cycle cycle;
  cycle.parts.cbv_planner = {std::make_unique<Braking>([](const PlanningTask&) { throw 7; })};
  const Record record = cycle.run();
  EXPECT_EQ(record.actions[0][1].action, traffic::ControlAction::failSafe());
  EXPECT_NE(record.actions[0][1].fault.find("no std::exception"), std::string::npos);
}

/// What a fault's text of 10 MB with a control character becomes.
void expectShort(const std::string& text) {
  EXPECT_GT(text.size(), 100U);
  EXPECT_LT(text.size(), 10000U);
  EXPECT_EQ(text.find('\033'), std::string::npos);
}

TEST(DecisionCycle, WhatAPlannerSaysOfAFaultIsCutAndMadePlain) {
  const std::string loud = "\033[31m" + std::string(10'000'000, 'x');
  Cycle cycle;
  cycle.parts.cbv_planner = {
      std::make_unique<Braking>([&](const PlanningTask&) { throw std::runtime_error(loud); })};
  class Reasoning : public Braking {
   public:
    explicit Reasoning(std::string reason) : reason_(std::move(reason)) {}
    std::vector<PlannedAction> plan(const traffic::TrafficSnapshot& snapshot,
                                    const std::vector<PlanningTask>& tasks) override {
      std::vector<PlannedAction> actions = Braking::plan(snapshot, tasks);
      for (PlannedAction& action : actions) action.fault = reason_;
      return actions;
    }

   private:
    std::string reason_;
  };
  cycle.parts.ego_planner = {std::make_unique<Reasoning>(loud)};
  const Record record = cycle.run();
  for (const PlannedAction& action : record.actions[0]) expectShort(action.fault);
}

TEST(DecisionCycle, MemoryThatRanOutIsExplained) {
  Cycle cycle;
  cycle.parts.cbv_planner = {
      std::make_unique<Braking>([](const PlanningTask&) { throw std::bad_alloc(); })};
  const Record record = cycle.run();
  EXPECT_EQ(record.actions[0][1].action, traffic::ControlAction::failSafe());
  EXPECT_EQ(record.actions[0][1].fault.find("bad_alloc"), std::string::npos);
  EXPECT_NE(record.actions[0][1].fault.find("memory"), std::string::npos);
}

TEST(DecisionCycle, ImagesAreThoseOfPlannersThatSeeAndThoseWishedFor) {
  Cycle cycle;
  int seen = 0;
  cycle.parts.cameras.emplace(cycle.setup());
  cycle.parts.cbv_planner = {std::make_unique<Braking>([&](const PlanningTask& task) {
                               seen += task.views.find("front") != nullptr;
                             }),
                             true};
  cycle.parts.image_wish = [](const traffic::TrafficSnapshot& snapshot, const traffic::Vehicle&,
                              int slot) { return slot == 0 || snapshot.tick == 2; };
  const Record record = cycle.run();
  EXPECT_EQ(seen, 2);
  EXPECT_EQ(record.images, (std::vector<std::vector<int>>{{0}, {0, -1}}));
}

TEST(DecisionCycle, APlannerIsGivenAllImagesOfItsRigInOrder) {
  Cycle cycle;
  ScenarioOptions options = cycle.setup().options();
  options.ego_rig.preset = rendering::kBench2driveRig;
  const VehicleRigs rigs(options);
  cycle.parts.cameras.emplace(cycle.setup(), rigs);
  int seen = 0;
  cycle.parts.ego_planner = {
      std::make_unique<Braking>([&](const PlanningTask& task) {
        ASSERT_NE(task.views.rig, nullptr);
        EXPECT_EQ(task.views.rig->names(), rigs.of(traffic::kEgoSlot).names());
        ASSERT_EQ(task.views.images.size(), 6u);
        EXPECT_EQ(task.views.missing(), "");
        rendering::RigRenderer renderer(rigs.of(traffic::kEgoSlot), cycle.setup().network());
        traffic::TrafficSnapshot alone;  // no other is near
        const auto views = renderer.render(alone, *task.vehicle);
        for (std::size_t i = 0; i < 6; ++i)
          EXPECT_EQ(task.views.images[i]->rgb, views[i].image.rgb) << i;
        ++seen;
      }),
      true};
  cycle.parts.cbv_planner = {std::make_unique<Braking>([](const PlanningTask& task) {
                               EXPECT_EQ(task.views.rig->names(),
                                         std::vector<std::string>{"front"});
                               EXPECT_EQ(task.views.images.size(), 1u);
                             }),
                             true};
  const Record record = cycle.run();
  EXPECT_EQ(seen, 2);
  EXPECT_EQ(record.images[0], (std::vector<int>{-1, -1, -1, -1, -1, -1, 0}));
}

/// Notes which guidance it follows at each decision, and for which target speed it is asked.
class Steered : public planning::Planner {
 public:
  struct Seen {
    std::vector<double> weights;  ///< of the objective speed; -1 before any is set
    std::vector<double> target_speeds;
  };
  explicit Steered(Seen& seen) : seen_(seen) {}
  void setGuidance(const guidance::GuidanceOptions& guidance) override {
    guidance::GuidanceOptions copy = guidance;
    weight_ = copy.find("speed").weight;
    if (weight_ > 100.0) throw core::InputError("too much");
  }
  std::vector<PlannedAction> plan(const traffic::TrafficSnapshot&,
                                  const std::vector<PlanningTask>& tasks) override {
    seen_.weights.push_back(weight_);
    seen_.target_speeds.push_back(tasks[0].target_speed);
    return {{tasks[0].slot, tasks[0].vehicle->id, {0.0, 0.0, 0.25}, {}}};
  }

 private:
  Seen& seen_;
  double weight_ = -1.0;
};

/// Steers as a scenario does: guidance and target speed from 0.1 s (tick 2) on.
class SteeredCycle {
 public:
  explicit SteeredCycle(double weight) : weight_(weight) {}
  Record run() {
    test::ScriptedSession scripted;
    scripted.simulator().place("car", {200.0, 0.0, 0.0, 5.0});
    ScenarioOptions options = scripted.setup().options();
    options.cbv_planner = "diffusion";
    options.protocol.time_limit = 0.3;
    options.steering.resize(1);
    options.steering[0].at = 0.1;
    options.steering[0].objective = "speed";
    options.steering[0].weight = weight_;
    options.steering[0].target_speed = 11.0;
    const SessionSetup setup(options);
    LoopParts parts;
    parts.selector = std::make_unique<Always>(scripted.selectionOf("car"));
    parts.ego_planner = {std::make_unique<Braking>()};
    parts.cbv_planner = {std::make_unique<Steered>(seen)};
    auto simulator = std::make_unique<test::ScriptedSimulator>();
    simulator->place("car", {200.0, 0.0, 0.0, 5.0});
    parts.world = std::make_unique<World>(setup, std::move(simulator));
    ClosedLoop loop(setup, std::move(parts));
    Record record;
    loop.addObserver(record);
    loop.run(std::atomic<bool>(false));
    return record;
  }
  Steered::Seen seen;

 private:
  double weight_;
};

TEST(DecisionCycle, SteeringIsFollowedInTheDecisionOfItsSnapshot) {
  SteeredCycle cycle(3.0);
  EXPECT_EQ(cycle.run().faults, std::vector<std::string>{});
  EXPECT_EQ(cycle.seen.weights, (std::vector<double>{-1.0, 3.0, 3.0}));
  EXPECT_EQ(cycle.seen.target_speeds, (std::vector<double>{8.0, 11.0, 11.0}));
}

TEST(DecisionCycle, GuidanceThatAPlannerCannotFollowIsAFault) {
  SteeredCycle cycle(200.0);
  EXPECT_EQ(cycle.run().faults, std::vector<std::string>{"cbv:diffusion"});
}

TEST(DecisionCycle, APausedSessionGoesOnWhenItIsResumed) {
  Cycle cycle;
  class PauseAtTick1 : public SessionObserver {
   public:
    ~PauseAtTick1() override {
      if (thread_.joinable()) thread_.join();
    }
    void observe(const TickRecord& record) override {
      stop = record.snapshot->tick == 3;
      if (record.snapshot->tick != 1) return;
      control->pause();
      thread_ = std::thread([this] {
        control->step(1);
        stepped = control->awaitSteps(60.0);
        control->resume();
      });
    }
    SessionControl* control = nullptr;
    std::atomic<bool> stop{false};
    std::atomic<bool> stepped{false};

   private:
    std::thread thread_;
  } steering;
  EXPECT_EQ(cycle
                .run(steering, steering.stop,
                     [&](ClosedLoop& loop) { steering.control = &loop.control(); })
                .actions.size(),
            2U);
  EXPECT_TRUE(steering.stepped);
}

// Tick 2, at 0.1 s, is left when 0.1 s / 0.25 have passed.
TEST(DecisionCycle, AtMostWaitsForTheClock) {
  Cycle cycle(0.25);
  EXPECT_EQ(cycle.run().actions.size(), 2U);
  EXPECT_GE(cycle.secondsSinceMade(), 0.4);
}

// Tick 1, at 0.05 s, would be left after 50 s.
TEST(DecisionCycle, AStopEndsTheWait) {
  class StopLater : public SessionObserver {
   public:
    ~StopLater() override {
      if (thread_.joinable()) thread_.join();
    }
    void observe(const TickRecord& record) override {
      if (record.snapshot->tick != 1) return;
      thread_ = std::thread([this] {
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        stop = true;
      });
    }
    std::atomic<bool> stop{false};

   private:
    std::thread thread_;
  } later;
  Cycle cycle(0.001);
  EXPECT_EQ(cycle.run(later, later.stop).faults, std::vector<std::string>{"user"});
  EXPECT_LT(cycle.secondsSinceMade(), 20.0);
}

}  // namespace
}  // namespace cdiff::session
