// SPDX-License-Identifier: BSD-3-Clause
// Copyright (c) 2026 The e2e_cdiff authors
#include "node_graph/nodes/camera_node.h"

#include "node_graph/messages/channel_conversions.h"
#include "node_graph/messages/message_checks.h"
#include "node_graph/messages/session_conversions.h"
#include "node_graph/messages/traffic_conversions.h"
#include "node_graph/session_graph.h"

namespace cdiff::node_graph {
namespace {

constexpr std::uint32_t kQueueSize = 1000;

}  // namespace

void CameraNode::startSession(const msgs::SessionInfo& info) {
  setup_ = setupOf(info);
  cameras_ = std::make_unique<session::VehicleCameras>(*setup_);
  if (graph().imagesOfEgo()) open(kEgoSlot);
  if (!graph().imagesOfCbvs()) return;
  for (int slot = 0; slot < graph().max_cbv; ++slot) open(slot);
  listen<msgs::CbvSelection>(ChannelId::kSelection, [this](const auto& selection) {
    const std::string wrong = unusable(*selection, graph().max_cbv);
    if (wrong.empty()) selections_.emplace(selection->tick, selection);
    return wrong;
  });
}

void CameraNode::open(int slot) {
  for (const std::string& camera : cameras_->rigs().of(slot).names()) open(slot, camera);
}

/// Every transport that is installed counts as the image topic itself: the nodes that the session
/// counts on take the raw one.
void CameraNode::open(int slot, const std::string& camera) {
  const std::string topic = imageOf(slot, camera).name();
  connections().expect(topic, listeners(imageOf(slot, camera), graph()));
  const auto connect = [this, topic](const image_transport::SingleSubscriberPublisher& peer) {
    connections().connected(topic, peer.getSubscriberName());
  };
  const auto disconnect = [this, topic](const image_transport::SingleSubscriberPublisher& peer) {
    connections().disconnected(topic, peer.getSubscriberName());
  };
  outputs_[{slot, camera}] = {transport_.advertise(topic, kQueueSize, connect, disconnect),
                              advertise<sensor_msgs::CameraInfo>(cameraInfoOf(slot, camera))};
}

bool CameraNode::handle(const Snapshot& message, bool superseded) {
  if (!message->decision_tick) return true;
  const auto found = selections_.find(message->tick);
  if (graph().imagesOfCbvs() && found == selections_.end()) return superseded;
  const traffic::TrafficSnapshot snapshot = fromMsg(*message);
  const traffic::Vehicle* ego = snapshot.ego();
  if (graph().imagesOfEgo() && ego != nullptr) show(kEgoSlot, snapshot, ego->id);
  if (found == selections_.end()) return true;
  for (const msgs::CbvAssignment& assignment : found->second->assignments)
    show(assignment.slot, snapshot, assignment.vehicle_id);
  selections_.erase(selections_.begin(), selections_.upper_bound(message->tick));
  return true;
}

void CameraNode::show(int slot, const traffic::TrafficSnapshot& snapshot,
                      const std::string& vehicle_id) {
  const traffic::Vehicle* vehicle = snapshot.find(vehicle_id);
  if (vehicle == nullptr) return;
  std::vector<session::SlotImage> images;
  cameras_->render(snapshot, *vehicle, slot, images);
  for (const session::SlotImage& seen : images) {
    const auto image = boost::make_shared<const sensor_msgs::Image>(
        toMsg(seen.image, snapshot.time, vehicle_id, seen.camera));
    const rendering::RigCamera& camera = *cameras_->rigs().of(slot).find(seen.camera);
    const Output& output = outputs_.at({slot, seen.camera});
    output.infos.publish(
        boost::make_shared<const sensor_msgs::CameraInfo>(toCameraInfoMsg(camera, image->header)));
    output.images.publish(image);
    ++images_;
  }
}

}  // namespace cdiff::node_graph
