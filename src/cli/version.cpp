// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/version.h"

#include "core/guarded_process.h"
#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "e2e_cdiff/core/exceptions.h"
#include "record/session_yaml.h"

namespace cdiff::cli {
namespace {

/// First line that `sumo --version` prints, e.g. "Eclipse SUMO sumo Version 1.15.0".
std::string sumoVersion() {
  constexpr double kPatience = 10.0;  // [s]
  const core::ProcessOutput output;
  try {
    core::GuardedProcess sumo(core::findProgram("sumo", "sumo"), {"--version"}, {},
                              {{}, -1, output.descriptor()});
    sumo.waitForEnd(kPatience);
  } catch (const core::Error&) {
    return {};
  }
  const std::string printed = output.end();
  const std::string text = printed.substr(0, printed.find('\n'));
  return text.substr(text.find_last_of(' ') + 1);
}

}  // namespace

std::string versionText() {
  using diffusion::CpuDenoiser;
  const std::string sumo = sumoVersion();
  return "cdiff " + record::packageVersion() + "\nrevision " + record::packageRevision() +
         "\nSUMO " + (sumo.empty() ? "not found: install the package sumo" : sumo) +
         "\ninstruction set " + record::instructionSet() + "; encoder with " +
         diffusion::ImageEncoder::instructionSet() + ", denoiser with " +
         CpuDenoiser::toText(CpuDenoiser::bestInstructionSet());
}

}  // namespace cdiff::cli
