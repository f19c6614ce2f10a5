// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/pluto/pluto_architecture.h"

#include <string>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/denoiser_kernels.h"

namespace cdiff::planners {
namespace {

void requirePlutoMultiple(const char* key, std::int64_t value, std::int64_t divisor,
                          const std::string& reason) {
  if (value % divisor == 0) return;
  throw core::InputError(std::string(key) + " is " + std::to_string(value) + "; a multiple of " +
                         reason + " was expected");
}

}  // namespace

void PlutoArchitecture::describe(core::OptionsVisitor& visitor) {
  visitor.integer({"width", "", "Width of a token."}, width, 16, 1024);
  visitor.integer({"heads", "", "Heads of attention."}, heads, 1, 64);
  visitor.integer({"hidden", "", "Width of the feed-forward networks."}, hidden, 16, 4096);
  visitor.integer({"encoder_layers", "", "Layers over the scene."}, encoder_layers, 1, 16);
  visitor.integer({"decoder_layers", "", "Layers over the queries."}, decoder_layers, 1, 16);
  visitor.integer({"agents", "", "Most vehicles that are tokens; the nearest are kept."}, agents, 0,
                  256);
  visitor.integer({"polygons", "", "Most pieces of lanes that are tokens; the nearest are kept."},
                  polygons, 0, 1024);
  visitor.integer({"lines", "", "Most reference lines."}, lines, 1, 16);
  visitor.number({"radius", "m", "Vehicles and lanes farther away are no tokens."}, radius, 1.0,
                 500.0);
}

void PlutoArchitecture::validate() const {
  requirePlutoMultiple("width", width, inference::kChannelMultiple * heads, "16 x heads");
  requirePlutoMultiple("hidden", hidden, inference::kChannelMultiple, "16");
}

}  // namespace cdiff::planners
