// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
/// Figures that the verdict, the tables for people and the paper's tables single out. Each is
/// defined in its metric's file; all others are reached through the registry alone.
#pragma once

#include "e2e_cdiff/metrics/figure.h"

namespace cdiff::metrics::figures {

extern const FigureDefinition kAccelerationShapiroWilk;
extern const FigureDefinition kBlocked;
extern const FigureDefinition kCbvClosestDistance;
extern const FigureDefinition kCbvCollisions;
extern const FigureDefinition kCbvCount;
extern const FigureDefinition kCbvDecisions;
extern const FigureDefinition kCbvDistance;
extern const FigureDefinition kCbvEgoCollisions;
extern const FigureDefinition kCbvMinimumDistance;
extern const FigureDefinition kCbvOffRoad;
extern const FigureDefinition kCbvSpeedError;
extern const FigureDefinition kCollisionsPerKm;
extern const FigureDefinition kContactsAtFault;
extern const FigureDefinition kDrivingScore;
extern const FigureDefinition kEgoCollisions;
extern const FigureDefinition kOutsideLanes;
extern const FigureDefinition kPenalty;
extern const FigureDefinition kRedLights;
extern const FigureDefinition kRiftAccelerationShapiroWilk;
extern const FigureDefinition kRiftCollisionsPerKm;
extern const FigureDefinition kRiftOffRoad;
extern const FigureDefinition kRiftSpeedShapiroWilk;
extern const FigureDefinition kRiftSpeedWasserstein;
extern const FigureDefinition kRiftTtc;
extern const FigureDefinition kRouteCompletion;
extern const FigureDefinition kSpeedShapiroWilk;
extern const FigureDefinition kSpeedWasserstein;
extern const FigureDefinition kStopSigns;
extern const FigureDefinition kTtcMean;
extern const FigureDefinition kTtcMinimum;

}  // namespace cdiff::metrics::figures
