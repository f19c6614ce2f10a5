// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The command `cdiff doctor`: checks what a session needs and says how to mend it.
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iostream>
#include <vector>

#include "cli/commands.h"
#include "core/file.h"
#include "core/guarded_process.h"
#include "diffusion/network/cpu_denoiser.h"
#include "inference/precision.h"
#include "plugins/plugin_loader.h"
#include "session/scenario_options.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

struct Finding {
  bool good = true;
  std::string subject;
  std::string text;  ///< what was found, or how to mend it
};

bool inPath(const std::string& program) { return core::programInPath(program).has_value(); }

Finding program(const std::string& name, const std::string& package) {
  const bool found = inPath(name);
  return {found, name, found ? "found" : "missing: apt-get install " + package};
}

/// Only videos need it.
Finding encoder() {
  return {true, "ffmpeg",
          inPath("ffmpeg") ? "found" : "missing: no videos; to have them, apt-get install ffmpeg"};
}

Finding plugIns() {
  try {
    std::string text;
    for (const plugins::LoadedPlugin& plugin : plugins::loadPlugins())
      text += (text.empty() ? "" : ", ") + plugin.library.file.string();
    return {true, "plug-ins", text.empty() ? "none" : text};
  } catch (const std::exception& error) {
    return {false, "plug-ins", error.what()};
  }
}

Finding folder(const std::string& subject, const std::function<fs::path()>& find) {
  try {
    const fs::path path = find();
    const bool writable = subject != "cache folder" || ::access(path.c_str(), W_OK) == 0;
    return {writable, subject,
            path.string() + (writable ? "" : " is not writable: set E2E_CDIFF_CACHE")};
  } catch (const std::exception& error) {
    return {false, subject, error.what()};
  }
}

/// The shipped model, and what computes with it on this machine.
Finding shippedModel() {
  try {
    diffusion::loadModel("default");
    return {true, "planner model",
            "default (" + diffusion::modelFilesSha256("default").substr(0, 12) +
                "), encoder with " + inference::oneDnnInstructionSet("auto") + ", denoiser with " +
                diffusion::CpuDenoiser::toText(diffusion::CpuDenoiser::bestInstructionSet())};
  } catch (const std::exception& error) {
    return {false, "planner model", error.what()};
  }
}

/// A folder that exists, with the type maps that imports need.
Finding sumoHome() {
  const char* given = std::getenv("SUMO_HOME");
  const fs::path used = core::sumoHome();
  if (given != nullptr && used == given) return {true, "SUMO_HOME", used.string()};
  return {true, "SUMO_HOME",
          (given == nullptr ? "not set" : "'" + std::string(given) + "' is no folder") +
              std::string(": SUMO's programs are started with ") + used.string()};
}

Finding rosIp() {
  const char* ip = std::getenv("ROS_IP");
  const bool good = ip != nullptr && std::string(ip) == "127.0.0.1";
  return {true, "ROS_IP",
          good ? "127.0.0.1"
               : "not 127.0.0.1: ROS nodes can be reached from the network; see scripts/isolated"};
}

}  // namespace

void addDoctorCommand(CLI::App& program_app, int& exit_code) {
  CLI::App* command =
      program_app.add_subcommand("doctor", "Check what a session needs and say how to mend it");
  command->callback([&exit_code] {
    const std::vector<Finding> findings = {program("sumo", "sumo"),
                                           program("netconvert", "sumo"),
                                           program("roslaunch", "python3-roslaunch"),
                                           sumoHome(),
                                           folder("package share", core::shareFolder),
                                           folder("cache folder", core::cacheFolder),
                                           folder("temporary folder", core::temporaryFolder),
                                           shippedModel(),
                                           plugIns(),
                                           encoder(),
                                           rosIp()};
    for (const Finding& finding : findings) {
      std::cout << (finding.good ? "ok    " : "wrong ") << finding.subject << ": " << finding.text
                << "\n";
      if (!finding.good) exit_code = ExitCode::kRunTimeError;
    }
    std::cout << "shipped scenarios: " << session::shippedScenarios().size() << "\n";
  });
}

}  // namespace cdiff::cli
