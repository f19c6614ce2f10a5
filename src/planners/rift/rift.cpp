// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/rift/rift.h"

namespace cdiff::planners {

planning::PlannerDescriptor riftDescriptor() {
  planning::PlannerDescriptor descriptor = plutoDescriptorOf<RiftOptions>(kRift);
  descriptor.title = "RIFT";
  descriptor.help = "pluto with scores that were fine-tuned by simulated returns.";
  return descriptor;
}

}  // namespace cdiff::planners
