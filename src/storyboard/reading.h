// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <map>
#include <string>
#include <vector>

#include "e2e_cdiff/core/exceptions.h"
#include "storyboard/xosc_element.h"

namespace cdiff::storyboard {

/// An element that is not supported; may be ignored where the user says so.
class Unsupported : public core::InputError {
 public:
  using InputError::InputError;
};

/// The catalogs of a scenario: folders of files with named entries.
class Catalogs {
 public:
  Catalogs() = default;
  /// From <CatalogLocations>; folders are relative to the file that names them. Throws InputError
  /// for a folder that is not there, and for a file in it that is no OpenSCENARIO file.
  explicit Catalogs(const XoscElement& locations);

  /// The entry that a <CatalogReference> names, with its parameters. Throws InputError naming the
  /// catalogs or entries that there are, and where entries go in a circle.
  XoscElement entry(const XoscElement& reference) const;
  /// `element` itself, or the entry where it is a <CatalogReference>.
  XoscElement resolve(const XoscElement& element) const;
  /// The files that were read.
  const std::vector<std::string>& files() const { return files_; }

 private:
  void add(const std::string& file);
  std::vector<std::string> files_;
  std::map<std::string, std::vector<XoscElement>> entries_;  ///< by catalog
  mutable std::size_t taken_ = 0;  ///< entries: a few that refer to each other can be many
};

/// What the readers of one file share.
struct Reading {
  Catalogs catalogs;
  bool carla = false;                ///< y to the right and clockwise angles
  bool ignore_unsupported = false;   ///< go on without it
  std::vector<std::string> ignored;  ///< what was not supported, with file and line

  /// Throws Unsupported.
  [[noreturn]] static void refuse(const XoscElement& element, const std::string& what);
  /// Throws Unsupported where the element has one of these attributes.
  static void refuseAttributes(const XoscElement& element, const std::vector<const char*>& keys);
  /// Whether a distance of an element is measured along lanes or the road: the attribute
  /// coordinateSystem; false without it. Throws Unsupported for one along a trajectory.
  static bool isAlongLanes(const XoscElement& element);
  /// Keeps the text where what is not supported may be ignored, else throws it on.
  void ignore(const Unsupported& error);
};

/// The row of a reader's table whose element this is. Throws Unsupported where there is none, or
/// one that nothing reads; `what` says what it would be ("this action").
template <class Row, std::size_t N>
const Row& rowOf(const Row (&rows)[N], const XoscElement& element, const char* what) {
  for (const Row& row : rows)
    if (element.name() == row.element && row.read != nullptr) return row;
  Reading::refuse(element, what);
}

/// Name of a <Controller>, or of the entry that a <CatalogReference> names: scenario_runner's
/// property `module` where it has one. Throws InputError.
std::string readControllerName(const XoscElement& element, const Reading& reading);
/// Reads the one position inside <Position>. Throws InputError and Unsupported.
Position readPosition(const XoscElement& parent, const Reading& reading);
/// Reads the position that stands alone in `holder`. Throws InputError and Unsupported.
Position readOnlyPosition(const XoscElement& holder, const Reading& reading);
/// Reads the waypoints of a <Route>, or of the one that a <CatalogReference> names; at least one.
/// Throws as readPosition.
std::vector<Position> readWaypoints(const XoscElement& element, const Reading& reading);
/// Reads one <Action>, <PrivateAction> or <GlobalAction>. Throws InputError; Unsupported where that
/// must not be ignored.
Action readAction(const XoscElement& element, Reading& reading);
/// Reads a trigger. Throws as readAction.
Trigger readTrigger(const XoscElement& element, Reading& reading);

/// How an element of the format is treated.
enum class Support { kSupported, kWithoutEffect, kRefused };

/// A row of the table of elements.
struct ElementSupport {
  std::string element;
  Support support = Support::kRefused;
};

/// The actions, conditions and positions that the readers know, in the order of their tables.
std::vector<ElementSupport> actionSupport();
std::vector<ElementSupport> conditionSupport();
std::vector<ElementSupport> positionSupport();

}  // namespace cdiff::storyboard
