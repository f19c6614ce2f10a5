// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "session_panel.h"

#include <QAbstractItemView>
#include <QHBoxLayout>
#include <QLineEdit>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

#include "pluginlib/class_list_macros.hpp"

namespace cdiff::rviz_panel {
namespace {

using State = SessionFigures::State;

constexpr int kRefreshMs = 100;
constexpr int kSliderSteps = 200;
constexpr double kShownWeight = 50.0;  // of a weight at a slider's right end
constexpr const char* kTargetSpeed = "target_speed";

/// A slider's right end: weights beyond it are set by dynamic_reconfigure or the service.
double highestOf(const std::string& name, const SessionParameter& parameter) {
  if (name == kTargetSpeed) return std::min(parameter.maximum, 20.0);
  return std::max(std::min(parameter.maximum, kShownWeight), parameter.value);
}

QString shortName(const std::string& name) {
  QString text = QString::fromStdString(name);
  if (name == kTargetSpeed) return "v* [m/s]";
  return text.remove("_weight").replace('_', ' ');
}

}  // namespace

SessionPanel::SessionPanel(QWidget* parent)
    : rviz::Panel(parent), client_(std::make_unique<SessionClient>()), timer_(new QTimer(this)) {
  auto* layout = new QVBoxLayout;
  state_ = new QLabel("no session");
  state_->setTextFormat(Qt::PlainText);
  state_->setWordWrap(true);
  layout->addWidget(state_);
  layout->addLayout(makePlayRow());
  layout->addLayout(makeSteerForm());
  layout->addWidget(makeFigures());
  setLayout(layout);
  connect(timer_, &QTimer::timeout, this, [this] { refresh(); });
  timer_->start(kRefreshMs);
}

QLayout* SessionPanel::makePlayRow() {
  auto* row = new QHBoxLayout;
  play_ = new QPushButton("Play");
  pause_ = new QPushButton("Pause");
  step_ = new QPushButton("Step");
  ticks_ = new QSpinBox;
  ticks_->setRange(1, 10000);
  ticks_->setValue(2);
  ticks_->setSuffix(" ticks");
  for (QWidget* widget : {static_cast<QWidget*>(play_), static_cast<QWidget*>(pause_),
                          static_cast<QWidget*>(step_), static_cast<QWidget*>(ticks_)})
    row->addWidget(widget);
  connect(play_, &QPushButton::clicked, this, [this] { client_->play(); });
  connect(pause_, &QPushButton::clicked, this, [this] { client_->pause(); });
  connect(step_, &QPushButton::clicked, this,
          [this] { client_->step(static_cast<std::uint64_t>(ticks_->value())); });
  return row;
}

QLayout* SessionPanel::makeSteerForm() {
  auto* form = new QFormLayout;
  pace_ = new QComboBox;
  pace_->addItem("as started");
  pace_->addItem("as fast as possible", 0.0);
  for (const double pace : {0.1, 0.25, 0.5, 1.0, 2.0, 5.0})
    pace_->addItem(QString("at most %1 x real time").arg(pace), pace);
  connect(pace_, QOverload<int>::of(&QComboBox::activated), this, [this](int index) {
    if (index > 0) client_->setPace(pace_->itemData(index).toDouble());
  });
  form->addRow("pace", pace_);
  profile_ = new QComboBox;
  profile_->setEditable(true);
  profile_->addItems({"naturalistic", "challenging", "safety_critical", "none"});
  profile_->setCurrentIndex(-1);
  profile_->lineEdit()->setPlaceholderText("as started");
  connect(profile_, QOverload<int>::of(&QComboBox::activated), this,
          [this](int) { client_->steer("profile", profile_->currentText().toStdString()); });
  form->addRow("profile", profile_);
  auto* choice = new QHBoxLayout;
  vehicle_ = new QComboBox;
  auto* choose = new QPushButton("choose");
  auto* release = new QPushButton("release");
  choice->addWidget(vehicle_, 1);
  choice->addWidget(choose);
  choice->addWidget(release);
  connect(choose, &QPushButton::clicked, this,
          [this] { client_->steer("choose", vehicle_->currentText().toStdString()); });
  connect(release, &QPushButton::clicked, this,
          [this] { client_->steer("release", vehicle_->currentText().toStdString()); });
  form->addRow("CBV", choice);
  weights_ = form;
  return form;
}

QWidget* SessionPanel::makeFigures() {
  auto* box = new QWidget;
  auto* layout = new QVBoxLayout;
  layout->setContentsMargins(0, 0, 0, 0);
  for (QLabel** label : {&answer_, &slots_, &verdict_}) {
    *label = new QLabel;
    (*label)->setTextFormat(Qt::PlainText);
    (*label)->setWordWrap(true);
    layout->addWidget(*label);
  }
  faults_ = new QPlainTextEdit;
  faults_->setReadOnly(true);
  faults_->setPlaceholderText("no faults");
  faults_->setMaximumHeight(60);
  layout->addWidget(faults_);
  box->setLayout(layout);
  return box;
}

void SessionPanel::refresh() {
  const SessionFigures figures = client_->figures();
  showState(figures);
  showSlots(figures);
  showVehicles(figures);
  showParameters(figures);
  answer_->setText(QString::fromStdString(figures.answer));
  answer_->setStyleSheet(figures.refused ? "color: #b00020" : "");
  verdict_->setText(figures.verdict.empty() ? QString("verdict so far: nothing measured yet")
                                            : "so far: " + QString::fromStdString(figures.verdict));
  if (figures.faults.size() == shown_faults_) return;
  shown_faults_ = figures.faults.size();
  QStringList lines;
  for (const std::string& fault : figures.faults) lines << QString::fromStdString(fault);
  faults_->setPlainText(lines.join('\n'));
}

void SessionPanel::showState(const SessionFigures& figures) {
  const State state = figures.state;
  const QString word = state == State::kPaused    ? "PAUSED"
                       : state == State::kPlaying ? "PLAYING"
                       : state == State::kOver    ? "OVER"
                                                  : "no session";
  state_->setText(!figures.connected ? word
                                     : word + QString("  %1 s (tick %2), %3")
                                                  .arg(figures.time, 0, 'f', 2)
                                                  .arg(figures.tick)
                                                  .arg(QString::fromStdString(figures.status)));
  play_->setEnabled(state == State::kPaused);
  pause_->setEnabled(state == State::kPlaying);
  step_->setEnabled(state == State::kPaused);
}

void SessionPanel::showSlots(const SessionFigures& figures) {
  QStringList lines;
  for (const auto& [slot, cbv] : figures.slots) {
    const QString ttc = std::isfinite(cbv.ttc) ? QString::number(cbv.ttc, 'f', 1) + " s" : "none";
    lines << QString("slot %1: CBV %2, TTC %3, score %4")
                 .arg(slot)
                 .arg(QString::fromStdString(cbv.vehicle_id), ttc)
                 .arg(cbv.score, 0, 'f', 2);
  }
  if (lines.empty())
    lines << "no CBV";
  else
    lines << QString("planner's latency %1 ms").arg(figures.latency_ms, 0, 'f', 1);
  slots_->setText(lines.join('\n'));
}

/// The list stays as it is while it is open, or nothing came or went.
void SessionPanel::showVehicles(const SessionFigures& figures) {
  if (vehicle_->view()->isVisible()) return;
  QStringList ids;
  for (const std::string& id : figures.vehicles) ids << QString::fromStdString(id);
  QStringList shown;
  for (int i = 0; i < vehicle_->count(); ++i) shown << vehicle_->itemText(i);
  if (ids == shown) return;
  const QString chosen = vehicle_->currentText();
  vehicle_->clear();
  vehicle_->addItems(ids);
  vehicle_->setCurrentText(chosen);
}

void SessionPanel::addParameter(const std::string& name, const SessionParameter& parameter) {
  Weight weight;
  weight.slider = new QSlider(Qt::Horizontal);
  weight.slider->setRange(0, kSliderSteps);
  weight.number = new QLabel;
  weight.number->setMinimumWidth(36);
  const double low = parameter.minimum;
  const double scale = (highestOf(name, parameter) - low) / kSliderSteps;
  weight.slider->setProperty("low", low);
  weight.slider->setProperty("scale", scale);
  connect(weight.slider, &QSlider::valueChanged, this, [this, name, low, scale](int step) {
    client_->setParameter(name, std::round(100.0 * (low + scale * step)) / 100.0);
  });
  auto* row = new QHBoxLayout;
  row->addWidget(weight.slider, 1);
  row->addWidget(weight.number);
  weights_->addRow(shortName(name), row);
  sliders_[name] = weight;
}

/// What the session has, unless the user moves the slider.
void SessionPanel::showParameters(const SessionFigures& figures) {
  for (const auto& [name, parameter] : figures.parameters) {
    if (sliders_.count(name) == 0) addParameter(name, parameter);
    const Weight& weight = sliders_.at(name);
    weight.number->setText(QString::number(parameter.value, 'g', 4));
    if (weight.slider->isSliderDown()) continue;
    const double low = weight.slider->property("low").toDouble();
    const double scale = weight.slider->property("scale").toDouble();
    const QSignalBlocker quiet(weight.slider);
    weight.slider->setValue(static_cast<int>(std::lround((parameter.value - low) / scale)));
  }
}

}  // namespace cdiff::rviz_panel

PLUGINLIB_EXPORT_CLASS(cdiff::rviz_panel::SessionPanel, rviz::Panel)
