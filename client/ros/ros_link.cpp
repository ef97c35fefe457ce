#include "client/ros/ros_link.hpp"

#include <cstdlib>
#include <optional>

#include "client/ros/ros_messages.hpp"
#include "client/ros/written_messages.hpp"

namespace collided::ros {
namespace {

// This process may be on the same domain as a client of a server; to Cyclone the two are separate.
constexpr int kOwnDomains = 1'000;

dds::ParticipantOptions participant_of(const RosLinkOptions& options) {
  dds::ParticipantOptions made{
      .domain = options.domain, .role = dds::Role::server, .interface = options.interface, .peers = options.peers};
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  if (uri == nullptr || *uri == 0) made.process_domain = kOwnDomains + options.domain;
  return made;
}

/// A topic whose name is the user's, with its reader.
template <class T>
struct NamedReader {
  NamedReader(const dds::Participant& participant, const std::string& topic_name, const wire_contract::TopicQos& like)
      : name(topic_name.substr(topic_name.starts_with('/') ? 1 : 0)),
        row(row_of(name, like)),
        topic(participant, kTopicPrefix, row),
        reader(topic) {}
  NamedReader(const NamedReader&) = delete;
  NamedReader& operator=(const NamedReader&) = delete;
  static wire_contract::TopicQos row_of(const std::string& name, wire_contract::TopicQos row) {
    row.suffix = name.c_str();
    return row;
  }

  std::string name;
  wire_contract::TopicQos row;
  dds::Topic<T> topic;
  dds::Reader<T> reader;
  dds::Sample<T> sample;
};

/// Calls visit(sample) for each waiting sample; returns their number.
template <class T, class Visit>
std::size_t take_all(dds::Reader<T>& reader, dds::Sample<T>& sample, Visit&& visit) {
  std::size_t count = 0;
  while (reader.take(sample)) {
    if (!sample.info().valid_data) continue;
    ++count;
    visit(*sample);
  }
  return count;
}

RosJoints joints_of(const JointState& from) {
  RosJoints made{.stamp_ns = stamp_of(from.header.stamp), .names = {}, .positions = {}};
  for (const char* name : dds::view(from.name)) made.names.push_back(text_of(name));
  const auto positions = dds::view(from.position);
  made.positions.assign(positions.begin(), positions.end());
  return made;
}

}  // namespace

struct RosEntities {
  /// Takes the samples of one reader.
  using Take = std::function<std::size_t(const RosTaker&)>;

  explicit RosEntities(const RosLinkOptions& options)
      : participant(participant_of(options)),
        contacts_topic(participant, kTopicPrefix, kContactMarkersTopic),
        objects_topic(participant, kTopicPrefix, kObjectMarkersTopic),
        states_topic(participant, kTopicPrefix, kGzContactsTopic),
        clearance_topic(participant, kTopicPrefix, kClearanceTopic),
        diagnostics_topic(participant, kTopicPrefix, kDiagnosticsTopic),
        tf_topic(participant, kTopicPrefix, kTfTopic),
        contacts(contacts_topic),
        objects(objects_topic),
        states(states_topic),
        clearance(clearance_topic),
        diagnostics(diagnostics_topic),
        came(participant) {
    // One topic may have a reader and a writer; the writer must ignore its own messages, so it remembers them.
    if (options.sends_tf) tf_out.emplace(tf_topic);
    read<TfMessage>("tf", kTfTopic, [](const TfMessage& message, const RosTaker& taker) {
      for (const auto& transform : dds::view(message.transforms)) taker.transform(transform_of(transform, false));
    });
    read<TfMessage>("tf_static", kTfStaticTopic, [](const TfMessage& message, const RosTaker& taker) {
      for (const auto& transform : dds::view(message.transforms)) taker.transform(transform_of(transform, true));
    });
    for (const RosPoseTopic& pose : options.poses) {
      read<PoseStamped>(pose.topic, kPoseStampedTopic,
                        [frame = pose.frame](const PoseStamped& message, const RosTaker& taker) {
                          taker.transform(transform_of(message, frame));
                        });
    }
    read_things(options);
    if (options.has_clock) {
      read<ClockMessage>("clock", kClockTopic, [](const ClockMessage& message, const RosTaker& taker) {
        taker.clock(stamp_of(message.clock));
      });
    }
    if (!options.has_joint_states) return;
    read<JointState>("joint_states", kJointStateTopic,
                     [](const JointState& message, const RosTaker& taker) { taker.joints(joints_of(message)); });
    read<StringMessage>(
        "robot_description", kRobotDescriptionTopic,
        [](const StringMessage& message, const RosTaker& taker) { taker.robot(text_of(message.data)); });
  }

