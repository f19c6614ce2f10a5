// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// The result folder of the hand-made session of record/sample_session.h, for tests that read it
/// back: 100 ticks of 0.05 s, a CBV from tick 53 on, a network file that exists.
#pragma once

#include <filesystem>
#include <string>

#include "core/file.h"
#include "page/result_writer.h"
#include "record/sample_session.h"
#include "support/temporary_folder.h"

namespace cdiff::test {

class RecordedSession {
 public:
  static constexpr std::uint64_t kLastTick = 100;

  RecordedSession() {
    const std::string network = (scratch_.path() / "crossing.net.xml").string();
    core::writeFileAtomically(network, crossingText());
    session::ScenarioOptions options = sampleOptions();
    options.network = network;
    const session::SessionSetup setup(options, map::importNetwork(network),
                                      lineOf({5.0, -2.0, 0.0}, {195.0, -2.0, 0.0}));
    page::ResultWriter writer(setup, sampleFacts(), folder());
    playSession(writer, setup, kLastTick, traffic::SessionStatus::kTimedOut);
    writer.finish(1.0);
  }
  std::filesystem::path folder() const { return scratch_.path() / "result"; }
  std::filesystem::path path(const std::string& name) const { return scratch_.path() / name; }

 private:
  TemporaryFolder scratch_;
};

}  // namespace cdiff::test
