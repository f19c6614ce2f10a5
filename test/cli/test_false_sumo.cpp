// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// A program that is called sumo and answers what no SUMO does.
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/cdiff_command.h"
#include "core/text.h"

namespace cdiff::cli {
namespace {

namespace fs = std::filesystem;

class FalseSumo : public test::CdiffCommand {
 protected:
  FalseSumo() : path_before_(std::getenv("PATH")) {}
  ~FalseSumo() override { ::setenv("PATH", path_before_.c_str(), 1); }

  /// A program sumo that takes one client, whose commands in Python then are `body`.
  void install(const std::string& body) const {
    const std::string program = path("bin") + "/sumo";
    fs::create_directory(path("bin"));
    core::writeFileAtomically(program, R"(#!/usr/bin/python3
import socket, subprocess, sys, time
place = sys.argv.index("--remote-port") + 1
server = socket.create_server(("127.0.0.1", int(sys.argv[place])))
)" + body + R"(
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

const std::string kFirstRequest = R"(client, _ = server.accept()
client.recv(4096)
)";

TEST_F(FalseSumo, AnAnswerWithoutLengthIsAnErrorOfTheSimulator) {
  install(kFirstRequest + "client.sendall(bytes(4))");
  expectErrorOfTheSimulator();
}

TEST_F(FalseSumo, AnAnswerThatIsNoneIsAnErrorOfTheSimulator) {
  install(kFirstRequest + "client.sendall(bytes([0, 0, 0, 64]) + bytes([255]) * 60)");
  expectErrorOfTheSimulator();
}

/// Passes the true SUMO's answers on until simulated seconds have passed.
const std::string kPassesOn = R"(
with socket.create_server(("127.0.0.1", 0)) as probe:
    port = probe.getsockname()[1]
sumo = subprocess.Popen(["/usr/bin/sumo", *sys.argv[1:place], str(port), *sys.argv[place + 1:]])
while True:
    try:
        real = socket.create_connection(("127.0.0.1", port))
        break
    except ConnectionRefusedError:
        time.sleep(0.02)
client, _ = server.accept()

def whole(source):
    text = b""
    while len(text) < 4 or len(text) < int.from_bytes(text[:4], "big"):
        text += source.recv(65536) or sys.exit(0)
    return text

for _ in range(1200):
    real.sendall(whole(client))
    client.sendall(whole(real))
)";

TEST_F(FalseSumo, AnAnswerWithoutLengthLaterLeavesTheTraceUntilThen) {
  install(kPassesOn + "whole(client)\nclient.sendall(bytes(4))\nsumo.kill()");
  expectErrorOfTheSimulator();
  const auto trace = core::readFile(path("results") + "/trace_cut_off.csv", "trace");
  EXPECT_GT(core::splitText(trace, '\n').size(), 10U);
}

/// From then on variables of this number and type have no number (the first, where it has several).
std::string withoutNumber(const std::string& variable_and_type) {
  return kPassesOn + "import re\nwhile True:\n    real.sendall(whole(client))\n" +
         "    client.sendall(re.sub(rb'(?s)(" + variable_and_type +
         ").{8}', lambda found: found[1] + bytes([127, 248]) + bytes(6), whole(real)))";
}

TEST_F(FalseSumo, AVehiclesStateThatIsNoNumberIsAnErrorOfTheSimulator) {
  const std::string speed = "\\x40\\x00\\x0b";
  const std::string angle = "\\x43\\x00\\x0b";
  const std::string position = "\\x39\\x00\\x03";
  for (const std::string& variable : {speed, angle, position}) {
    install(withoutNumber(variable));
    expectErrorOfTheSimulator();
    expectOutput("nan");
    fs::remove_all(path("results"));
  }
}

}  // namespace
}  // namespace cdiff::cli
