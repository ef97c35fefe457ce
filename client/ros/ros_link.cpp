#include "client/ros/ros_link.hpp"

#include <cstdlib>
#include <optional>

#include "client/ros/contact_markers.hpp"
#include "idl/ros_types.hpp"

namespace collided::ros {
namespace {

constexpr std::int64_t kSecondNs = 1'000'000'000;
// This process may be on the same domain as a client of a server; to Cyclone the two are apart.
constexpr int kOwnDomains = 1'000;

std::int64_t stamp_of(const builtin_interfaces_msg_dds__Time_& time) {
  return static_cast<std::int64_t>(time.sec) * kSecondNs + time.nanosec;
}

std::string text_of(const char* text) { return text == nullptr ? std::string() : std::string(text); }

RosTransform transform_of(const geometry_msgs_msg_dds__TransformStamped_& from, bool is_static) {
  const auto& t = from.transform.translation;
  const auto& r = from.transform.rotation;
  return {.parent = text_of(from.header.frame_id),
          .child = text_of(from.child_frame_id),
          .stamp_ns = stamp_of(from.header.stamp),
          .pose = {{t.x, t.y, t.z}, Quat(r.w, r.x, r.y, r.z)},
          .is_static = is_static};
}

dds::ParticipantOptions participant_of(const RosLinkOptions& options) {
  dds::ParticipantOptions made{
      .domain = options.domain, .role = dds::Role::server, .interface = options.interface, .peers = options.peers};
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  if (uri == nullptr || *uri == 0) made.process_domain = kOwnDomains + options.domain;
  return made;
}

enum Token : std::intptr_t { kTf, kTfStatic, kJointStates, kRobotDescription };

}  // namespace

struct RosEntities {
  explicit RosEntities(const RosLinkOptions& options)
      : participant(participant_of(options)),
        tf_topic(participant, kTopicPrefix, kTfTopic),
        tf_static_topic(participant, kTopicPrefix, kTfStaticTopic),
        contacts_topic(participant, kTopicPrefix, kContactMarkersTopic),
        tf(tf_topic),
        tf_static(tf_static_topic),
        contacts(contacts_topic),
        came(participant) {
    came.attach(tf, kTf);
    came.attach(tf_static, kTfStatic);
    if (!options.has_joint_states) return;
    joints_topic.emplace(participant, kTopicPrefix, kJointStateTopic);
    robot_topic.emplace(participant, kTopicPrefix, kRobotDescriptionTopic);
    joints.emplace(*joints_topic);
    robot.emplace(*robot_topic);
    came.attach(*joints, kJointStates);
    came.attach(*robot, kRobotDescription);
  }

  std::size_t take_transforms(dds::Reader<TfMessage>& reader, bool is_static, const RosTaker& taker) {
    std::size_t count = 0;
    while (reader.take(tf_sample)) {
      if (!tf_sample.info().valid_data) continue;
      ++count;
      for (const auto& transform : dds::view(tf_sample->transforms))
        taker.transform(transform_of(transform, is_static));
    }
    return count;
  }

  std::size_t take_joints(const RosTaker& taker) {
    std::size_t count = 0;
    while (joints->take(joints_sample)) {
      if (!joints_sample.info().valid_data) continue;
      ++count;
      RosJoints made{.stamp_ns = stamp_of(joints_sample->header.stamp), .names = {}, .positions = {}};
      for (const char* name : dds::view(joints_sample->name)) made.names.push_back(text_of(name));
      const auto positions = dds::view(joints_sample->position);
      made.positions.assign(positions.begin(), positions.end());
      taker.joints(made);
    }
    return count;
  }

  std::size_t take_robots(const RosTaker& taker) {
    std::size_t count = 0;
    while (robot->take(robot_sample)) {
      if (!robot_sample.info().valid_data) continue;
      ++count;
      taker.robot(text_of(robot_sample->data));
    }
    return count;
  }

  dds::Participant participant;
  dds::Topic<TfMessage> tf_topic, tf_static_topic;
  dds::Topic<MarkerArray> contacts_topic;
  std::optional<dds::Topic<JointState>> joints_topic;
  std::optional<dds::Topic<StringMessage>> robot_topic;
  dds::Reader<TfMessage> tf, tf_static;
  std::optional<dds::Reader<JointState>> joints;
  std::optional<dds::Reader<StringMessage>> robot;
  dds::Writer<MarkerArray> contacts;
  dds::WaitSet came;
  dds::Sample<TfMessage> tf_sample;
  dds::Sample<JointState> joints_sample;
  dds::Sample<StringMessage> robot_sample;
};

RosLink::RosLink(const RosLinkOptions& options) : entities_(std::make_unique<RosEntities>(options)) {}
RosLink::~RosLink() = default;
RosLink::RosLink(RosLink&&) noexcept = default;

std::size_t RosLink::take(std::chrono::nanoseconds wait, const RosTaker& taker) {
  std::size_t count = 0;
  for (const std::intptr_t token : entities_->came.wait(wait.count())) {
    if (token == kTf) count += entities_->take_transforms(entities_->tf, false, taker);
    if (token == kTfStatic) count += entities_->take_transforms(entities_->tf_static, true, taker);
    if (token == kJointStates) count += entities_->take_joints(taker);
    if (token == kRobotDescription) count += entities_->take_robots(taker);
  }
  return count;
}

bool RosLink::show(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns) {
  return write_contacts(entities_->contacts, contacts, frame, stamp_ns);
}

std::size_t RosLink::broadcasters() const {
  return std::size_t{entities_->tf.matched_writers()} + entities_->tf_static.matched_writers();
}

}  // namespace collided::ros
