// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <libsumo/libtraci.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmark.h"
#include "core/file.h"
#include "core/stage_times.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/result_writer.h"
#include "session/closed_loop.h"
#include "session/session_request.h"

namespace cdiff::benchmark {
namespace {

namespace fs = std::filesystem;

session::ScenarioOptions town05(std::int64_t seed) {
  const fs::path data = dataFolder();
  session::SessionRequest request;
  request.bench2drive = (data / "bench2drive" / "bench2drive220.xml").string();
  request.route = "25318";
  request.network = (data / "carla_towns" / "Town05.net.xml").string();
  request.seed = std::to_string(seed);
  request.cbv_planner = "pdm_lite";  // the loop, not the denoising
  request.set = {"traffic.density=50",  "traffic.forget_distance=160",
                 "max_cbv=2",           "protocol.blocked_time=1000",
                 "verdict.judge=false", "protocol.time_limit=60"};
  return session::resolveRequest(request);
}

/// Counts what a session was made of.
class Census : public session::SessionObserver {
 public:
  void observe(const session::TickRecord& record) override {
    ++ticks;
    vehicles += record.snapshot->vehicles.size();
    for (const traffic::Vehicle& vehicle : record.snapshot->vehicles)
      cbvs += vehicle.role == traffic::VehicleRole::kCbv;
  }
  std::size_t ticks = 0;
  std::size_t vehicles = 0;
  std::size_t cbvs = 0;
};

struct LoopResult {
  double seconds = 0.0;
  Census census;
  std::map<std::string, double> stages;  ///< [us] of a tick, with those that have no name
};

enum class Results { kNone, kInTurn, kBeside };

/// A session that runs with its results in the same thread, in one beside it, or without them.
LoopResult runLoop(const session::SessionSetup& setup, Results results, const fs::path& folder) {
  LoopResult result;
  session::ClosedLoop loop(setup);
  page::ResultWriter writer(setup, {"benchmark", loop.world().simulatorVersion(), true}, folder);
  loop.addObserver(result.census);
  if (results != Results::kNone) loop.addObserver(writer);
  if (results == Results::kBeside) loop.observeBeside();
  const std::atomic<bool> stop{false};
  const core::StageTimes times;
  result.seconds = secondsOf([&] { loop.run(stop); });
  double named = 0.0;
  const double ticks_per_microsecond = static_cast<double>(result.census.ticks) / 1e6;
  for (const auto& [stage, seconds] : times.seconds()) {
    result.stages[stage] = seconds / ticks_per_microsecond;
    named += seconds;
  }
  result.stages["rest"] = (result.seconds - named) / ticks_per_microsecond;
  return result;
}

/// Nothing but libtraci: the same town, demand, subscriptions and number of moved vehicles.
double bareLoop(const session::SessionSetup& setup, std::size_t ticks) {
  using libtraci::Simulation;
  using libtraci::Vehicle;
  simulation::DemandOptions demand_options = setup.options().traffic;
  simulation::DemandGenerator demand(demand_options, setup.graph(), setup.egoRoute(), 1);
  const Eigen::Vector3d start = setup.egoRoute().path().pointAt(0.0);
  Simulation::start({"sumo", "-n", setup.import().file.string(), "--step-length", "0.05",
                     "--no-step-log", "--no-warnings", "--collision.action", "none",
                     "--xml-validation", "never", "--time-to-teleport", "-1"});
  const std::vector<int> variables = {libsumo::VAR_POSITION3D, libsumo::VAR_ANGLE,
                                      libsumo::VAR_SPEED, libsumo::VAR_ACCELERATION,
                                      libsumo::VAR_LANE_ID};
  std::vector<traffic::Vehicle> present;
  while (auto wanted = demand.next(present, start.head<2>(), start.z(), true)) {
    libtraci::Route::add("route_" + wanted->id, wanted->edges);
    Vehicle::add(wanted->id, "route_" + wanted->id, "DEFAULT_VEHTYPE", "now",
                 std::to_string(wanted->depart_lane), std::to_string(wanted->depart_position),
                 std::to_string(wanted->depart_speed));
    Vehicle::subscribe(wanted->id, variables);
    const auto lanes = setup.network().lanesOfEdge(wanted->edges.front());
    const auto& line =
        setup.network().lane(lanes[static_cast<std::size_t>(wanted->depart_lane)]).centerline;
    traffic::Vehicle placed;
    placed.id = wanted->id;
    const Eigen::Vector3d point = line.pointAt(wanted->depart_position);
    placed.state = {point.head<2>(), point.z(), line.headingAt(wanted->depart_position),
                    wanted->depart_speed};
    present.push_back(placed);
    if (present.size() >= 50) break;
  }
  Simulation::step();
  const std::vector<std::string> ids = Vehicle::getIDList();
  const std::vector<std::string> moved(ids.begin(),
                                       ids.begin() + std::min<std::size_t>(3, ids.size()));
  std::vector<libsumo::TraCIPosition> places;
  std::vector<double> angles;
  for (const std::string& id : moved) {
    places.push_back(Vehicle::getPosition(id));
    angles.push_back(Vehicle::getAngle(id));
  }
  const double seconds = secondsOf([&] {
    for (std::size_t tick = 0; tick < ticks; ++tick) {
      for (std::size_t i = 0; i < moved.size(); ++i)
        Vehicle::moveToXY(moved[i], "", -1, places[i].x, places[i].y, angles[i], 3, 20.0);
      Simulation::step();
      Vehicle::getAllSubscriptionResults();
    }
  });
  Simulation::close();
  return seconds;
}

/// Ticks per second of the same session as a graph of ROS nodes; runs the script that
/// E2E_CDIFF_SESSION names.
std::vector<double> nodeGraphLoop(const fs::path& folder) {
  const char* script = std::getenv("E2E_CDIFF_SESSION");
  if (script == nullptr) {
    std::cerr << "benchmark: the node graph is left out; scripts/benchmark runs it\n";
    return {};
  }
  const fs::path data = dataFolder();
  std::vector<double> rates;
  for (int repetition = 0; repetition < 3; ++repetition) {
    const std::string command =
        std::string("'") + script + "' bench2drive:='" +
        (data / "bench2drive/bench2drive220.xml").string() + "' route:=25318 network:='" +
        (data / "carla_towns/Town05.net.xml").string() +
        "' cbv_planner:=pdm_lite set:='traffic.density=50 traffic.forget_distance=160 "
        "protocol.blocked_time=1000 verdict.judge=false' seed:=1 "
        "record:=true overwrite:=true results:='" +
        folder.string() + "' >/dev/null 2>&1";
    if (std::system(command.c_str()) != 0)
      throw core::SimulatorError("the session of the node graph failed: " + command);
    const auto summary = nlohmann::json::parse(core::readFile(folder / "summary.json", "summary"));
    rates.push_back(summary.at("simulated_seconds").get<double>() / 0.05 /
                    summary.at("wall_seconds").get<double>());
  }
  return rates;
}

}  // namespace

void benchmarkLoop(Figures& figures) {
  ::setenv("SUMO_HOME", "/usr/share/sumo", 0);
  const fs::path folder =
      fs::temp_directory_path() / ("cdiff_benchmark_" + std::to_string(::getpid()));
  std::vector<double> full, one_thread, without_results, bare, share, vehicles, cbvs;
  std::map<std::string, std::vector<double>> stages;
  for (std::int64_t seed = 1; seed <= 5; ++seed) {
    const session::SessionSetup setup(town05(seed));
    // cdiff run makes the drivable area while SUMO starts.
    setup.drivableArea().contains(setup.egoRoute().path().pointAt(0.0).head<2>());
    const LoopResult with = runLoop(setup, Results::kBeside, folder);
    const LoopResult in_turn = runLoop(setup, Results::kInTurn, folder);
    const LoopResult without = runLoop(setup, Results::kNone, folder);
    const auto ticks = static_cast<double>(with.census.ticks);
    full.push_back(ticks / with.seconds);
    one_thread.push_back(ticks / in_turn.seconds);
    without_results.push_back(static_cast<double>(without.census.ticks) / without.seconds);
    bare.push_back(ticks / bareLoop(setup, with.census.ticks));
    share.push_back(100.0 * full.back() / bare.back());
    for (const auto& [stage, microseconds] : with.stages) stages[stage].push_back(microseconds);
    for (const std::string stage : {"record", "metrics"})
      stages["beside_" + stage].push_back(in_turn.stages.at(stage));
    vehicles.push_back(static_cast<double>(with.census.vehicles) / ticks);
    cbvs.push_back(static_cast<double>(with.census.cbvs) / ticks);
  }
  const std::vector<double> node_graph = nodeGraphLoop(folder);
  fs::remove_all(folder);
  figures.push_back({"loop_with_results", median(full), "ticks/s", ">=1000"});
  figures.push_back({"loop_with_results_in_one_thread", median(one_thread), "ticks/s", ""});
  figures.push_back({"loop_without_results", median(without_results), "ticks/s", ">=1000"});
  figures.push_back({"loop_bare_libtraci", median(bare), "ticks/s", ""});
  figures.push_back({"loop_share_of_bare", median(share), "%", ">=85"});
  if (!node_graph.empty())
    figures.push_back({"loop_node_graph_recording", median(node_graph), "ticks/s", ""});
  figures.push_back({"loop_vehicles", median(vehicles), "vehicles", ""});
  figures.push_back({"loop_cbvs_driven", median(cbvs), "vehicles", ""});
  for (const auto& [stage, microseconds] : stages)
    figures.push_back({"loop_stage_" + stage, median(microseconds), "us/tick", ""});
}

}  // namespace cdiff::benchmark
