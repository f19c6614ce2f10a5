// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// SUMO dies, freezes, refuses or is missing: every case is an error that says so and leaves
// no process behind.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "e2e_cdiff/core/exceptions.h"
#include "simulation/crossing_world.h"
#include "simulation/traci_link.h"

namespace cdiff {
namespace {

using simulation::SumoOptions;
using simulation::SumoSession;
using simulation::SumoSimulator;
using test::CrossingWorld;

double secondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool exists(int process_id) { return ::kill(process_id, 0) == 0; }

/// Text of the SimulatorError of a step; empty when there is none.
std::string stepError(SumoSimulator& simulator) {
  try {
    simulator.step({});
  } catch (const core::SimulatorError& error) {
    return error.what();
  }
  return "";
}

TEST(SumoLoss, KilledIsReportedBeforeTheStepTimeout) {
  SumoOptions options;
  options.step_timeout = 200.0;
  CrossingWorld world(false, 1, options);
  world.simulator().step({});
  const int process = world.simulator().processId();
  ASSERT_TRUE(exists(process));
  ASSERT_EQ(::kill(process, SIGKILL), 0);
  const auto start = std::chrono::steady_clock::now();
  const std::string error = stepError(world.simulator());
  EXPECT_LT(secondsSince(start), options.step_timeout);
  EXPECT_NE(error.find("signal 9"), std::string::npos) << error;
  // Further calls write to a closed socket: errors again, and no SIGPIPE.
  EXPECT_NE(stepError(world.simulator()), "");
  EXPECT_THROW(world.simulator().remove("ours"), core::SimulatorError);
  world.close();
  EXPECT_FALSE(exists(process));
}

TEST(SumoLoss, FrozenIsEndedAndReported) {
  SumoOptions options;
  options.step_timeout = 1.0;
  CrossingWorld world(false, 1, options);
  world.simulator().step({});
  const int process = world.simulator().processId();
  ASSERT_EQ(::kill(process, SIGSTOP), 0);
  const auto start = std::chrono::steady_clock::now();
  const std::string error = stepError(world.simulator());
  EXPECT_GE(secondsSince(start), 0.9);
  EXPECT_NE(error.find("did not answer for 1 s"), std::string::npos) << error;
  world.close();
  EXPECT_FALSE(exists(process));
}

TEST(SumoLoss, SumoEndsWithUsWhenWeAreKilled) {
  int channel[2];
  ASSERT_EQ(::pipe(channel), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    CrossingWorld world;
    const int process = world.simulator().processId();
    if (::write(channel[1], &process, sizeof(process)) != sizeof(process)) ::_exit(1);
    ::kill(::getpid(), SIGKILL);
  }
  int process = 0;
  ASSERT_EQ(::read(channel[0], &process, sizeof(process)), static_cast<ssize_t>(sizeof(process)));
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFSIGNALED(status));
  const auto start = std::chrono::steady_clock::now();
  while (exists(process) && secondsSince(start) < 60.0)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  EXPECT_FALSE(exists(process));
  ::close(channel[0]);
  ::close(channel[1]);
}

TEST(SumoLoss, AnotherSimulatorStartsAfterALoss) {
  {
    CrossingWorld world;
    ::kill(world.simulator().processId(), SIGKILL);
    EXPECT_NE(stepError(world.simulator()), "");
  }
  CrossingWorld world;
  world.simulator().step({});
  EXPECT_TRUE(world.simulator().vehicles().empty());
}

TEST(SumoSessions, OneAfterTheOtherAndSideBySide) {
  int first_process = 0;
  {
    CrossingWorld world;
    first_process = world.simulator().processId();
    EXPECT_EQ(world.simulator().version().substr(0, 4), "SUMO");
    world.simulator().step({});
  }
  EXPECT_FALSE(exists(first_process));
  CrossingWorld left;
  CrossingWorld right;
  const traffic::VehicleDimensions car;
  ASSERT_TRUE(left.simulator().addBackground("car", {"west", "east"}, 50.0, 0, 8.0, car));
  left.simulator().step({});
  right.simulator().step({});
  EXPECT_EQ(left.simulator().vehicles().size(), 1U);
  EXPECT_TRUE(right.simulator().vehicles().empty());
}

/// Text of the error of a start; the type is the caller's.
template <class Error>
std::string startError(const SumoOptions& options, const SumoSession& session,
                       const map::RoadNetwork& network) {
  try {
    const SumoSimulator simulator(options, session, network);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(SumoStart, NamesAMissingProgram) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoOptions options;
  options.binary = "sumo_of_nowhere";
  SumoSession session;
  session.network_file = made.file;
  const std::string error = startError<core::InputError>(options, session, made.network);
  EXPECT_NE(error.find("sumo_of_nowhere"), std::string::npos) << error;
  EXPECT_NE(error.find("install the package sumo"), std::string::npos) << error;
}

/// Of a start with a program of this text in the place of SUMO.
std::string startErrorOf(const std::string& program) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.network_file = made.file;
  SumoOptions options;
  options.binary = (folder.path() / "not_sumo").string();
  std::ofstream(options.binary) << program;
  std::filesystem::permissions(options.binary, std::filesystem::perms::owner_all);
  return startError<core::SimulatorError>(options, session, made.network);
}

TEST(SumoStart, QuotesLittleOfWhatSumoPrintsAndNoControlCharacters) {
  const std::string error = startErrorOf(
      "#!/bin/sh\nhead -c 20000000 /dev/zero | tr '\\0' 'x' >&2\n"
      "printf '\\nthe \\033[31mlast words\\n' >&2\nexit 1\n");
  EXPECT_NE(error.find("last words"), std::string::npos) << error;
  EXPECT_EQ(error.find('\033'), std::string::npos) << error;
  EXPECT_LT(error.size(), 2000U);
}

// A socket that connects to itself is connected without ever having listened.
TEST(SumoStart, SaysThatAnotherProgramConnectedFirst) {
  const std::string error = startErrorOf(
      "#!/usr/bin/python3\nimport socket, sys, time\n"
      "own = ('127.0.0.1', int(sys.argv[sys.argv.index('--remote-port') + 1]))\n"
      "link = socket.socket()\nlink.bind(own)\nlink.connect(own)\ntime.sleep(60)\n");
  EXPECT_NE(error.find("another program connected to SUMO before this one"), std::string::npos)
      << error;
}

/// Starts with a program that does this in Python the first time and is SUMO from then on.
void startBehind(const std::string& first) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.network_file = made.file;
  SumoOptions options;
  options.binary = (folder.path() / "late_sumo").string();
  std::ofstream(options.binary)
      << "#!/usr/bin/python3\nimport os, socket, sys, time\n"
         "try:\n    os.mkdir(sys.argv[0] + '.started')\nexcept FileExistsError:\n"
         "    os.execv('/usr/bin/sumo', ['sumo', *sys.argv[1:]])\n"
         "port = int(sys.argv[sys.argv.index('--remote-port') + 1])\n"
      << first;
  std::filesystem::permissions(options.binary, std::filesystem::perms::owner_all);
  SumoSimulator simulator(options, session, made.network);
  simulator.step({});
  EXPECT_TRUE(simulator.vehicles().empty());
}

