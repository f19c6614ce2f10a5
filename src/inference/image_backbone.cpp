// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/image_backbone.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "e2e_cdiff/core/exceptions.h"
#include "inference/encoder_layers.h"

namespace cdiff::inference {
namespace {

std::string stageName(std::size_t stage) { return "layer" + std::to_string(stage + 1); }

std::string blockName(std::size_t stage, std::int64_t block) {
  return stageName(stage) + "." + std::to_string(block);
}

const Tensor& tensorNamed(const std::map<std::string, Tensor>& tensors, const std::string& name) {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw core::InputError("the network has no tensor '" + name + "'");
  return found->second;
}

}  // namespace

/// Layers over buffers of their own: maps are small, so none is shared.
struct ImageBackbone::Network {
  /// A convolution, its normalization, and where its output lies.
  struct NormedConvolution {
    EncoderConvolution convolution;
    EncoderNorm norm;
    float* output = nullptr;

    void run(dnnl::stream& stream, const float* residual,
             EncoderNorm::Activation activation) const {
      convolution.run(stream);
      norm.run(output, residual, activation);
    }
  };

  /// Two convolutions and a shortcut.
  struct ResidualBlock {
    NormedConvolution first;
    NormedConvolution second;
    std::optional<NormedConvolution> down;  ///< where size or channels change
    const float* input = nullptr;
  };

  Network(const BackboneSizes& sizes, const std::map<std::string, Tensor>& tensors);

  NormedConvolution convolve(const std::string& name, const std::string& norm, float* input,
                             const MapShape& shape, const ConvolutionOptions& options);
  void addBlock(const std::string& name, std::int64_t stride);
  void addPyramid(float* middle, const MapShape& middle_shape);
  float* newBuffer(std::int64_t floats);
  void bindScratch();
  void readImage(const std::uint8_t* rgb);
  void runBlock(const ResidualBlock& block);
  void addStretched();
  void writeRows(const View& rows) const;

