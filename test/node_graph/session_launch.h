// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Whole sessions through roslaunch with a real SUMO, each with a master of its own on a free port.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "node_graph/recorded_bag.h"

namespace cdiff {

namespace fs = std::filesystem;

inline nlohmann::json summaryIn(const fs::path& folder) {
  return nlohmann::json::parse(core::readFile(folder / "summary.json", "summary"));
}

class Session : public ::testing::Test {
 protected:
  Session()
      : folder_(fs::temp_directory_path() /
                ("e2e_cdiff_session_test_" + std::to_string(::getpid()))) {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Session() override { fs::remove_all(folder_); }

  /// roslaunch of a launch file with arguments; answers its output. Results go to folder_ / "ros".
  /// `beside`: a command that runs while the session does, which is interrupted after it.
  std::string launch(const std::string& file, const std::string& arguments,
                     const std::string& beside = "") {
    const std::string find_port =
        "port=$(/usr/bin/python3 -c 'import socket; s = socket.socket(); s.bind((\"127.0.0.1\", "
        "0)); print(s.getsockname()[1])')";
    const std::string command =
        find_port + "; export PATH=/usr/bin:$PATH ROS_IP=127.0.0.1 ROS_HOME=" + folder_.string() +
        "/home ROS_MASTER_URI=http://127.0.0.1:$port; " + (beside.empty() ? "exec " : "") +
        "timeout -s INT 300 " E2E_CDIFF_DEVEL "/env.sh roslaunch -p $port " + file +
        " results:=" + results().string() + " " + arguments + " > " + log().string() + " 2>&1" +
        (beside.empty() ? ""
                        : " & launch=$!; " E2E_CDIFF_DEVEL "/env.sh " + beside +
                              "; kill -INT $launch; wait $launch; true");
    EXPECT_EQ(std::system(("bash -c '" + escaped(command) + "'").c_str()), 0);
    return core::readFile(log(), "log");
  }

  fs::path results() const { return folder_ / "ros"; }
  fs::path log() const { return folder_ / "log"; }
  nlohmann::json summary() const { return summaryIn(results()); }
  /// Source of the last fault; empty when there is none.
  std::string lastFaultSource() const {
    const nlohmann::json faults = summary()["faults"];
    return faults.empty() ? "" : faults.back()["source"].get<std::string>();
  }
  std::string exitCode() const { return core::readFile(results() / "exit_code", "exit code"); }

  fs::path folder_;

 private:
  static std::string escaped(const std::string& text) {
    std::string result;
    for (const char character : text)
      result += character == '\'' ? std::string("'\\''") : std::string(1, character);
    return result;
  }
};

/// The trace of the same session in one process.
inline std::string traceInOneProcess(const session::SessionRequest& request,
                                     const fs::path& folder) {
  test::runInOneProcess(request, folder);
  return core::sha256(core::readFile(folder / "trace.csv", "trace"));
}

/// What a summary says whatever the clock on the wall does.
inline nlohmann::json withoutWallClock(nlohmann::json summary) {
  summary.erase("wall_seconds");
  summary.erase("real_time_factor");
  for (auto& [planner, measures] : summary["planner_latency_ms"].items())
    measures = {{"n", measures["n"]}};
  return summary;
}

/// The data: URIs of the images that a report shows.
inline std::vector<std::string> picturesIn(const fs::path& folder) {
  const std::string report = core::readFile(folder / "report.html", "report");
  std::vector<std::string> pictures;
  const std::string begin = "data:image/png;base64,";
  for (std::size_t at = report.find(begin); at != std::string::npos;
       at = report.find(begin, at + 1))
    pictures.push_back(report.substr(at, report.find('"', at) - at));
  return pictures;
}

/// Number of messages by topic.
inline std::map<std::string, int> countsIn(const fs::path& bag_file) {
  std::map<std::string, int> counts;
  rosbag::Bag bag(bag_file.string(), rosbag::bagmode::Read);
  for (const rosbag::MessageInstance& message : rosbag::View(bag)) ++counts[message.getTopic()];
  return counts;
}

/// `metrics` of a summary as it is written.
inline std::string metricsTextIn(const fs::path& folder) {
  const std::string text = core::readFile(folder / "summary.json", "summary");
  const std::size_t begin = text.find("\n  \"metrics\":");
  return text.substr(begin, text.find("\n  \"planner_latency_ms\"", begin) - begin);
}

/// Expects the result of a replay to be the live one but for what the wall clock says.
inline void expectSameResult(const fs::path& replayed, const fs::path& live) {
  EXPECT_NE(metricsTextIn(live), "");
  EXPECT_EQ(metricsTextIn(replayed), metricsTextIn(live));
  nlohmann::json both[2] = {summaryIn(replayed), summaryIn(live)};
  for (nlohmann::json& summary : both) {
    summary.erase("wall_seconds");
    summary.erase("real_time_factor");
  }
  EXPECT_EQ(both[0], both[1]);
  EXPECT_EQ(core::sha256(core::readFile(replayed / "trace.csv", "trace")),
            core::sha256(core::readFile(live / "trace.csv", "trace")));
  EXPECT_EQ(picturesIn(replayed), picturesIn(live));
}

}  // namespace cdiff
