#pragma once

#include "idl/dds.hpp"
#include "idl/ros.h"

/// The messages of ros.idl as wire types, and the topics on which ROS 2 has them: a topic /NAME is "rt/NAME" there.
namespace collided::ros {

using TfMessage = ::tf2_msgs_msg_dds__TFMessage_;
using MarkerArray = ::visualization_msgs_msg_dds__MarkerArray_;
using Marker = ::visualization_msgs_msg_dds__Marker_;
using JointState = ::sensor_msgs_msg_dds__JointState_;
using StringMessage = ::std_msgs_msg_dds__String_;
using PoseStamped = ::geometry_msgs_msg_dds__PoseStamped_;

/// In place of a namespace.
inline constexpr const char* kTopicPrefix = "rt";

/// A reader takes what any writer of ROS offers: best effort where some publish sensor data so. A queue of a thousand
/// is a second of a hundred broadcasters; what it has no room for, the oldest, is lost as in ROS.
inline constexpr wire_contract::TopicQos kTfTopic{
    "tf", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 1'000, 0, false};
inline constexpr wire_contract::TopicQos kTfStaticTopic{
    "tf_static", wire_contract::Reliability::reliable, wire_contract::Durability::transient_local, 1'000, 0, false};
inline constexpr wire_contract::TopicQos kJointStateTopic{
    "joint_states", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 100, 0, false};
inline constexpr wire_contract::TopicQos kRobotDescriptionTopic{
    "robot_description", wire_contract::Reliability::reliable, wire_contract::Durability::transient_local, 1, 0, false};
/// Of PoseStamped; the topic's name is the user's.
inline constexpr wire_contract::TopicQos kPoseStampedTopic{
    "pose", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 100, 0, false};
inline constexpr wire_contract::TopicQos kContactMarkersTopic{
    "collided/contacts", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 10, 0, false};

}  // namespace collided::ros

namespace collided::dds {

template <>
struct WireType<ros::TfMessage> {
  static constexpr const dds_topic_descriptor_t* descriptor = &tf2_msgs_msg_dds__TFMessage__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kTfTopic;
};
template <>
struct WireType<ros::MarkerArray> {
  static constexpr const dds_topic_descriptor_t* descriptor = &visualization_msgs_msg_dds__MarkerArray__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kContactMarkersTopic;
};
template <>
struct WireType<ros::JointState> {
  static constexpr const dds_topic_descriptor_t* descriptor = &sensor_msgs_msg_dds__JointState__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kJointStateTopic;
};
template <>
struct WireType<ros::PoseStamped> {
  static constexpr const dds_topic_descriptor_t* descriptor = &geometry_msgs_msg_dds__PoseStamped__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kPoseStampedTopic;
};
template <>
struct WireType<ros::StringMessage> {
  static constexpr const dds_topic_descriptor_t* descriptor = &std_msgs_msg_dds__String__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kRobotDescriptionTopic;
};

}  // namespace collided::dds
