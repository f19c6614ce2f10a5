// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "inference/encoder_map.h"

#include <omp.h>

namespace cdiff::inference {

using Tag = dnnl::memory::format_tag;

Tag preferredLayout(const dnnl::engine& engine) {
  const OneThread one_thread;
  const auto type = dnnl::memory::data_type::f32;
  const dnnl::memory::desc map({1, 64, 24, 40}, type, Tag::any);
  const dnnl::memory::desc weights({64, 64, 3, 3}, type, Tag::any);
  const dnnl::convolution_forward::desc description(dnnl::prop_kind::forward_inference,
                                                    dnnl::algorithm::convolution_direct, map,
                                                    weights, map, {1, 1}, {1, 1}, {1, 1});
  const dnnl::memory::desc chosen =
      dnnl::convolution_forward::primitive_desc(description, engine).dst_desc();
  for (const Tag tag : {Tag::nChw16c, Tag::nChw8c}) {
    if (chosen == dnnl::memory::desc({1, 64, 24, 40}, type, tag)) return tag;
  }
  return Tag::nhwc;
}

Tag imageLayout(Tag layout) { return layout == Tag::nhwc ? Tag::nhwc : Tag::nchw; }

dnnl::memory::desc mapDescription(const MapShape& shape, Tag layout) {
  return dnnl::memory::desc({1, shape.channels, shape.height, shape.width},
                            dnnl::memory::data_type::f32, layout);
}

ChannelBlocks::ChannelBlocks(const MapShape& shape, Tag layout)
    : width(layout == Tag::nChw8c ? 8 : 16),
      block_stride(layout == Tag::nhwc ? width : width * shape.pixels()),
      pixel_stride(layout == Tag::nhwc ? shape.channels : width) {}

OneThread::OneThread() : before_(omp_get_max_threads()) { omp_set_num_threads(1); }

OneThread::~OneThread() { omp_set_num_threads(before_); }

}  // namespace cdiff::inference
