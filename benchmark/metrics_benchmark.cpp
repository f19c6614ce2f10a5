// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <unistd.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <optional>
#include <sstream>

#include "benchmark.h"
#include "e2e_cdiff/core/exceptions.h"
#include "e2e_cdiff/core/random.h"
#include "metrics/formulas/distributions.h"
#include "metrics/formulas/ttc_2d.h"
#include "metrics/session_metrics.h"
#include "session/session_request.h"
#include "session/session_setup.h"

namespace cdiff::benchmark {
namespace {

namespace fs = std::filesystem;
using Samples = std::vector<double>;

// Processor time of one thread throughout, here and in scipy.
constexpr std::size_t kWassersteinSize = 1000000;
constexpr std::size_t kShapiroWilkSize = 5000;
constexpr int kRounds = 5;

/// Normal samples, the same in every run.
Samples normalSamples(const char* stream, std::size_t count, double mean, double deviation) {
  const core::RandomStream random(1, stream);
  Samples samples(count);
  for (std::size_t i = 0; i < count; ++i)
    samples[i] = mean + deviation * random.normal({0, static_cast<std::uint32_t>(i), 0}, 0);
  return samples;
}

/// Processor time that scipy needs for the same samples, and what it finds.
struct ScipyTimes {
  double wasserstein_ms = 0.0;
  double distance = 0.0;
  double shapiro_ms = 0.0;  ///< of one sample of 5000
  double w = 0.0;
};

constexpr const char* kScipyProgram = R"(
import sys, time
try:
    import numpy, scipy.stats
except ImportError:
    sys.exit(3)
first, second, sample = (numpy.fromfile(name) for name in sys.argv[1:4])
def timed(call):
    times = []
    for _ in range(5):
        begin = time.process_time()
        value = call()
        times.append(time.process_time() - begin)
    return 1e3 * sorted(times)[2], value
wasserstein, distance = timed(lambda: scipy.stats.wasserstein_distance(first, second))
shapiro, test = timed(lambda: scipy.stats.shapiro(sample))
print(wasserstein, repr(float(distance)), shapiro, repr(float(test[0])))
)";

void writeBinary(const fs::path& file, const Samples& samples) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(samples.data()),
               static_cast<std::streamsize>(samples.size() * sizeof(double)));
  if (!stream) throw core::InputError("cannot write '" + file.string() + "'");
}

/// Runs /usr/bin/python3 on the samples; nullopt without scipy.
std::optional<ScipyTimes> scipyTimes(const Samples& first, const Samples& second,
                                     const Samples& sample) {
  std::string folder = (fs::temp_directory_path() / "cdiff_benchmark_XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw core::InputError("cannot make '" + folder + "'");
  std::string command = "/usr/bin/python3 '" + folder + "/program.py'";
  std::ofstream(folder + "/program.py") << kScipyProgram;
  for (const auto& [name, samples] :
       {std::pair("first", &first), std::pair("second", &second), std::pair("sample", &sample)}) {
    writeBinary(fs::path(folder) / name, *samples);
    command += " '" + folder + "/" + name + "'";
  }
  std::FILE* program = ::popen(command.c_str(), "r");
  std::array<char, 256> line{};
  const bool answered = program != nullptr && std::fgets(line.data(), line.size(), program);
  if (program != nullptr) ::pclose(program);
  fs::remove_all(folder);
  if (!answered) return std::nullopt;
  ScipyTimes times;
  std::stringstream(line.data()) >> times.wasserstein_ms >> times.distance >> times.shapiro_ms >>
      times.w;
  return times;
}

double medianMilliseconds(double (*call)(const Samples&, const Samples&), const Samples& first,
                          const Samples& second, double& result) {
  Samples times;
  for (int round = 0; round < kRounds; ++round)
    times.push_back(1e3 * cpuSecondsOf([&] { result = call(first, second); }));
  return median(times);
}

void benchmarkSamples(Figures& figures) {
  const Samples first = normalSamples("first", kWassersteinSize, 8.0, 2.0);
  const Samples second = normalSamples("second", kWassersteinSize, 7.0, 3.0);
  double distance = 0.0;
  const double wasserstein = medianMilliseconds(
      [](const Samples& a, const Samples& b) { return *metrics::wassersteinDistance(a, b); }, first,
      second, distance);
  figures.push_back({"metrics_wasserstein_1e6", wasserstein, "ms", ""});
  const Samples sample = normalSamples("sample", kShapiroWilkSize, 0.0, 1.0);
  double w = 0.0;
  const double seconds = cpuSecondsOf([&] {
    for (int i = 0; i < 1000; ++i) w = *metrics::shapiroWilk(sample).w;
  });
  figures.push_back({"metrics_shapiro_wilk_1000_of_5000", seconds, "s", ""});
  const auto scipy = scipyTimes(first, second, sample);
  if (!scipy) {
    std::cerr << "benchmark: /usr/bin/python3 has no scipy (Debian: python3-scipy): nothing to "
                 "compare with\n";
    return;
  }
  if (std::abs(scipy->distance - distance) > 1e-9 || std::abs(scipy->w - w) > 1e-6)
    throw std::runtime_error("scipy finds other values than we do");
  figures.push_back({"metrics_wasserstein_1e6_scipy", scipy->wasserstein_ms, "ms", ""});
  figures.push_back(
      {"metrics_wasserstein_speedup", scipy->wasserstein_ms / wasserstein, "times", ">=3"});
  figures.push_back({"metrics_shapiro_wilk_speedup", scipy->shapiro_ms / seconds, "times", ""});
}

/// A box within 60 m, as around an ego.
metrics::MovingBox randomBox(const core::RandomStream& random, std::uint32_t number) {
  const core::RandomKey key{0, number, 0};
  metrics::MovingBox moving;
  moving.box = {{random.uniform(key, 0, -60.0, 60.0), random.uniform(key, 1, -60.0, 60.0)},
                random.uniform(key, 2, -3.14, 3.14),
                4.8,
                1.8};
  moving.velocity = random.uniform(key, 3, 0.0, 15.0) * geometry::direction(moving.box.heading);
  return moving;
}

void benchmarkPairs(Figures& figures) {
  const core::RandomStream random(1, "pairs");
  std::vector<metrics::MovingBox> boxes;
  for (std::uint32_t i = 0; i < 2000; ++i) boxes.push_back(randomBox(random, i));
  std::size_t defined = 0;
  std::size_t pairs = 0;
  const double seconds = cpuSecondsOf([&] {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = i + 1; j < boxes.size(); ++j, ++pairs)
        defined += metrics::timeToCollision2d(boxes[i], boxes[j]).has_value();
    }
  });
  if (defined == 0) throw std::runtime_error("no pair was on a collision course");
  figures.push_back(
      {"metrics_ttc_2d", static_cast<double>(pairs) / seconds / 1e6, "million pairs/s", ""});
}

