#pragma once

#include "idl/dds.hpp"
#include "idl/ros.h"

/// The messages of ros.idl as wire types, and their ROS 2 topics: a topic /NAME is "rt/NAME" in DDS.
namespace collided::ros {

using TfMessage = ::tf2_msgs_msg_dds__TFMessage_;
using MarkerArray = ::visualization_msgs_msg_dds__MarkerArray_;
using Marker = ::visualization_msgs_msg_dds__Marker_;
using JointState = ::sensor_msgs_msg_dds__JointState_;
using StringMessage = ::std_msgs_msg_dds__String_;
using PoseStamped = ::geometry_msgs_msg_dds__PoseStamped_;
using PointCloud = ::sensor_msgs_msg_dds__PointCloud2_;
using Octomap = ::octomap_msgs_msg_dds__Octomap_;
using ClockMessage = ::rosgraph_msgs_msg_dds__Clock_;
using Float64Message = ::std_msgs_msg_dds__Float64_;
using Diagnostics = ::diagnostic_msgs_msg_dds__DiagnosticArray_;
using GzContacts = ::ros_gz_interfaces_msg_dds__Contacts_;

/// Used instead of a namespace.
inline constexpr const char* kTopicPrefix = "rt";

/// A reader accepts any writer of ROS: best effort for topics on which some publish sensor data. A queue of a thousand
/// holds a second of a hundred broadcasters; when it is full, the oldest is dropped, as in ROS.
inline constexpr wire_contract::TopicQos kTfTopic{
    "tf", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 1'000, 0, false};
inline constexpr wire_contract::TopicQos kTfStaticTopic{
    "tf_static", wire_contract::Reliability::reliable, wire_contract::Durability::transient_local, 1'000, 0, false};
inline constexpr wire_contract::TopicQos kJointStateTopic{
    "joint_states", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 100, 0, false};
inline constexpr wire_contract::TopicQos kRobotDescriptionTopic{
    "robot_description", wire_contract::Reliability::reliable, wire_contract::Durability::transient_local, 1, 0, false};
/// For PoseStamped; the user chooses the topic's name.
inline constexpr wire_contract::TopicQos kPoseStampedTopic{
    "pose", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 100, 0, false};
inline constexpr wire_contract::TopicQos kContactMarkersTopic{
    "collided/contacts", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 10, 0, false};

/// For sensors, which mostly publish with best effort. The next cloud replaces a cloud.
inline constexpr wire_contract::TopicQos kPointCloudTopic{
    "points", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 5, 0, false};
inline constexpr wire_contract::TopicQos kOctomapTopic{
    "octomap_binary", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 5, 0, false};
inline constexpr wire_contract::TopicQos kMarkersTopic{
    "markers", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 100, 0, false};
inline constexpr wire_contract::TopicQos kClockTopic{
    "clock", wire_contract::Reliability::best_effort, wire_contract::Durability::volatile_data, 10, 0, false};
inline constexpr wire_contract::TopicQos kObjectMarkersTopic{
    "collided/objects", wire_contract::Reliability::reliable, wire_contract::Durability::transient_local, 1, 0, false};
inline constexpr wire_contract::TopicQos kGzContactsTopic{"collided/contact_states",
                                                          wire_contract::Reliability::reliable,
                                                          wire_contract::Durability::volatile_data,
                                                          10,
                                                          0,
                                                          false};
inline constexpr wire_contract::TopicQos kClearanceTopic{
    "collided/clearance", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 10, 0, false};
inline constexpr wire_contract::TopicQos kDiagnosticsTopic{
    "diagnostics", wire_contract::Reliability::reliable, wire_contract::Durability::volatile_data, 10, 0, false};

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
template <>
struct WireType<ros::PointCloud> {
  static constexpr const dds_topic_descriptor_t* descriptor = &sensor_msgs_msg_dds__PointCloud2__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kPointCloudTopic;
};
template <>
struct WireType<ros::Octomap> {
  static constexpr const dds_topic_descriptor_t* descriptor = &octomap_msgs_msg_dds__Octomap__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kOctomapTopic;
};
template <>
struct WireType<ros::ClockMessage> {
  static constexpr const dds_topic_descriptor_t* descriptor = &rosgraph_msgs_msg_dds__Clock__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kClockTopic;
};
template <>
struct WireType<ros::Float64Message> {
  static constexpr const dds_topic_descriptor_t* descriptor = &std_msgs_msg_dds__Float64__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kClearanceTopic;
};
template <>
struct WireType<ros::Diagnostics> {
  static constexpr const dds_topic_descriptor_t* descriptor = &diagnostic_msgs_msg_dds__DiagnosticArray__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kDiagnosticsTopic;
};
template <>
struct WireType<ros::GzContacts> {
  static constexpr const dds_topic_descriptor_t* descriptor = &ros_gz_interfaces_msg_dds__Contacts__desc;
  static constexpr const wire_contract::TopicQos& row = ros::kGzContactsTopic;
};

}  // namespace collided::dds
