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

enum Token : std::intptr_t { kTf, kTfStatic, kJointStates, kRobotDescription, kFirstPose };

/// A topic of poses, whose name it keeps.
struct PoseReading {
  PoseReading(const dds::Participant& participant, const RosPoseTopic& of)
      : name(of.topic.substr(of.topic.starts_with('/') ? 1 : 0)),
        frame(of.frame),
        row(row_of(name)),
        topic(participant, kTopicPrefix, row),
        reader(topic) {}
  PoseReading(const PoseReading&) = delete;
  PoseReading& operator=(const PoseReading&) = delete;
  static wire_contract::TopicQos row_of(const std::string& name) {
    wire_contract::TopicQos row = kPoseStampedTopic;
    row.suffix = name.c_str();
    return row;
  }

  std::string name;
  std::string frame;
  wire_contract::TopicQos row;
  dds::Topic<PoseStamped> topic;
  dds::Reader<PoseStamped> reader;
  dds::Sample<PoseStamped> sample;
};

RosTransform transform_of(const PoseStamped& from, const std::string& frame) {
  const auto& p = from.pose.position;
  const auto& r = from.pose.orientation;
  return {.parent = text_of(from.header.frame_id),
          .child = frame,
          .stamp_ns = stamp_of(from.header.stamp),
          .pose = {{p.x, p.y, p.z}, Quat(r.w, r.x, r.y, r.z)},
          .is_static = false};
}

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
    for (const RosPoseTopic& pose : options.poses) {
      poses.push_back(std::make_unique<PoseReading>(participant, pose));
      came.attach(poses.back()->reader, kFirstPose + static_cast<std::intptr_t>(poses.size()) - 1);
    }
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

  static std::size_t take_poses(PoseReading& pose, const RosTaker& taker) {
    std::size_t count = 0;
    while (pose.reader.take(pose.sample)) {
      if (!pose.sample.info().valid_data) continue;
      ++count;
      taker.transform(transform_of(*pose.sample, pose.frame));
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
  std::vector<std::unique_ptr<PoseReading>> poses;
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
    if (token >= kFirstPose)
      count += entities_->take_poses(*entities_->poses[static_cast<std::size_t>(token - kFirstPose)], taker);
  }
  return count;
}

bool RosLink::show(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns) {
  return write_contacts(entities_->contacts, contacts, frame, stamp_ns);
}

std::size_t RosLink::broadcasters() const {
  std::size_t count = std::size_t{entities_->tf.matched_writers()} + entities_->tf_static.matched_writers();
  for (const auto& pose : entities_->poses) count += pose->reader.matched_writers();
  return count;
}

}  // namespace collided::ros
