// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "metrics/session_metrics.h"
#include "record/logs/cbv_log.h"
#include "record/logs/driving_log.h"
#include "record/logs/hold_up_log.h"
#include "record/logs/plan_log.h"
#include "record/logs/planner_logs.h"
#include "record/logs/steering_log.h"
#include "record/verdict.h"
#include "session/session_setup.h"

namespace cdiff::record {

/// Facts about the run that are not in the scenario.
struct RunFacts {
  std::string deployment;         ///< "cdiff run" or "roslaunch"
  std::string simulator_version;  ///< "SUMO 1.15.0"
  bool deterministic = true;      ///< false when wall-clock time replaced an answer
  std::string recorded_by =
      {};  ///< who made the recording that this session was replayed from; else empty
};

/// Everything that the result folder says about one session, in one value: its files are functions
/// of it. What the references name must outlive the value.
struct SessionResult {
  const session::SessionSetup& setup;
  const Timeline& timeline;
  const CbvLog& cbv;
  const ApproachLog& approaches;
  const PlanLog& plans;
  const GuidanceLog& guidance;
  const FrontViewLog& front_views;
  const DrivingLog& driving;
  const HoldUpLog& hold_ups;
  const SteeringLog& steering;
  RunFacts facts;
  traffic::SessionStatus status = traffic::SessionStatus::kError;
  double simulated_seconds = 0.0;
  double wall_seconds = 0.0;
  std::string trace_sha256 = {};
  metrics::SessionMeasures measures = {};
  std::map<std::string, LatencySummary> latencies = {};
  std::map<std::string, LateCounts> late = {};  ///< empty where every answer is waited for
  std::vector<traffic::Fault> faults = {};
  Verdict verdict = {};
};

}  // namespace cdiff::record
