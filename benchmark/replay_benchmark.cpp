// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <unistd.h>

#include <atomic>
#include <memory>

#include "benchmark.h"
#include "e2e_cdiff/core/exceptions.h"
#include "metrics/session_metrics.h"
#include "node_graph/bags/bag_reader.h"
#include "node_graph/bags/replay.h"
#include "node_graph/bags/session_bag_writer.h"
#include "session/closed_loop.h"
#include "session/session_request.h"

namespace cdiff::benchmark {
namespace {

namespace fs = std::filesystem;

constexpr int kRepetitions = 9;

/// A town, whose set-up costs more than its ticks.
session::ScenarioOptions town05() {
  const fs::path data = dataFolder();
  session::SessionRequest request;
  request.bench2drive = (data / "bench2drive" / "bench2drive220.xml").string();
  request.route = "25318";
  request.network = (data / "carla_towns" / "Town05.net.xml").string();
  request.cbv_planner = "pdm_lite";
  request.set = {"traffic.density=50", "traffic.forget_distance=160", "max_cbv=2",
                 "protocol.blocked_time=1000", "protocol.time_limit=60"};
  return session::resolveRequest(request);
}

/// Two CBVs that see, plan by diffusion and are guided: images, plans and guidance in the bag.
session::ScenarioOptions roundabout() {
  session::SessionRequest request;
  request.scenario = "roundabout_cross";
  request.mode = "safety_critical";
  request.seed = "1";
  return session::resolveRequest(request);
}

/// Simulated seconds.
double record(const session::ScenarioOptions& options, const fs::path& bag_file) {
  const session::SessionSetup setup(options);
  session::ClosedLoop loop(setup);
  node_graph::SessionBagWriter bag(setup, bag_file, {"benchmark", loop.world().simulatorVersion()});
  loop.addObserver(bag);
  const std::atomic<bool> stop{false};
  loop.run(stop);
  bag.finish();
  return loop.world().snapshot().time;
}

/// The figures alone.
class Metrics : public session::SessionObserver {
 public:
  explicit Metrics(const session::SessionSetup& setup)
      : metrics_(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute()) {}
  void observe(const session::TickRecord& record) override {
    metrics_.observe(*record.snapshot, record.selection);
  }
  void finish() const { metrics_.measures(); }

 private:
  metrics::SessionMetrics metrics_;
};

void readBytes(const fs::path& bag) {
  node_graph::BagReader reader(bag);
  node_graph::BagMessage message;
  while (reader.next(message)) {
  }
}

void measureOnly(node_graph::RecordedSession& session) {
  Metrics metrics(session.setup());
  node_graph::showTicks(session, {&metrics});
  metrics.finish();
}

/// Network, drivable area and route from the bag; once per session, however long it is.
struct MetricsTime {
  double set_up = 0.0;  ///< [s]
  double ticks = 0.0;   ///< [s]
};

MetricsTime metricsTime(const fs::path& bag) {
  std::vector<double> set_up;
  std::vector<double> ticks;
  for (int i = 0; i < kRepetitions; ++i) {
    std::unique_ptr<node_graph::RecordedSession> session;
    set_up.push_back(
        secondsOf([&] { session = std::make_unique<node_graph::RecordedSession>(bag); }));
    ticks.push_back(secondsOf([&] { measureOnly(*session); }));
  }
  return {median(set_up), median(ticks)};
}

void requireWhole(const fs::path& bag, const fs::path& results) {
  const auto findings = node_graph::replayBag(bag, results, true).findings;
  if (!findings.empty()) throw core::Error("the recorded bag is damaged: " + findings.front());
}

template <class Call>
double medianSeconds(Call call) {
  std::vector<double> seconds;
  for (int i = 0; i < kRepetitions; ++i) seconds.push_back(secondsOf(call));
  return median(seconds);
}

void measure(const std::string& name, const session::ScenarioOptions& options,
             const fs::path& folder, Figures& figures) {
  const fs::path bag = folder / (name + ".bag");
  const fs::path results = folder / name;
  const double simulated = record(options, bag);
  const double reading = medianSeconds([&] { readBytes(bag); });
  const MetricsTime metrics = metricsTime(bag);
  const double whole = medianSeconds([&] { requireWhole(bag, results); });
  const double megabytes = static_cast<double>(fs::file_size(bag)) / 1e6;
  const double together = metrics.set_up + metrics.ticks;
  figures.push_back(
      {"replay_" + name + "_metrics", simulated / together, "times real time", ">=200"});
  figures.push_back({"replay_" + name + "_set_up", 1e3 * metrics.set_up, "ms", ""});
  figures.push_back(
      {"replay_" + name + "_ticks", simulated / metrics.ticks, "times real time", ""});
  figures.push_back({"replay_" + name + "_with_report", simulated / whole, "times real time", ""});
  figures.push_back({"replay_" + name + "_read", simulated / reading, "times real time", ""});
  figures.push_back({"replay_" + name + "_session", simulated, "s", ""});
  figures.push_back({"replay_" + name + "_bag", megabytes, "MB", ""});
}

}  // namespace

void benchmarkReplay(Figures& figures) {
  ::setenv("SUMO_HOME", "/usr/share/sumo", 0);
  const fs::path folder =
      fs::temp_directory_path() / ("cdiff_replay_benchmark_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  measure("roundabout_diffusion", roundabout(), folder, figures);
  measure("town05_50_vehicles", town05(), folder, figures);
  fs::remove_all(folder);
}

}  // namespace cdiff::benchmark
