// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "e2e_cdiff/metrics/metric.h"

namespace cdiff::metrics::known {

// Measures that the verdict, the tables for people and the paper's tables single out. Each is
// defined in its metric's file; all others are reached through the registry alone.

extern const MeasureDefinition kAccelerationShapiroWilk;
extern const MeasureDefinition kBlocked;
extern const MeasureDefinition kCbvClosestDistance;
extern const MeasureDefinition kCbvCollisions;
extern const MeasureDefinition kCbvCount;
extern const MeasureDefinition kCbvDecisions;
extern const MeasureDefinition kCbvDistance;
extern const MeasureDefinition kCbvEgoCollisions;
extern const MeasureDefinition kCbvEgoCollisionsPerKm;
extern const MeasureDefinition kCbvMinimumDistance;
extern const MeasureDefinition kCbvMovingEgoCollisions;
extern const MeasureDefinition kCbvOffRoad;
extern const MeasureDefinition kCbvSpeedError;
extern const MeasureDefinition kCollisionsPerKm;
extern const MeasureDefinition kCbvStanding;
extern const MeasureDefinition kCbvWrongWay;
extern const MeasureDefinition kContactsAtFault;
extern const MeasureDefinition kDrivingScore;
extern const MeasureDefinition kEgoBrakingAvoids;
extern const MeasureDefinition kEgoCollisions;
extern const MeasureDefinition kEgoDistance;
extern const MeasureDefinition kEgoOffRoad;
extern const MeasureDefinition kEgoStruckByCbvs;
extern const MeasureDefinition kEgoStruckCbvs;
extern const MeasureDefinition kEgoStruckStanding;
extern const MeasureDefinition kOutsideLanes;
extern const MeasureDefinition kPenalty;
extern const MeasureDefinition kRedLights;
extern const MeasureDefinition kRiftAccelerationShapiroWilk;
extern const MeasureDefinition kRiftCollisionsPerKm;
extern const MeasureDefinition kRiftOffRoad;
extern const MeasureDefinition kRiftSpeedShapiroWilk;
extern const MeasureDefinition kRiftSpeedWasserstein;
extern const MeasureDefinition kRiftTtc;
extern const MeasureDefinition kRouteCompletion;
extern const MeasureDefinition kSpeedShapiroWilk;
extern const MeasureDefinition kSpeedWasserstein;
extern const MeasureDefinition kStopSigns;
extern const MeasureDefinition kTtcCbvMean;
extern const MeasureDefinition kTtcCbvMinimum;
extern const MeasureDefinition kTtcDefined;
extern const MeasureDefinition kTtcMean;
extern const MeasureDefinition kTtcMinimum;

}  // namespace cdiff::metrics::known
