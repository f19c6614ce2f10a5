// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/in_process_link.h"

#include <dlfcn.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <fstream>
#include <iostream>

#include "core/file.h"
#include "core/forked_work.h"

namespace cdiff::simulation {
namespace {

// This project's module around libsumo, which lies beside this library.
constexpr const char* kModule = "libe2e_cdiff_libsumo.so";

std::atomic<bool> sumo_is_taken{false};

/// Leads what SUMO says on std::cerr into a file, as long as the object exists.
class ErrorStream {
 public:
  explicit ErrorStream(const std::filesystem::path& file)
      : file_(file), before_(std::cerr.rdbuf(file_.rdbuf())) {}
  ~ErrorStream() { std::cerr.rdbuf(before_); }
  ErrorStream(const ErrorStream&) = delete;
  ErrorStream& operator=(const ErrorStream&) = delete;

 private:
  std::ofstream file_;
  std::streambuf* before_;
};

const SumoCalls& libsumoCalls() {
  void* module = ::dlopen(kModule, RTLD_NOW | RTLD_LOCAL);
  void* calls = module == nullptr ? nullptr : ::dlsym(module, "cdiffSumoCalls");
  if (calls == nullptr) {
    throw core::InputError(
        std::string("key 'simulation.link' is 'libsumo', which cannot be loaded (") + ::dlerror() +
        "); install the package sumo and build again, or choose libtraci");
  }
  return *reinterpret_cast<decltype(&cdiffSumoCalls)>(calls)();
}

}  // namespace

/// Says what is being called.
class InProcessLink::Call : public Guard {
 private:
  core::NamedCall call_{core::kSimulatorCall, "libsumo"};
};

InProcessLink::Turn::Turn() {
  if (sumo_is_taken.exchange(true)) {
    throw core::SimulatorError(
        "SUMO runs in this process already: with simulation.link 'libsumo' a process has one "
        "session at a time; choose libtraci");
  }
}

InProcessLink::Turn::~Turn() { sumo_is_taken = false; }

InProcessLink::InProcessLink(const std::vector<std::string>& arguments,
                             const std::filesystem::path& log_folder)
    : SumoLink(libsumoCalls()), logs_(log_folder) {
  ::setenv("SUMO_HOME", core::sumoHome().c_str(), 0);
  std::error_code ignored;
  std::filesystem::remove(logs_.errorLog(), ignored);
  std::vector<std::string> all = {"--error-log", logs_.errorLog().string()};
  all.insert(all.end(), arguments.begin(), arguments.end());
  const std::unique_ptr<Guard> guard = guardCall();
  try {
    const ErrorStream errors(logs_.output());
    calls().load(all);
  } catch (const std::exception& refusal) {
    const std::string sentence = sentenceAfter("Error: ", logs_.output());
    throw SumoRefusal(sentence.empty() ? refusal.what() : sentence);
  }
  loaded_ = true;
  version_ = calls().version();
}

InProcessLink::~InProcessLink() {
  if (!loaded_) return;
  try {
    guarded("close", [this] { calls().close(); });
  } catch (const core::Error&) {
    // SUMO failed before, and the next session loads it afresh.
  }
}

int InProcessLink::processId() const { return ::getpid(); }

std::unique_ptr<SumoLink::Guard> InProcessLink::guardCall() { return std::make_unique<Call>(); }

/// In this process SUMO cannot be gone: it ended the session, and writes its log with the end.
std::string InProcessLink::lossText(const std::string& /*what*/, const std::string& reason) {
  loaded_ = false;
  try {
    calls().close();
  } catch (const std::exception&) {
    // What is left of the session goes when the next one is loaded.
  }
  const std::string sentence = sentenceAfter("Error: ", logs_.errorLog());
  throw SumoRefusal(sentence.empty() ? reason : sentence);
}

}  // namespace cdiff::simulation