  const std::map<std::string, Tensor>* tensors_;
  dnnl::engine engine_{dnnl::engine::kind::cpu, 0};
  dnnl::stream stream_{engine_};
  dnnl::memory::format_tag layout_ = preferredLayout(engine_);
  MapShape image_;
  MapShape shape_;  ///< of the last block's output
  float* last_ = nullptr;
  std::array<float, 256> pixel_values_{};
  std::vector<dnnl::memory> buffers_;
  float* pixels_ = nullptr;
  std::optional<NormedConvolution> stem_;
  std::optional<EncoderPooling> pooling_;
  std::vector<ResidualBlock> blocks_;
  std::optional<EncoderConvolution> high_;
  std::optional<EncoderConvolution> low_;
  float* high_map_ = nullptr;
  float* low_map_ = nullptr;
  MapShape high_shape_;
  std::optional<NormedConvolution> smooth_;
  std::vector<std::pair<float*, float*>> maps_;  ///< where each convolution reads and writes
};

ImageBackbone::Network::Network(const BackboneSizes& sizes,
                                const std::map<std::string, Tensor>& tensors)
    : tensors_(&tensors), image_{3, sizes.image_height, sizes.image_width} {
  const OneThread one_thread;
  for (std::size_t value = 0; value < pixel_values_.size(); ++value)
    pixel_values_[value] = static_cast<float>((static_cast<double>(value) / 255.0 - 0.5) / 0.25);
  pixels_ = newBuffer(image_.size());
  stem_ = convolve("stem.conv", "stem.norm", pixels_, image_, {2, 3});
  pooling_.emplace(engine_, stem_->convolution.outputShape(), layout_);
  shape_ = pooling_->outputShape();
  last_ = newBuffer(shape_.size());
  pooling_->bind(engine_, stem_->output, last_);
  float* middle = nullptr;
  MapShape middle_shape;
  for (std::size_t stage = 0; stage < BackboneSizes::kChannels.size(); ++stage) {
    for (std::int64_t block = 0; block < BackboneSizes::kBlocks; ++block)
      addBlock(blockName(stage, block), stage > 0 && block == 0 ? 2 : 1);
    if (stage == 1) {
      middle = last_;
      middle_shape = shape_;
    }
  }
  addPyramid(middle, middle_shape);
  bindScratch();
  tensors_ = nullptr;
}

ImageBackbone::Network::NormedConvolution ImageBackbone::Network::convolve(
    const std::string& name, const std::string& norm, float* input, const MapShape& shape,
    const ConvolutionOptions& options) {
  EncoderConvolution convolution(engine_, shape, layout_, options,
                                 tensorNamed(*tensors_, name + ".weight"));
  const MapShape& output = convolution.outputShape();
  EncoderNorm normalization(output, layout_, tensorNamed(*tensors_, norm + ".weight"),
                            tensorNamed(*tensors_, norm + ".bias"));
  float* map = newBuffer(output.size());
  maps_.emplace_back(input, map);
  return {std::move(convolution), std::move(normalization), map};
}

void ImageBackbone::Network::addBlock(const std::string& name, std::int64_t stride) {
  std::optional<NormedConvolution> down;
  if (tensors_->count(name + ".down.conv.weight") != 0)
    down = convolve(name + ".down.conv", name + ".down.norm", last_, shape_, {stride, 0});
  NormedConvolution first = convolve(name + ".conv1", name + ".norm1", last_, shape_, {stride, 1});
  NormedConvolution second = convolve(name + ".conv2", name + ".norm2", first.output,
                                      first.convolution.outputShape(), {1, 1});
  const float* input = last_;
  shape_ = second.convolution.outputShape();
  last_ = second.output;
  blocks_.push_back({std::move(first), std::move(second), std::move(down), input});
}

void ImageBackbone::Network::addPyramid(float* middle, const MapShape& middle_shape) {
  high_.emplace(engine_, shape_, layout_, ConvolutionOptions{},
                tensorNamed(*tensors_, "pyramid.high.weight"));
  low_.emplace(engine_, middle_shape, layout_, ConvolutionOptions{},
               tensorNamed(*tensors_, "pyramid.low.weight"));
  high_shape_ = high_->outputShape();
  high_map_ = newBuffer(high_shape_.size());
  low_map_ = newBuffer(low_->outputShape().size());
  const MapShape low_shape = low_->outputShape();
  maps_.emplace_back(last_, high_map_);
  maps_.emplace_back(middle, low_map_);
  smooth_ = convolve("pyramid.smooth.conv", "pyramid.smooth.norm", low_map_, low_shape, {1, 1});
}

float* ImageBackbone::Network::newBuffer(std::int64_t floats) {
  buffers_.emplace_back(
      dnnl::memory::desc({floats}, dnnl::memory::data_type::f32, dnnl::memory::format_tag::a),
      engine_);
  return static_cast<float*>(buffers_.back().get_data_handle());
}

/// All convolutions share one scratchpad; in the order in which they were made.
void ImageBackbone::Network::bindScratch() {
  std::vector<EncoderConvolution*> made = {&stem_->convolution};
  for (ResidualBlock& block : blocks_) {
    if (block.down) made.push_back(&block.down->convolution);
    made.push_back(&block.first.convolution);
    made.push_back(&block.second.convolution);
  }
  made.insert(made.end(), {&*high_, &*low_, &smooth_->convolution});
  std::size_t bytes = 0;
  for (const EncoderConvolution* one : made) bytes = std::max(bytes, one->scratchpadBytes());
  float* scratch = newBuffer(static_cast<std::int64_t>(bytes / sizeof(float)) + 1);
  for (std::size_t i = 0; i < made.size(); ++i)
    made[i]->bind(engine_, maps_[i].first, maps_[i].second, scratch);
}

void ImageBackbone::Network::readImage(const std::uint8_t* rgb) {
  const bool channels_last = imageLayout(layout_) == dnnl::memory::format_tag::nhwc;
  const std::int64_t channel_stride = channels_last ? 1 : image_.pixels();
  const std::int64_t pixel_stride = channels_last ? image_.channels : 1;
  for (std::int64_t pixel = 0; pixel < image_.pixels(); ++pixel) {
    for (std::int64_t channel = 0; channel < image_.channels; ++channel)
      pixels_[pixel * pixel_stride + channel * channel_stride] = pixel_values_[*rgb++];
  }
}

void ImageBackbone::Network::runBlock(const ResidualBlock& block) {
  block.first.run(stream_, nullptr, EncoderNorm::Activation::kRelu);
  if (block.down) block.down->run(stream_, nullptr, EncoderNorm::Activation::kNone);
  block.second.run(stream_, block.down ? block.down->output : block.input,
                   EncoderNorm::Activation::kRelu);
}

/// low += high, each cell of which covers two by two of low.
void ImageBackbone::Network::addStretched() {
  const MapShape low{high_shape_.channels, 2 * high_shape_.height, 2 * high_shape_.width};
  const ChannelBlocks from(high_shape_, layout_), to(low, layout_);
  for (std::int64_t block = 0; block < low.channels / to.width; ++block) {
    for (std::int64_t pixel = 0; pixel < low.pixels(); ++pixel) {
      const std::int64_t source = pixel / low.width / 2 * high_shape_.width + pixel % low.width / 2;
      addRow(high_map_ + block * from.block_stride + source * from.pixel_stride, to.width,
             low_map_ + block * to.block_stride + pixel * to.pixel_stride);
    }
  }
}

void ImageBackbone::Network::writeRows(const View& rows) const {
  const MapShape& shape = smooth_->convolution.outputShape();
  const ChannelBlocks blocks(shape, layout_);
  for (std::int64_t block = 0; block < shape.channels / blocks.width; ++block) {
    for (std::int64_t pixel = 0; pixel < shape.pixels(); ++pixel)
      std::copy_n(smooth_->output + block * blocks.block_stride + pixel * blocks.pixel_stride,
                  blocks.width, rows.data + pixel * rows.row + block * blocks.width);
  }
}

ImageBackbone::ImageBackbone(const BackboneSizes& sizes,
                             const std::map<std::string, Tensor>& tensors)
    : network_(std::make_unique<Network>(sizes, tensors)) {}
ImageBackbone::ImageBackbone(ImageBackbone&&) noexcept = default;
ImageBackbone& ImageBackbone::operator=(ImageBackbone&&) noexcept = default;
ImageBackbone::~ImageBackbone() = default;

void ImageBackbone::encode(const std::uint8_t* rgb, const View& rows) {
  const OneThread one_thread;
  Network& network = *network_;
  network.readImage(rgb);
  network.stem_->run(network.stream_, nullptr, EncoderNorm::Activation::kRelu);
  network.pooling_->run(network.stream_);
  for (const Network::ResidualBlock& block : network.blocks_) network.runBlock(block);
  network.high_->run(network.stream_);
  network.low_->run(network.stream_);
  network.addStretched();
  network.smooth_->run(network.stream_, nullptr, EncoderNorm::Activation::kRelu);
  network.stream_.wait();
  network.writeRows(rows);
}

std::vector<TensorShape> backboneTensors(const BackboneSizes& sizes) {
  TensorList list;
  const auto convolution = [&](const std::string& name, std::int64_t out, std::int64_t in,
                               std::int64_t kernel) {
    list.add(name + ".weight", {out, in, kernel, kernel});
  };
  std::int64_t channels = BackboneSizes::kChannels.front();
  convolution("stem.conv", channels, 3, 7);
  list.norm("stem.norm", channels);
  for (std::size_t stage = 0; stage < BackboneSizes::kChannels.size(); ++stage) {
    const std::int64_t wide = BackboneSizes::kChannels[stage];
    for (std::int64_t block = 0; block < BackboneSizes::kBlocks; ++block, channels = wide) {
      const std::string name = blockName(stage, block);
      convolution(name + ".conv1", wide, channels, 3);
      list.norm(name + ".norm1", wide);
      convolution(name + ".conv2", wide, wide, 3);
      list.norm(name + ".norm2", wide);
      if (channels == wide) continue;
      convolution(name + ".down.conv", wide, channels, 1);
      list.norm(name + ".down.norm", wide);
    }
  }
  convolution("pyramid.high", sizes.features, channels, 1);
  convolution("pyramid.low", sizes.features, BackboneSizes::kChannels[1], 1);
  convolution("pyramid.smooth.conv", sizes.features, sizes.features, 3);
  list.norm("pyramid.smooth.norm", sizes.features);
  return list.take();
}

}  // namespace cdiff::inference
