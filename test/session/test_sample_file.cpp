// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include <gtest/gtest.h>

#include "core/file.h"
#include "e2e_cdiff/core/exceptions.h"
#include "session/session_request.h"
#include "support/temporary_folder.h"

namespace cdiff::session {
namespace {

class SampleFile : public ::testing::Test {
 protected:
  std::filesystem::path file(const std::string& content) {
    core::writeFileAtomically(folder_.path() / "speeds", content);
    return folder_.path() / "speeds";
  }
  std::string errorOf(const std::string& content) {
    try {
      readSamples(file(content));
    } catch (const core::InputError& error) {
      return error.what();
    }
    return {};
  }
  test::TemporaryFolder folder_;
};

TEST_F(SampleFile, HoldsOneNumberALine) {
  EXPECT_EQ(readSamples(file("# m/s\n1.5\r\n\n  2 # slow\n-0.5")),
            (std::vector<double>{1.5, 2.0, -0.5}));
}

TEST_F(SampleFile, OrTheCasesOfCdiffMetric) {
  EXPECT_EQ(readSamples(file(R"({"cases": [{"x": [1, 2.5]}, {"kind": "b", "x": [3]}]})")),
            (std::vector<double>{1.0, 2.5, 3.0}));
}

TEST_F(SampleFile, ErrorsNameFileAndPlace) {
  EXPECT_NE(errorOf("1\n2\nfast\n").find("speeds:3: \"fast\", expected one finite number"),
            std::string::npos);
  EXPECT_NE(errorOf("1\nnan\n").find("speeds:2:"), std::string::npos);
  EXPECT_NE(errorOf("1\n2 3\n").find("speeds:2:"), std::string::npos);
  EXPECT_NE(errorOf("# nothing\n").find("holds no sample"), std::string::npos);
  EXPECT_NE(errorOf("{\"cases\": [\n").find("line 2"), std::string::npos);
  EXPECT_NE(errorOf("{\"x\": [1]}").find("\"cases\""), std::string::npos);
  EXPECT_NE(errorOf("{\"cases\": [{\"x\": [1]}, {\"y\": [1]}]}").find("case 2"), std::string::npos);
  EXPECT_NE(errorOf("{\"cases\": [{\"x\": [1, null]}]}").find("holds null"), std::string::npos);
  EXPECT_THROW(readSamples("/nowhere/speeds"), core::InputError);
}

TEST_F(SampleFile, TravelsInTheResolvedScenario) {
  const std::string path = file("3\n4.25\n").string();
  SessionRequest request;
  request.scenario = "crossing_straight";
  request.set = {"metrics.speed_target=file", "metrics.speed_target_file=" + path};
  const ScenarioOptions options = resolveRequest(request);
  EXPECT_EQ(options.metrics.samples(), (std::vector<double>{3.0, 4.25}));
  // What a recording holds needs no file.
  ScenarioOptions back;
  core::loadOptions({"recording", core::dumpOptions(options)}, back);
  EXPECT_EQ(back.metrics.samples(), options.metrics.samples());
  EXPECT_EQ(core::dumpOptions(back), core::dumpOptions(options));
}

TEST_F(SampleFile, IsFoundBesideTheScenario) {
  file("5\n");
  const std::string text = core::readFile(
      core::shareFolder() / "config" / "scenarios" / "crossing_straight.yaml", "scenario");
  core::writeFileAtomically(folder_.path() / "mine.yaml",
                            text + "\nmetrics: {speed_target: file, speed_target_file: speeds}\n");
  SessionRequest request;
  request.scenario = (folder_.path() / "mine.yaml").string();
  EXPECT_EQ(resolveRequest(request).metrics.samples(), std::vector<double>{5.0});
}

TEST_F(SampleFile, IsAskedForByTheTarget) {
  SessionRequest request;
  request.scenario = "crossing_straight";
  request.set = {"metrics.speed_target=file"};
  try {
    resolveRequest(request);
    FAIL() << "expected an InputError";
  } catch (const core::InputError& error) {
    EXPECT_NE(std::string(error.what()).find("metrics.speed_target_file"), std::string::npos);
  }
  request.set = {"metrics.speed_target=nromal"};
  EXPECT_THROW(resolveRequest(request), core::InputError);
}

}  // namespace
}  // namespace cdiff::session
