// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <libsumo/TraCIConstants.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>

#include "benchmark.h"
#include "core/file.h"
#include "core/stage_times.h"
#include "e2e_cdiff/core/exceptions.h"
#include "page/result_writer.h"
#include "session/closed_loop.h"
#include "session/session_request.h"
#include "simulation/sumo_link.h"
#include "simulation/sumo_start.h"

namespace cdiff::benchmark {
namespace {

namespace fs = std::filesystem;

session::ScenarioOptions town05(std::int64_t seed, const std::string& link = "libtraci") {
  const fs::path data = dataFolder();
  session::SessionRequest request;
  request.bench2drive = (data / "bench2drive" / "bench2drive220.xml").string();
  request.route = "25318";
  request.network = (data / "carla_towns" / "Town05.net.xml").string();
  request.seed = std::to_string(seed);
  request.cbv_planner = "pdm_lite";  // the loop, not the denoising
  request.set = {"simulation.link=" + link,     "traffic.density=50",
                 "traffic.forget_distance=160", "max_cbv=2",
                 "protocol.blocked_time=1000",  "verdict.judge=false",
                 "protocol.time_limit=60"};
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
  std::map<std::string, double> stages;  ///< [us] of a tick
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
  const double ticks_per_microsecond = static_cast<double>(result.census.ticks) / 1e6;
  for (const auto& [stage, seconds] : times.seconds())
    result.stages[stage] = seconds / ticks_per_microsecond;
  return result;
}

/// Nothing but SUMO behind one of its links: the same town, demand, density, subscriptions and
/// number of moved vehicles.
class BareTraffic {
 public:
  explicit BareTraffic(const session::SessionSetup& setup)
      : setup_(setup),
        demand_(setup.options().traffic, setup.graph(), setup.egoRoute(), 1),
        link_(simulation::startSumo(setup.options().sumo, sumoSession(setup))),
        calls_(link_->calls()) {
    fill(true);
    calls_.step();
    seen_ = calls_.vehicleResults();
    for (const auto& [id, values] : seen_) {
      if (moved_.size() == kMoved) break;
      const auto angle =
          std::static_pointer_cast<libsumo::TraCIDouble>(values.at(libsumo::VAR_ANGLE));
      moved_.push_back({id, {"", -1, placeOf(values), angle->value, kKeepRoute, kThreshold}});
    }
  }

  /// Seconds of so many ticks, and their vehicles; what fills the traffic up is not counted.
  double run(std::size_t ticks, double& vehicles) {
    double seconds = 0.0;
    for (std::size_t tick = 0; tick < ticks; ++tick) {
      if (tick % 20 == 19) fill(false);
      seconds += secondsOf([&] {
        for (const Moved& each : moved_) calls_.moveFreely(each.id, each.place);
        calls_.step();
        seen_ = calls_.vehicleResults();
      });
      vehicles += static_cast<double>(seen_.size()) / static_cast<double>(ticks);
    }
    return seconds;
  }

 private:
  static constexpr std::size_t kMoved = 3;
  static constexpr int kKeepRoute = 3;
  static constexpr double kThreshold = 20.0;  // [m]
  struct Moved {
    std::string id;
    simulation::FreePlace place;
  };

  static simulation::SumoSession sumoSession(const session::SessionSetup& setup) {
    simulation::SumoSession session;
    session.network_file = setup.import().file;
    session.link = setup.options().simulation.link;
    return session;
  }

  void fill(bool at_start) {
    constexpr std::size_t kVehicles = 55;
    const Eigen::Vector3d start = setup_.egoRoute().path().pointAt(0.0);
    std::vector<traffic::Vehicle> present = presentVehicles();
    while (present.size() < kVehicles) {
      const auto wanted = demand_.next(present, start.head<2>(), start.z(), at_start);
      if (!wanted) return;
      add(*wanted);
      const auto lane = setup_.network().lanesOfEdge(
          wanted->edges.front())[static_cast<std::size_t>(wanted->depart_lane)];
      const Eigen::Vector3d place =
          setup_.network().lane(lane).centerline.pointAt(wanted->depart_position);
      present.push_back(vehicleAt(wanted->id, place.head<2>()));
    }
  }

  void add(const simulation::DemandVehicle& wanted) {
    calls_.addRoute("route_" + wanted.id, wanted.edges);
    calls_.addVehicle(wanted.id, "route_" + wanted.id, "DEFAULT_VEHTYPE",
                      {std::to_string(wanted.depart_lane), std::to_string(wanted.depart_position),
                       std::to_string(wanted.depart_speed)});
    calls_.subscribe(wanted.id, {libsumo::VAR_POSITION3D, libsumo::VAR_ANGLE, libsumo::VAR_SPEED,
                                 libsumo::VAR_ACCELERATION, libsumo::VAR_LANE_ID});
  }

  /// Front bumper of a vehicle in what SUMO reports of it.
  static Eigen::Vector2d placeOf(const libsumo::TraCIResults& values) {
    const auto place =
        std::static_pointer_cast<libsumo::TraCIPosition>(values.at(libsumo::VAR_POSITION3D));
    return {place->x, place->y};
  }

  static traffic::Vehicle vehicleAt(const std::string& id, const Eigen::Vector2d& position) {
    traffic::Vehicle vehicle;
    vehicle.id = id;
    vehicle.state.position = position;
    return vehicle;
  }

