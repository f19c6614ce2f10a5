// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "cli/version.h"

#include <array>
#include <cstdio>

#include "diffusion/network/cpu_denoiser.h"
#include "diffusion/network/image_encoder.h"
#include "record/build_info.h"

namespace cdiff::cli {
namespace {

/// First line that `sumo --version` prints, e.g. "Eclipse SUMO sumo Version 1.15.0".
std::string sumoVersion() {
  std::array<char, 256> line{};
  FILE* pipe = ::popen("sumo --version 2>/dev/null", "r");
  if (pipe == nullptr) return {};
  const bool read = std::fgets(line.data(), static_cast<int>(line.size()), pipe) != nullptr;
  while (std::fgetc(pipe) != EOF) {
  }
  ::pclose(pipe);
  std::string text = read ? line.data() : "";
  while (!text.empty() && text.back() == '\n') text.pop_back();
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
