// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include "learning/samples/field.h"
#include "learning/samples/scene.h"

namespace cdiff::learning {

// A scene as the packed fields of one sample: tables by column, lists of texts each closed by a
// zero byte, and indices into the lists in place of the texts.

/// The tables of every scene file of kSceneVersion.
const SampleSchema& sceneSchema();

/// A number in the row of a vehicle at a decision.
struct StateColumn {
  const char* name;
  double (*get)(const traffic::Vehicle& vehicle);
  void (*set)(traffic::Vehicle& vehicle, double value);
};
const std::vector<StateColumn>& stateColumns();

/// Numbers of a row of the table "driver": target speed, style, score and conflict point.
inline constexpr std::size_t kDriverNumbers = 9;

Sample tablesOf(const Scene& scene);

/// Throws std::out_of_range where a table is shorter than another requires, or holds an index
/// beyond its list.
Scene sceneOfTables(const Sample& tables);

}  // namespace cdiff::learning