  std::vector<traffic::Vehicle> presentVehicles() const {
    std::vector<traffic::Vehicle> vehicles;
    for (const auto& [id, values] : seen_) vehicles.push_back(vehicleAt(id, placeOf(values)));
    return vehicles;
  }

  const session::SessionSetup& setup_;
  simulation::DemandGenerator demand_;
  std::unique_ptr<simulation::SumoLink> link_;
  const simulation::SumoCalls& calls_;
  std::vector<Moved> moved_;
  libsumo::SubscriptionResults seen_;
};

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

/// What the sessions of all seeds give.
struct LoopRates {
  std::vector<double> full, one_thread, without_results, bare;  ///< [ticks/s]
  std::vector<double> in_process, bare_in_process;              ///< with libsumo [ticks/s]
  std::vector<double> gain;                                     ///< of libsumo [times]
  std::vector<double> share, sumo_share;                        ///< [%]
  std::vector<double> vehicles, bare_vehicles, cbvs;            ///< a tick
  std::map<std::string, std::vector<double>> stages;            ///< [us/tick]
};

/// Makes the drivable area, which cdiff run does while SUMO starts.
void makeStartLevel(const session::SessionSetup& setup) {
  setup.drivableArea().contains(setup.egoRoute().path().pointAt(0.0).head<2>());
}

/// The same with SUMO in this process, after libtraci's of this seed.
void measureInProcess(std::int64_t seed, const fs::path& folder, LoopRates& rates) {
  const session::SessionSetup setup(town05(seed, "libsumo"));
  makeStartLevel(setup);
  const LoopResult with = runLoop(setup, Results::kBeside, folder);
  const auto ticks = static_cast<double>(with.census.ticks);
  rates.in_process.push_back(ticks / with.seconds);
  rates.gain.push_back(rates.in_process.back() / rates.full.back());
  double vehicles = 0.0;
  rates.bare_in_process.push_back(ticks / BareTraffic(setup).run(with.census.ticks, vehicles));
}

void measureSeed(std::int64_t seed, const fs::path& folder, LoopRates& rates) {
  const session::SessionSetup setup(town05(seed));
  makeStartLevel(setup);
  const LoopResult with = runLoop(setup, Results::kBeside, folder);
  const LoopResult in_turn = runLoop(setup, Results::kInTurn, folder);
  const LoopResult without = runLoop(setup, Results::kNone, folder);
  const auto ticks = static_cast<double>(with.census.ticks);
  rates.full.push_back(ticks / with.seconds);
  rates.one_thread.push_back(ticks / in_turn.seconds);
  rates.without_results.push_back(static_cast<double>(without.census.ticks) / without.seconds);
  double bare_vehicles = 0.0;
  rates.bare.push_back(ticks / BareTraffic(setup).run(with.census.ticks, bare_vehicles));
  rates.bare_vehicles.push_back(bare_vehicles);
  measureInProcess(seed, folder, rates);
  rates.sumo_share.push_back(100.0 * with.stages.at("sumo_step") * ticks / 1e6 / with.seconds);
  rates.share.push_back(100.0 * rates.full.back() / rates.bare.back());
  for (const auto& [stage, microseconds] : with.stages) rates.stages[stage].push_back(microseconds);
  for (const std::string stage : {"record", "metrics"})
    rates.stages["beside_" + stage].push_back(in_turn.stages.at(stage));
  rates.vehicles.push_back(static_cast<double>(with.census.vehicles) / ticks);
  rates.cbvs.push_back(static_cast<double>(with.census.cbvs) / ticks);
}

}  // namespace

void benchmarkLoop(Figures& figures) {
  ::setenv("SUMO_HOME", "/usr/share/sumo", 0);
  const fs::path folder =
      fs::temp_directory_path() / ("cdiff_benchmark_" + std::to_string(::getpid()));
  LoopRates rates;
  for (std::int64_t seed = 1; seed <= 5; ++seed) measureSeed(seed, folder, rates);
  const std::vector<double> node_graph = nodeGraphLoop(folder);
  fs::remove_all(folder);
  figures.push_back({"loop_with_results", median(rates.full), "ticks/s", ">=1000"});
  figures.push_back({"loop_with_results_in_one_thread", median(rates.one_thread), "ticks/s", ""});
  figures.push_back({"loop_without_results", median(rates.without_results), "ticks/s", ">=1000"});
  figures.push_back({"loop_bare_libtraci", median(rates.bare), "ticks/s", ""});
  figures.push_back({"loop_with_results_libsumo", median(rates.in_process), "ticks/s", ""});
  figures.push_back({"loop_libsumo_per_libtraci", median(rates.gain), "times", ""});
  figures.push_back({"loop_bare_libsumo", median(rates.bare_in_process), "ticks/s", ""});
  figures.push_back({"loop_share_of_bare", median(rates.share), "%", ">=85"});
  figures.push_back({"loop_sumo_share", median(rates.sumo_share), "%", ""});
  if (!node_graph.empty())
    figures.push_back({"loop_node_graph_recording", median(node_graph), "ticks/s", ""});
  figures.push_back({"loop_vehicles", median(rates.vehicles), "vehicles", ""});
  figures.push_back({"loop_bare_vehicles", median(rates.bare_vehicles), "vehicles", ""});
  figures.push_back({"loop_cbvs_driven", median(rates.cbvs), "vehicles", ""});
  for (const auto& [stage, microseconds] : rates.stages)
    figures.push_back({"loop_stage_" + stage, median(microseconds), "us/tick", ""});
}

}  // namespace cdiff::benchmark
