// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "simulation/sumo_link.h"

namespace cdiff::simulation {

/// SUMO in this process, through libsumo, which is loaded with the first such link. SUMO is global,
/// so a process has one such link at a time. A crash of SUMO ends this process, and no deadline
/// holds: whoever waits for this process hears of the call (core::NamedCall).
class InProcessLink : public SumoLink {
 public:
  /// Starts SUMO. `log_folder`: a temporary one when empty. Throws InputError, naming the package,
  /// where libsumo is missing; SumoRefusal where SUMO refuses its input; SimulatorError where this
  /// process has such a link already.
  InProcessLink(const std::vector<std::string>& arguments, const std::filesystem::path& log_folder);
  /// Closes the session.
  ~InProcessLink() override;

  int processId() const override;

 private:
  class Call;
  /// The right of this process to SUMO, which one link has at a time.
  class Turn {
   public:
    Turn();
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;
  };

  std::unique_ptr<Guard> guardCall() override;
  std::string lossText(const std::string& what, const std::string& reason) override;

  Turn turn_;
  LogFolder logs_;
  bool loaded_ = false;
};

}  // namespace cdiff::simulation
