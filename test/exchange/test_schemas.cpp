// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
// Exports are valid against the schemas that scripts/fetch_schemas fetched; skipped where they or
// xmllint are missing.
#include <gtest/gtest.h>

#include "core/guarded_process.h"
#include "exchange/commonroad_writer.h"
#include "exchange/openscenario_writer.h"
#include "exchange/recorded_session.h"
#include "support/program_run.h"

namespace cdiff::exchange {
namespace {

class Schemas : public testing::Test {
 protected:
  void expectValid(const std::string& text, const std::string& name) const {
    const auto schema = core::cacheFolder() / "schemas" / name;
    if (!core::isFile(schema)) GTEST_SKIP() << schema << " is missing: run scripts/fetch_schemas";
    const auto xmllint = core::programInPath("xmllint");
    if (!xmllint) GTEST_SKIP() << "xmllint is missing: install libxml2-utils";
    const auto file = session_.path("export.xml");
    const auto output = session_.path("output");
    core::writeFileAtomically(file, text);
    test::ProgramRun run(xmllint->string(), {"--noout", "--schema", schema.string(), file.string()},
                         output);
    EXPECT_EQ(run.wait(), 0) << core::readFile(output, "output");
  }
  test::RecordedSession session_;
};

TEST_F(Schemas, OpenScenario) {
  const RecordedScene scene = readScene(session_.folder(), {0.0, {}, "all"});
  expectValid(openScenarioText(scene, "a.xodr", ExportedEgo::kTrajectory), "openscenario_1.2.xsd");
}

TEST_F(Schemas, OpenScenarioWithAnExternalEgo) {
  const RecordedScene scene = readScene(session_.folder(), {0.0, {}, "all"});
  expectValid(openScenarioText(scene, "a.xodr", ExportedEgo::kExternal), "openscenario_1.2.xsd");
}

TEST_F(Schemas, CommonRoad) {
  expectValid(commonRoadFile(readScene(session_.folder(), {0.0, {}, "all"})).text,
              "commonroad_2020a.xsd");
}

}  // namespace
}  // namespace cdiff::exchange
