// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A program that is called sumo and answers what no SUMO does.
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class FalseSumo : public test::CdiffCommand {
 protected:
  FalseSumo() : path_before_(std::getenv("PATH")) {}
  ~FalseSumo() override { ::setenv("PATH", path_before_.c_str(), 1); }

  /// A program sumo that takes one client and sends `answer`, a Python expression, to its request.
  void install(const std::string& answer) const {
    const std::string program = path("bin") + "/sumo";
    fs::create_directory(path("bin"));
    core::writeFileAtomically(program, R"(#!/usr/bin/python3
import socket, sys, time
port = int(sys.argv[sys.argv.index("--remote-port") + 1])
server = socket.create_server(("127.0.0.1", port))
client, _ = server.accept()
client.recv(4096)
client.sendall()" + answer + R"()
time.sleep(60)
)");
    fs::permissions(program, fs::perms::owner_all);
    ::setenv("PATH", (path("bin") + ":" + path_before_).c_str(), 1);
  }
  void expectErrorOfTheSimulator() const {
    const std::string results = path("results");
    EXPECT_EQ(cdiff({"run", "crossing_straight", "--results", results}), 2) << output();
    expectOutput("SUMO");
    const auto summary =
        nlohmann::json::parse(core::readFile(results + "/summary.json", "summary"));
    EXPECT_EQ(summary["status"], "error");
    EXPECT_EQ(summary["faults"].back()["source"], "simulator");
    EXPECT_TRUE(fs::exists(results + "/report.html"));
  }

 private:
  std::string path_before_;
};

TEST_F(FalseSumo, AnAnswerWithoutLengthIsAnErrorOfTheSimulator) {
  install("bytes(4)");
  expectErrorOfTheSimulator();
}

TEST_F(FalseSumo, AnAnswerThatIsNoneIsAnErrorOfTheSimulator) {
  install("bytes([0, 0, 0, 64]) + bytes([255]) * 60");
  expectErrorOfTheSimulator();
}

}  // namespace
}  // namespace cdiff::cli
