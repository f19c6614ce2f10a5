// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "simulation/sumo_link.h"

#include <libsumo/libtraci.h>
#include <unistd.h>

#include "core/text.h"
#include "e2e_cdiff/core/exceptions.h"

namespace cdiff::simulation {

namespace {

/// libtraci writes to SUMO's socket also when SUMO is gone; the signal would end our process. A
/// handler that someone set stays.
void ignoreBrokenPipes() {
  struct sigaction present {};
  ::sigaction(SIGPIPE, nullptr, &present);
  if ((present.sa_flags & SA_SIGINFO) != 0 || present.sa_handler != SIG_DFL) return;
  present.sa_handler = SIG_IGN;
  ::sigaction(SIGPIPE, &present, nullptr);
}

}  // namespace

SumoLink::Guard::Guard(SumoLink& link) : link_(link) {
  sigset_t all;
  sigfillset(&all);
  for (int fault : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP}) sigdelset(&all, fault);
  ::pthread_sigmask(SIG_SETMASK, &all, &previous_);
  link_.sumo_.process().setDeadline(link_.limit_);
}

SumoLink::Guard::~Guard() {
  link_.sumo_.process().clearDeadline();
  ::pthread_sigmask(SIG_SETMASK, &previous_, nullptr);
}

SumoLink::SumoLink(const SumoCommand& command, double call_timeout)
    : sumo_(command),
      limit_(command.start_timeout),
      label_("sumo_" + std::to_string(sumo_.process().id()) + "_" + std::to_string(sumo_.port())) {
  ignoreBrokenPipes();
  connect();
  loaded_ = true;
  limit_ = call_timeout;
}

void SumoLink::connect() {
  const Guard guard(*this);
  try {
    version_ = libtraci::Simulation::init(sumo_.port(), 5, "127.0.0.1", label_).second;
    connected_ = true;
  } catch (...) {
    fail("loading the network and the demand");
  }
}

void SumoLink::select() const { libtraci::Simulation::switchConnection(label_); }

SumoLink::~SumoLink() {
  if (!connected_ || sumo_.process().ended()) return;
  try {
    guarded("close", [] { libtraci::Simulation::close(); });
  } catch (const core::Error&) {
    // SUMO was lost at its very end: the process is ended in any case.
  }
}

bool SumoLink::attempt(const std::function<void()>& call) {
  try {
    call();
    return true;
  } catch (const libsumo::TraCIException&) {
    return false;
  }
}

std::string SumoLink::lossText(const std::string& what, const std::string& reason) {
  core::GuardedProcess& process = sumo_.process();
  // The socket closes a moment before the process is gone, a longer one where it crashes.
  process.waitForEnd(loaded_ ? 0.3 : 3.0);
  if (process.deadlineMissed()) {
    return "SUMO did not answer for " + core::formatNumber(limit_) + " s (" + what +
           ") and was ended";
  }
  const std::string refusal = sumo_.refusal();
  if (!refusal.empty() && (!loaded_ || process.endSignal() == 0)) throw SumoRefusal(refusal);
  const std::string end = process.endText();
  process.kill();
  return "SUMO was lost (" + what + "; " + end + "; " + reason + "): " + sumo_.lastWords();
}

void SumoLink::fail(const std::string& what) {
  try {
    throw;
  } catch (const core::Error&) {
    throw;
  } catch (const libsumo::TraCIException& refusal) {
    throw core::SimulatorError("SUMO refused (" + what + "): " + refusal.what());
  } catch (const std::exception& loss) {
    connected_ = false;
    throw core::SimulatorError(lossText(what, loss.what()));
  }
}

}  // namespace cdiff::simulation