// What SUMO 1.15 does with a client that connects first and then goes, or sends what is no request.
TEST(SumoStart, TriesAgainWhereAnotherClientEndedSumo) {
  startBehind("sys.exit('Error: tcpip::Socket::recvAndCheck @ recv: peer shutdown')\n");
  startBehind("sys.exit('Error: Storage::readChar(): invalid position')\n");
  startBehind(
      "print('sumo: ./src/foreign/tcpip/socket.cpp:547: bool '\n"
      "      'tcpip::Socket::receiveExact(tcpip::Storage&): Assertion `totalLen > lengthLen\\' '\n"
      "      'failed.', flush=True)\nos.abort()\n");
}

TEST(SumoStart, TriesAgainWhereSumoServesAnotherClient) {
  startBehind(
      "server = socket.create_server(('127.0.0.1', port))\n"
      "link, _ = server.accept()\nlink.close()\n"
      "other = socket.create_connection(('127.0.0.1', port))\nkept, _ = server.accept()\n"
      "server.close()\ntime.sleep(60)\n");
  startBehind(
      "server = socket.create_server(('127.0.0.1', port))\n"
      "link, _ = server.accept()\nlink.close()\nserver.close()\n"
      "sys.exit('Error: tcpip::Socket::recvAndCheck @ recv: peer shutdown')\n");
}

TEST(SumoStart, NamesAMissingNetwork) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.network_file = folder.path() / "none.net.xml";
  const std::string error = startError<core::InputError>({}, session, made.network);
  EXPECT_NE(error.find("none.net.xml"), std::string::npos) << error;
}

/// SUMO as a process, and in this one.
class SumoRefusals : public testing::TestWithParam<const char*> {};

INSTANTIATE_TEST_SUITE_P(ByLink, SumoRefusals, testing::Values("libtraci", "libsumo"));

TEST_P(SumoRefusals, NameTheNetworkOrDemandAndQuoteSumo) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.link = GetParam();
  session.network_file = folder.path() / "broken.net.xml";
  session.demand_file = folder.path() / "bad.rou.xml";
  std::ofstream(session.network_file) << "<net><edge id=\"a\" from=\"x\"/></net>";
  std::ofstream(session.demand_file) << "<routes/>";
  std::string error = startError<core::InputError>({}, session, made.network);
  EXPECT_NE(error.find("SUMO refuses the network '" + session.network_file.string() + "': "),
            std::string::npos)
      << error;
  session.network_source = "town.xodr";  // the file is in the cache
  error = startError<core::InputError>({}, session, made.network);
  EXPECT_NE(error.find("the network 'town.xodr': "), std::string::npos) << error;
  session.network_file = made.file;
  // Later than any session: SUMO reads all of it before the first step.
  std::ofstream(session.demand_file)
      << "<routes><trip id=\"t\" depart=\"9000\" from=\"west\" to=\"nowhere\"/></routes>";
  error = startError<core::InputError>({}, session, made.network);
  EXPECT_NE(error.find("SUMO refuses the demand '" + session.demand_file.string() + "': "),
            std::string::npos)
      << error;
  EXPECT_NE(error.find("nowhere"), std::string::npos) << error;
}

