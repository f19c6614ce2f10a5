// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "planners/diffusion/training/diffusion_task.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <optional>

#include "core/text.h"
#include "diffusion/model.h"
#include "planners/diffusion/training/prepared_data.h"

namespace cdiff::planners {
namespace {

using core::InputError;
using learning::Measures;
using learning::PartSource;

constexpr const char* kNoDenoiser = "train stage denoiser on this encoder next";

PartSource encoderOf(const std::vector<std::string>& stages) {
  return {"encoder", "an encoder", stages, "encoder"};
}

/// `first`: empty where a new denoiser will do.
PartSource denoiserOf(const std::vector<std::string>& stages, const std::string& first) {
  return {"denoiser", "a denoiser", stages, first};
}

/// bfloat16 pays only where the processor multiplies it itself.
bool halfPrecision(const std::string& precision) {
  if (precision != "auto") return precision == "bf16";
  std::ifstream file("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  return text.find("avx512_bf16") != std::string::npos;
}

diffusion::Architecture architectureOf(const DiffusionTrainingSettings& settings,
                                       const learning::DrivingSchema& schema) {
  diffusion::Architecture architecture = settings.sizes();
  architecture.horizon = schema.horizon;
  architecture.image_width = schema.image_width;
  architecture.image_height = schema.image_height;
  architecture.route_points = schema.route_points;
  architecture.route_spacing = schema.route_spacing;
  architecture.validate();
  return architecture;
}

/// Whether the encoder of one fits the other; only the inputs of the denoiser differ.
bool sameEncoder(diffusion::Architecture first, const diffusion::Architecture& second) {
  first.route_features = second.route_features;
  first.speed_features = second.speed_features;
  first.context_width = second.context_width;
  first.previous_frame = second.previous_frame;
  first.target_features = second.target_features;
  first.current_state_rows = second.current_state_rows;
  return first == second;
}

using Tensors = std::map<std::string, inference::Tensor>;

/// The denoiser `narrow` with the inputs that `wide` has more, which it does not heed yet: the
/// columns of their weights are 0. New tensors are those of `wide`. Throws InputError naming
/// `source` and the tensor that is not a part of its counterpart.
Tensors widened(const Tensors& narrow, Tensors wide, const std::string& source) {
  for (const auto& [name, from] : narrow) {
    const auto found = wide.find(name);
    const bool fits = found != wide.end() && found->second.shape.size() == from.shape.size() &&
                      found->second.shape.front() == from.shape.front() &&
                      found->second.values.size() >= from.values.size();
    if (!fits) throw InputError("training: tensor '" + name + "' of '" + source + "' does not fit");
    inference::Tensor& to = found->second;
    const auto rows = static_cast<std::size_t>(to.shape.front());
    const std::size_t columns = from.values.size() / rows;
    const std::size_t wide_columns = to.values.size() / rows;
    std::fill(to.values.begin(), to.values.end(), 0.0F);
    for (std::size_t row = 0; row < rows; ++row)
      std::copy_n(from.values.begin() + static_cast<long>(row * columns), columns,
                  to.values.begin() + static_cast<long>(row * wide_columns));
  }
  return wide;
}

/// The model of --init, if one is given. For a stage that trains the denoiser one with other inputs
/// will do, too: its encoder alone where the paper's are asked for, with the current state or
/// without, and a denoiser that lacks those
/// of withMotion.
std::optional<diffusion::Model> initialModel(const learning::TrainingOptions& options,
                                             const std::string& network,
                                             const diffusion::Architecture& architecture) {
  const std::string& name = options.init;
  if (name.empty()) return std::nullopt;
  diffusion::Model model = diffusion::loadModel(name);
  if (model.architecture == architecture) return model;
  const bool trains_denoiser = options.stage == "denoiser" || options.stage == "joint";
  if (trains_denoiser && sameEncoder(model.architecture, architecture)) {
    const bool fewer_inputs = network == "paper" || network == "pinned";
    if (fewer_inputs) model.denoiser.clear();
    if (fewer_inputs || model.architecture.withMotion() == architecture) return model;
  }
  throw InputError("training: the architecture of '" + name + "' is " +
                   model.architecture.toJson() + ", this run has " + architecture.toJson());
}

std::string heldOutRow(const std::string& label, const std::string& prefix,
                       const Measures& measures) {
  std::string row = "| " + label + " |";
  for (const char* name : {"ade_m", "fde_m", "speed_mps", "throttle", "steer", "brake"}) {
    const auto found = measures.find(prefix + name);
    row += " " + (found == measures.end() ? "-" : core::formatFixed(found->second, 3)) + " |";
  }
  return row + "\n";
}

std::string heldOutTable(const Measures& held_out) {
  return "Mean absolute errors against the recorded rollouts: ADE and FDE [m], speed [m/s], "
         "actions "
         "as they are.\n\n"
         "| Prediction | ADE | FDE | speed | throttle | steer | brake "
         "|\n|---|---|---|---|---|---|---|\n" +
         heldOutRow("one step from k = K/2", "one_step_half_", held_out) +
         heldOutRow("one step from noise, k = K", "one_step_noise_", held_out) +
         heldOutRow("DDIM sample", "sample_", held_out) +
         heldOutRow("DDIM sample, gray image", "sample_grey_", held_out) +
         heldOutRow("DDIM sample, no route", "sample_no_route_", held_out) +
         heldOutRow("DDIM sample, gray image, no route", "sample_grey_no_route_", held_out);
}

std::string furtherRows(const Measures& held_out) {
  std::string rows = heldOutRow("DDIM sample, least of 8", "least_of_8_", held_out);
  for (const char* maneuver : learning::kManeuvers) {
    const std::string prefix = std::string("sample_") + maneuver + "_";
    const auto samples = held_out.find(prefix + "samples");
    if (samples == held_out.end()) continue;
    rows += heldOutRow("DDIM sample, " + std::string(maneuver) + " (" +
                           core::formatFixed(samples->second, 0) + " samples)",
                       prefix, held_out);
  }
  return rows + heldOutRow("straight on at the own speed", "constant_velocity_", held_out);
}

std::string motionRows(const Measures& held_out) {
  return heldOutRow("DDIM sample, one image", "sample_one_image_", held_out) +
         heldOutRow("DDIM sample, no target speed", "sample_no_target_", held_out) +
         heldOutRow("DDIM sample, image alone", "sample_image_alone_", held_out);
}

}  // namespace

learning::TaskTexts DiffusionTask::texts() const {
  return {"encoder, fine_tune where needed, denoiser", "32 on images, 128 on features"};
}

std::vector<learning::StageInfo> DiffusionTask::stages() const {
  const PartSource tuned = encoderOf({"fine_tune", "encoder"});
  const PartSource head = {"head", "a regression head", {"encoder"}, ""};
  return {{"encoder", {}, false, {}, kNoDenoiser},
          {"fine_tune",
           {encoderOf({"encoder"}), head},
           true,
           {denoiserOf({"joint", "denoiser"}, "")},
           kNoDenoiser},
          {"denoiser", {tuned}, true, {}, ""},
          {"joint",
           {tuned,
            denoiserOf({"denoiser"}, ""),
            {"head", "a regression head", {"fine_tune", "encoder"}, ""}},
           true,
           {},
           ""}};
}

std::vector<std::string> DiffusionTask::allStages() const {
  if (settings.image_scale == 1.0) return {"encoder", "denoiser"};
  return {"encoder", "fine_tune", "denoiser"};
}

std::vector<PartSource> DiffusionTask::model() const {
  return {encoderOf({"joint", "fine_tune", "encoder"}),
          denoiserOf({"joint", "denoiser"}, "denoiser")};
}

std::vector<std::string> DiffusionTask::weightFiles() const {
  return {diffusion::kEncoderFile, diffusion::kDenoiserFile};
}

std::vector<std::string> DiffusionTask::fields() const {
  std::vector<std::string> names = learning::drivingFields();
  if (settings.network == "motion") names.insert(names.end(), {"target_speed", "previous_image"});
  return names;
}

std::vector<std::string> DiffusionTask::otherFiles() const { return {kFeatureFile}; }

void DiffusionTask::start(const learning::TrainingRun& run) {
  const learning::DrivingDataset dataset(run.dataset);
  const diffusion::Architecture architecture = architectureOf(settings, dataset.schema());
  const auto initial = initialModel(run.options, settings.network, architecture);
  const diffusion::Normalizer normalizer =
      chooseNormalizer(run.options, settings.mirror, dataset, initial ? &*initial : nullptr);
  const auto seed = static_cast<std::uint64_t>(run.options.seed);
  const auto auxiliary = static_cast<std::int64_t>(dataset.schema().auxiliary.size());
  state_.reset(new TrainingState{
      run, dataset, settings, architecture, normalizer, ImageEncoderNet(architecture, seed),
      RegressionHead(architecture, auxiliary, seed), DenoiserNet(architecture, seed),
      DiffusionLoss(
          settings.loss == "plain" ? DiffusionLoss::Kind::kPlain : DiffusionLoss::Kind::kWeighted,
          architecture, normalizer, run.device),
      halfPrecision(settings.precision)});
  if (initial) {
    state_->encoder.parameters().load(initial->encoder, run.options.init);
    learning::ParameterSet& denoiser = state_->denoiser.parameters();
    if (!initial->denoiser.empty())
      denoiser.load(widened(initial->denoiser, denoiser.values(), run.options.init),
                    run.options.init);
  }
  state_->encoder.parameters().moveTo(run.device);
  state_->head.parameters().moveTo(run.device);
  state_->denoiser.moveTo(run.device);
}

nlohmann::json DiffusionTask::facts() const {
  return {{"normalizer", state_->normalizer.toJson()},
          {"balance", settings.balance},
          {"yielding_share", settings.yielding_share},
          {"training_loss", settings.loss},
          {"mirror", settings.mirror},
          {"image_scale", settings.image_scale},
          {"route_drop", settings.route_drop},
          {"change_light", settings.change_light}};
}

std::vector<learning::TrainedPart> DiffusionTask::parts() {
  return {{"encoder", &state_->encoder.parameters()},
          {"head", &state_->head.parameters()},
          {"denoiser", &state_->denoiser.parameters()}};
}

std::unique_ptr<learning::Stage> DiffusionTask::makeStage(const std::string& name) {
  if (name == "encoder") return makeEncoderStage(*state_, name, settings.image_scale);
  if (name == "fine_tune") return makeEncoderStage(*state_, name, 1.0);
  if (name == "joint") return makeDiffusionStage(*state_, name, nullptr);
  cache_ = computeFeatures(*state_);
  return makeDiffusionStage(*state_, name, &cache_);
}

learning::TrainedModel DiffusionTask::finish() {
  const HeldOut held_out = encodeHeldOut(*state_);
  diffusion::Model model;
  model.architecture = state_->architecture;
  model.normalizer = state_->normalizer;
  model.spread = state_->loss.spread(state_->denoiser, held_out.batch);
  model.encoder = state_->encoder.parameters().values();
  model.denoiser = state_->denoiser.parameters().values();
  diffusion::ModelFiles files = diffusion::modelFiles(model);
  learning::TrainedModel trained;
  trained.files = {
      {diffusion::kEncoderFile, std::move(files.encoder), false, diffusion::kEncoderKey},
      {diffusion::kDenoiserFile, std::move(files.denoiser), true, ""}};
  trained.held_out =
      state_->loss.measureHeldOut(state_->denoiser, held_out.batch, held_out.gray_features);
  trained.held_out.merge(state_->loss.measureFurther(state_->denoiser, held_out.batch));
  trained.settings = {{"balance", settings.balance},
                      {"yielding_share", settings.yielding_share},
                      {"network", settings.network},
                      {"loss", settings.loss},
                      {"route_drop", settings.route_drop},
                      {"mirror", settings.mirror},
                      {"precision", state_->half_precision ? "bf16" : "f32"}};
  trained.title = "Diffusion planner";
  trained.measures = heldOutTable(trained.held_out);
  if (state_->architecture.takesPrevious()) trained.measures += motionRows(trained.held_out);
  trained.measures += furtherRows(trained.held_out);
  return trained;
}

learning::TaskDescriptor diffusionTraining() {
  return {"diffusion", "Train the diffusion planner on collected shards",
          []() -> std::shared_ptr<learning::Task> { return std::make_shared<DiffusionTask>(); }};
}

}  // namespace cdiff::planners
