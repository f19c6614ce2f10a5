// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "e2e_cdiff/core/options.h"
#include "simulation/traffic_simulator.h"

namespace cdiff::simulation {

/// How SUMO is started and how long it may take.
struct SumoOptions {
  std::string binary = "sumo";    ///< program to start
  double start_timeout = 20.0;    ///< until SUMO answers [s of wall time]
  double step_timeout = 10.0;     ///< a step that takes longer: SUMO is frozen [s of wall time]
  double match_threshold = 20.0;  ///< largest distance to the lane that moveToXY matches [m]

  void describe(core::OptionsVisitor& visitor);
};

/// What one session gives to SUMO.
struct SumoSession {
  std::filesystem::path network_file;    ///< as imported
  std::filesystem::path network_source;  ///< what the user gave, for errors; may be empty
  std::filesystem::path demand_file;     ///< *.rou.xml; may be empty: no background traffic
  double begin_time = 0.0;               ///< SUMO's clock at the start [s]
  double simulation_step = 0.05;         ///< [s]
  std::uint64_t seed = 1;
  bool lights_green = true;          ///< every signal shows 'g' for the whole session
  std::string link = "libtraci";     ///< libtraci: SUMO as a process; libsumo: in this process
  std::filesystem::path log_folder;  ///< SUMO's error log; a temporary folder when empty
};

/// TrafficSimulator on SUMO (units and frames as in the base class): owns the session with SUMO and
/// reads it by subscriptions. Every failure of SUMO becomes a SimulatorError that
/// quotes SUMO's own log, or an InputError where the network or the demand is at fault.
class SumoSimulator : public TrafficSimulator {
 public:
  /// Starts SUMO and connects. `network` must outlive the simulator. Throws InputError that names
  /// the network or the demand and quotes SUMO when SUMO refuses one of them or crashes on it, or
  /// that says that libsumo is missing. With libsumo a process has one simulator at a time.
  SumoSimulator(const SumoOptions& options, const SumoSession& session,
                const map::RoadNetwork& network);
  /// Ends the SUMO process that it started, and only that one.
  ~SumoSimulator() override;

  void addDriven(const std::string& id, const traffic::VehicleDimensions& dimensions,
                 const DrivenVehicle& start) override;
  void takeOver(const std::string& id) override;
  bool release(const DrivenVehicle& vehicle) override;
  bool addBackground(const std::string& id, const std::vector<std::string>& edges,
                     double depart_position, int depart_lane, double depart_speed,
                     const traffic::VehicleDimensions& dimensions) override;
  void remove(const std::string& id) override;
  void step(const std::vector<DrivenVehicle>& driven) override;
  const std::vector<SimulatedVehicle>& vehicles() const override;
  const std::vector<traffic::SignalState>& signals() const override;
  std::string version() const override;

  /// Process id of SUMO, for tests of its loss; that of this process with libsumo.
  int processId() const;

 private:
  class Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace cdiff::simulation