TEST_P(SumoRefusals, NameADemandThatSumoRefusesWhileItRuns) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.link = GetParam();
  session.network_file = made.file;
  session.demand_file = folder.path() / "late.rou.xml";
  // A lane that its edge does not have is noticed at the departure.
  std::ofstream(session.demand_file)
      << "<routes><route id=\"r\" edges=\"west east\"/><vehicle id=\"late_one\" depart=\"1\" "
         "route=\"r\" departLane=\"7\"/></routes>";
  std::string text;
  try {
    SumoSimulator simulator({}, session, made.network);
    for (int i = 0; i < 40; ++i) simulator.step({});
  } catch (const core::InputError& error) {
    text = error.what();
  }
  EXPECT_NE(text.find("late.rou.xml': "), std::string::npos) << text;
  EXPECT_NE(text.find("'late_one'"), std::string::npos) << text;
}

TEST(SumoStart, ReadsDemandAndBeginTime) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  SumoSession session;
  session.network_file = made.file;
  session.begin_time = 3600.0;
  session.demand_file = folder.path() / "demand.rou.xml";
  std::ofstream(session.demand_file)
      << "<routes><vType id=\"van\" length=\"6\" width=\"2\" height=\"2.5\"/>"
         "<vehicle id=\"v\" type=\"van\" depart=\"3600\" departPos=\"50\"><route edges=\"west "
         "east\"/></vehicle></routes>";
  SumoSimulator simulator({}, session, made.network);
  simulator.step({});
  simulator.step({});
  ASSERT_EQ(simulator.vehicles().size(), 1U);
  const simulation::SimulatedVehicle& van = simulator.vehicles().front();
  EXPECT_EQ(van.id, "v");
  EXPECT_DOUBLE_EQ(van.dimensions.length, 6.0);
  EXPECT_DOUBLE_EQ(van.dimensions.width, 2.0);
  EXPECT_DOUBLE_EQ(van.dimensions.height, 2.5);
  // The front bumper departs at 50 m of the edge that starts at x = -200 m; the center is 3 m
  // behind.
  EXPECT_NEAR(van.state.position.x(), -153.0, 0.2);
  EXPECT_NEAR(van.state.position.y(), -1.6, 1e-6);
}

/// A socket that listens on a port of its own for as long as it exists.
class TakenPort {
 public:
  TakenPort() : handle_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_ANY);
    socklen_t size = sizeof(address);
    EXPECT_EQ(::bind(handle_, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(handle_, 1), 0);
    EXPECT_EQ(::getsockname(handle_, reinterpret_cast<sockaddr*>(&address), &size), 0);
    number_ = ntohs(address.sin_port);
  }
  ~TakenPort() { ::close(handle_); }
  TakenPort(const TakenPort&) = delete;
  TakenPort& operator=(const TakenPort&) = delete;
  int number() const { return number_; }

 private:
  int handle_;
  int number_ = 0;
};

TEST(SumoStart, TakesAnotherPortWhenOneIsTaken) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  const TakenPort taken;
  int asked = 0;
  simulation::SumoCommand command;
  command.arguments = {"--net-file", made.file.string(), "--xml-validation", "never"};
  command.choose_port = [&] { return ++asked <= 2 ? taken.number() : simulation::freePort(); };
  const simulation::SumoProcess process(command);
  EXPECT_EQ(asked, 3);
  EXPECT_NE(process.port(), taken.number());
  EXPECT_TRUE(simulation::listensOn(process.process().id(), process.port()));
  EXPECT_FALSE(
      simulation::listensOn(process.process().id(), taken.number()));  // listens, but is ours
}

TEST(SumoStart, GivesUpAfterFiveTakenPorts) {
  const test::TemporaryFolder folder;
  const test::SumoNetwork made = test::makeCrossing(folder, false);
  const TakenPort taken;
  int asked = 0;
  simulation::SumoCommand command;
  command.arguments = {"--net-file", made.file.string(), "--xml-validation", "never"};
  command.choose_port = [&] { return ++asked, taken.number(); };
  EXPECT_THROW(simulation::SumoProcess{command}, core::SimulatorError);
  EXPECT_EQ(asked, 5);
}

}  // namespace
}  // namespace cdiff
