// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <CLI/CLI.hpp>
#include <cstdlib>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>

#include "benchmark.h"
#include "core/file.h"
#include "core/program.h"
#include "core/scratch_folder.h"
#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::benchmark {

std::filesystem::path dataFolder() {
  const char* given = std::getenv("E2E_CDIFF_DATA");
  const std::filesystem::path folder =
      given ? given : core::shareFolder() / ".." / "shared" / "data";
  if (std::filesystem::is_directory(folder / "carla_towns")) return folder;
  throw core::InputError(
      "the real networks are not in '" + folder.string() +
      "'; set E2E_CDIFF_DATA to the folder that holds carla_towns and bench2drive");
}

namespace {

void print(const Figures& figures) {
  for (const Figure& figure : figures) {
    std::cout << figure.name << " " << core::formatFixed(figure.value, 3) << " " << figure.unit
              << " " << (figure.goal.empty() ? "-" : figure.goal) << "\n";
  }
}

void writeJson(const Figures& figures, const std::string& file) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Figure& figure : figures) {
    list.push_back({{"figure", figure.name},
                    {"value", figure.value},
                    {"unit", figure.unit},
                    {"goal", figure.goal}});
  }
  core::writeFileAtomically(file, list.dump(2) + "\n");
}

int run(const std::string& name, const std::string& json) {
  std::map<std::string, void (*)(Figures&)> known = {
      {"camera", benchmarkCamera},     {"challenge", benchmarkChallenge},
      {"denoiser", benchmarkDenoiser}, {"encoder", benchmarkEncoder},
      {"latency", benchmarkLatency},   {"loop", benchmarkLoop},
      {"map", benchmarkMap},           {"metrics", benchmarkMetrics},
      {"planner", benchmarkPlanner}};
#ifdef E2E_CDIFF_WITH_ROS
  known["replay"] = benchmarkReplay;
#endif
  if (!name.empty() && known.count(name) == 0) {
    std::vector<std::string> names;
    for (const auto& entry : known) names.push_back(entry.first);
    throw core::InputError("no benchmark '" + name + "'; known: " + core::joinText(names, ", "));
  }
  const core::ScratchFolder cache;  // the user's own stays as it is
  ::setenv("E2E_CDIFF_CACHE", cache.path().c_str(), 1);
  Figures figures;
  for (const auto& [known_name, benchmark] : known) {
    if (name.empty() || name == known_name) benchmark(figures);
  }
  print(figures);
  if (!json.empty()) writeJson(figures, json);
  return 0;
}

}  // namespace
}  // namespace cdiff::benchmark

int main(int argc, char** argv) {
  cdiff::core::prepareProgram();
  CLI::App program{"Benchmarks; prints `figure value unit goal`"};
  std::string name;
  std::string json;
  program.add_option("name", name, "Benchmark (default: all)");
  program.add_option("--json", json, "Also write the figures to this file");
  CLI11_PARSE(program, argc, argv);
  try {
    return cdiff::benchmark::run(name, json);
  } catch (const cdiff::core::InputError& error) {
    std::cerr << "benchmark: " << error.what() << "\n";
    return 3;
  } catch (const std::exception& error) {
    std::cerr << "benchmark: " << error.what() << "\n";
    return 2;
  }
}
