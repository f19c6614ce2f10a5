// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Benchmarks of the package: each prints figures as `figure value unit goal` and keeps them for a
/// JSON file.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace cdiff::benchmark {

struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;
  std::string goal;  ///< "" when none
};

using Figures = std::vector<Figure>;

/// Seconds that a call takes.
template <class Call>
double secondsOf(Call&& call) {
  const auto begin = std::chrono::steady_clock::now();
  call();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

/// Seconds of processor time that a call takes, so that other programs do not count.
template <class Call>
double cpuSecondsOf(Call&& call) {
  const std::clock_t begin = std::clock();
  call();
  return static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
}

/// Middle value (upper of the two middle ones for an even count).
inline double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Folder with the real networks and routes; throws InputError saying how to name it.
std::filesystem::path dataFolder();

void benchmarkCamera(Figures& figures);
void benchmarkChallenge(Figures& figures);
void benchmarkEncoder(Figures& figures);
void benchmarkDenoiser(Figures& figures);
void benchmarkLatency(Figures& figures);
void benchmarkLoop(Figures& figures);
void benchmarkMap(Figures& figures);
void benchmarkMetrics(Figures& figures);
void benchmarkPlanner(Figures& figures);
/// Where the benchmarks are built with ROS.
void benchmarkReplay(Figures& figures);

}  // namespace cdiff::benchmark