  void read_things(const RosLinkOptions& options) {
    for (std::size_t i = 0; i < options.clouds.size(); ++i) {
      read<PointCloud>(options.clouds[i], kPointCloudTopic,
                       [i](const PointCloud& message, const RosTaker& taker) { taker.cloud(i, cloud_of(message)); });
    }
    for (std::size_t i = 0; i < options.octomaps.size(); ++i) {
      read<Octomap>(options.octomaps[i], kOctomapTopic,
                    [i](const Octomap& message, const RosTaker& taker) { taker.octomap(i, octomap_of(message)); });
    }
    for (std::size_t i = 0; i < options.markers.size(); ++i) {
      read<MarkerArray>(options.markers[i], kMarkersTopic, [i](const MarkerArray& message, const RosTaker& taker) {
        for (const auto& marker : dds::view(message.markers)) taker.marker(i, marker_of(marker));
      });
    }
  }

  /// Reads a topic; passes messages on one by one.
  template <class T, class HandOver>
  void read(const std::string& name, const wire_contract::TopicQos& like, HandOver hand_over) {
    auto reading = std::make_shared<NamedReader<T>>(participant, name, like);
    came.attach(reading->reader, static_cast<std::intptr_t>(takes.size()));
    takes.push_back([reading, hand_over](const RosTaker& taker) {
      return take_all(reading->reader, reading->sample, [&](const T& message) { hand_over(message, taker); });
    });
    writers.push_back([reading] { return std::size_t{reading->reader.matched_writers()}; });
  }

  dds::Participant participant;
  dds::Topic<MarkerArray> contacts_topic, objects_topic;
  dds::Topic<GzContacts> states_topic;
  dds::Topic<Float64Message> clearance_topic;
  dds::Topic<Diagnostics> diagnostics_topic;
  dds::Topic<TfMessage> tf_topic;
  std::vector<Take> takes;  // by token of the waitset
  std::vector<std::function<std::size_t()>> writers;
  dds::Writer<MarkerArray> contacts, objects;
  dds::Writer<GzContacts> states;
  dds::Writer<Float64Message> clearance;
  dds::Writer<Diagnostics> diagnostics;
  std::optional<dds::Writer<TfMessage>> tf_out;
  dds::WaitSet came;
};

RosLink::RosLink(const RosLinkOptions& options) : entities_(std::make_unique<RosEntities>(options)) {}
RosLink::~RosLink() = default;
RosLink::RosLink(RosLink&&) noexcept = default;

std::size_t RosLink::take(std::chrono::nanoseconds wait, const RosTaker& taker) {
  std::size_t count = 0;
  for (const std::intptr_t token : entities_->came.wait(wait.count()))
    count += entities_->takes[static_cast<std::size_t>(token)](taker);
  return count;
}

bool RosLink::show(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns) {
  return write_contacts(entities_->contacts, contacts, frame, stamp_ns);
}

bool RosLink::tell(const std::vector<ShownContact>& contacts, const std::string& frame, std::int64_t stamp_ns) {
  return write_contacts(entities_->states, contacts, frame, stamp_ns);
}

bool RosLink::show(const std::vector<ShownMarker>& objects, const std::string& frame, std::int64_t stamp_ns) {
  return write_objects(entities_->objects, objects, frame, stamp_ns);
}

bool RosLink::send(const std::vector<RosTransform>& transforms) {
  return entities_->tf_out && write_transforms(*entities_->tf_out, transforms);
}

bool RosLink::tell_clearance(double clearance_m) {
  Float64Message message{};
  message.data = clearance_m;
  return entities_->clearance.write(message);
}

bool RosLink::tell(const std::vector<RosDiagnostic>& diagnostics, std::int64_t stamp_ns) {
  return write_diagnostics(entities_->diagnostics, diagnostics, stamp_ns);
}

std::size_t RosLink::broadcasters() const {
  std::size_t count = 0;
  for (const auto& writers : entities_->writers) count += writers();
  return count;
}

}  // namespace collided::ros