/// A tick of ego, two CBVs and 47 others that follow the ego's route, 10 m apart.
traffic::TrafficSnapshot syntheticTick(const map::Route& route, std::uint64_t tick) {
  traffic::TrafficSnapshot snapshot;
  snapshot.tick = tick;
  snapshot.time = 0.05 * static_cast<double>(tick);
  snapshot.decision_tick = tick % 2 == 0;
  for (int i = 0; i < 50; ++i) {
    traffic::Vehicle vehicle;
    vehicle.role = i == 0  ? traffic::VehicleRole::kEgo
                   : i < 3 ? traffic::VehicleRole::kCbv
                           : traffic::VehicleRole::kBackground;
    vehicle.id = i == 0 ? "ego" : "v" + std::to_string(i);
    vehicle.cbv_slot = vehicle.role == traffic::VehicleRole::kCbv ? i - 1 : -1;
    const double s = std::fmod(10.0 * i + 8.0 * snapshot.time, route.path().length());
    vehicle.state.position = route.path().pointAt(s).head<2>();
    vehicle.state.heading = route.path().headingAt(s);
    vehicle.state.speed = 8.0;
    snapshot.vehicles.push_back(vehicle);
  }
  return snapshot;
}

void benchmarkSession(Figures& figures) {
  session::SessionRequest request;
  request.scenario = "crossing_straight";
  const session::SessionSetup setup(session::resolveRequest(request));
  std::vector<traffic::TrafficSnapshot> ticks;
  for (std::uint64_t tick = 0; tick < 800; ++tick)
    ticks.push_back(syntheticTick(setup.egoRoute(), tick));
  Samples observing;
  Samples summing;
  for (int round = 0; round < kRounds; ++round) {
    metrics::SessionMetrics session(setup.metricsOptions(), setup.drivableArea(), setup.egoRoute());
    observing.push_back(1e6 / 800.0 * cpuSecondsOf([&] {
                          for (const auto& snapshot : ticks) session.observe(snapshot, nullptr);
                        }));
    summing.push_back(1e3 * cpuSecondsOf([&] { session.measures(); }));
  }
  figures.push_back({"metrics_observe_50_vehicles", median(observing), "us/tick", ""});
  figures.push_back({"metrics_measures_after_40_s", median(summing), "ms", ""});
}

}  // namespace

void benchmarkMetrics(Figures& figures) {
  benchmarkSamples(figures);
  benchmarkPairs(figures);
  benchmarkSession(figures);
}

}  // namespace cdiff::benchmark
