// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "record/build_info.h"

#include <Eigen/Core>
#include <fstream>
#include <nlohmann/json.hpp>

#ifndef E2E_CDIFF_VERSION
#define E2E_CDIFF_VERSION "unknown"
#endif
#ifndef E2E_CDIFF_REVISION
#define E2E_CDIFF_REVISION "unknown"
#endif
#ifndef E2E_CDIFF_YAML_CPP_VERSION
#define E2E_CDIFF_YAML_CPP_VERSION "unknown"
#endif

namespace cdiff::record {
namespace {

std::string dotted(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

std::string compilerVersion() {
#if defined(__clang__)
  return __VERSION__;
#else
  return "GCC " __VERSION__;
#endif
}

}  // namespace

std::string packageVersion() { return E2E_CDIFF_VERSION; }

std::string packageRevision() { return E2E_CDIFF_REVISION; }

std::vector<std::pair<std::string, std::string>> libraryVersions() {
  return {{"eigen", dotted(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)},
          {"yaml_cpp", E2E_CDIFF_YAML_CPP_VERSION},
          {"nlohmann_json", dotted(NLOHMANN_JSON_VERSION_MAJOR, NLOHMANN_JSON_VERSION_MINOR,
                                   NLOHMANN_JSON_VERSION_PATCH)},
          {"compiler", compilerVersion()}};
}

std::string processorModel() {
  std::ifstream stream("/proc/cpuinfo");
  const std::string key = "model name";
  for (std::string line; std::getline(stream, line);) {
    if (line.compare(0, key.size(), key) != 0) continue;
    const std::size_t begin = line.find_first_not_of(" \t", line.find(':') + 1);
    return begin == std::string::npos ? "unknown" : line.substr(begin);
  }
  return "unknown";
}

std::string instructionSet() {
#if defined(__AVX512F__)
  return "x86-64 with AVX-512";
#elif defined(__AVX2__)
  return "x86-64 with AVX2";
#elif defined(__AVX__)
  return "x86-64 with AVX";
#elif defined(__x86_64__)
  return "x86-64 baseline";
#elif defined(__aarch64__)
  return "aarch64";
#else
  return "unknown";
#endif
}

}  // namespace cdiff::record
