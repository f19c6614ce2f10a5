// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#pragma once

#include <QComboBox>
#include <QFormLayout>
#include <QLabel>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QSlider>
#include <QSpinBox>
#include <QTimer>
#include <map>
#include <memory>
#include <string>

#include "rviz/panel.h"
#include "session_client.h"

namespace cdiff::rviz_panel {

/// Steers a running session in rviz: play, pause, step, pace, which vehicle becomes a CBV (by id,
/// or by a click with the tool Publish Point), guidance profile, target speed and weights; shows
/// time to collision, score, latency, verdict so far and faults. Everything goes through
/// SessionClient.
class SessionPanel : public rviz::Panel {
  Q_OBJECT

 public:
  explicit SessionPanel(QWidget* parent = nullptr);

 private:
  /// A slider with the number beside it.
  struct Weight {
    QSlider* slider = nullptr;
    QLabel* number = nullptr;
  };
  QLayout* makePlayRow();
  QLayout* makeSteerForm();
  QWidget* makeFigures();
  void refresh();
  void showState(const SessionFigures& figures);
  void showSlots(const SessionFigures& figures);
  void showVehicles(const SessionFigures& figures);
  void showParameters(const SessionFigures& figures);
  void addParameter(const std::string& name, const SessionParameter& parameter);

  std::unique_ptr<SessionClient> client_;
  QTimer* timer_;
  QPushButton* play_;
  QPushButton* pause_;
  QPushButton* step_;
  QSpinBox* ticks_;
  QComboBox* pace_;
  QComboBox* profile_;
  QComboBox* vehicle_;
  QFormLayout* weights_;
  QLabel* state_;
  QLabel* slots_;
  QLabel* verdict_;
  QLabel* answer_;
  QPlainTextEdit* faults_;
  std::size_t shown_faults_ = 0;
  std::map<std::string, Weight> sliders_;  ///< by the parameter's name
};

}  // namespace cdiff::rviz_panel
