#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>

#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>

/// Entities of Fast DDS with the QoS that the guide's table gives: what a program that has nothing of ours but the IDL would write.
namespace collided::interop {

namespace fast = eprosima::fastdds::dds;

inline constexpr int kSamplesKept = 256;  // of a writer, until they are acknowledged

/// What a topic's row says. lease_ms > 0: of a writer, by its own assertions.
struct TopicSettings {
  std::string suffix;
  bool is_durable = false;
  std::string partition = {};
  int lease_ms = 0;
  std::string prefix = "collided/";
};

/// Calls `condition` until it is true; throws with `what` after 20 s.
inline void wait_until(const std::function<bool()>& condition, const std::string& what) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > until) throw std::runtime_error("waited 20 s for " + what);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

/// A participant on this machine's loopback that looks for others where Cyclone DDS puts them: without multicast.
class Link {
 public:
  explicit Link(int domain) {
    using eprosima::fastrtps::rtps::IPLocator;
    fast::DomainParticipantQos qos;
    qos.transport().use_builtin_transports = false;
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.push_back("127.0.0.1");
    udp->sendBufferSize = udp->receiveBufferSize = 4 << 20;
    qos.transport().user_transports.push_back(udp);
    for (int index = 0; index < 4; ++index) {
      eprosima::fastrtps::rtps::Locator_t peer;
      IPLocator::setIPv4(peer, 127, 0, 0, 1);
      peer.kind = LOCATOR_KIND_UDPv4;
      peer.port = static_cast<std::uint32_t>(7'410 + 250 * domain + 2 * index);  // RTPS 9.6.1.1
      qos.wire_protocol().builtin.initialPeersList.push_back(peer);
    }
    participant_ =
        fast::DomainParticipantFactory::get_instance()->create_participant(static_cast<fast::DomainId_t>(domain), qos);
    if (participant_ == nullptr) throw std::runtime_error("no participant on domain " + std::to_string(domain));
  }
  ~Link() {
    participant_->delete_contained_entities();
    fast::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Link(const Link&) = delete;
  Link& operator=(const Link&) = delete;

  /// Keeps what is not acknowledged and waits where there is too much of it, so that nothing is lost.
  template <class Type>
  fast::DataWriter* writer(const TopicSettings& settings) {
    fast::PublisherQos group;
    if (!settings.partition.empty()) group.partition().push_back(settings.partition.c_str());
    fast::DataWriterQos qos;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.reliability().max_blocking_time = {10, 0};
    qos.durability().kind = settings.is_durable ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    if (settings.is_durable) {
      qos.history().kind = fast::KEEP_LAST_HISTORY_QOS;
      qos.history().depth = 1;
    } else {
      qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
      qos.resource_limits().max_samples = qos.resource_limits().max_samples_per_instance = kSamplesKept;
      qos.resource_limits().max_instances = 1;
      qos.resource_limits().allocated_samples = 16;
    }
    if (settings.lease_ms > 0) {
      qos.liveliness().kind = fast::MANUAL_BY_TOPIC_LIVELINESS_QOS;
      const auto milliseconds = [](int count) {
        return eprosima::fastrtps::Duration_t(count / 1'000, static_cast<std::uint32_t>(count % 1'000) * 1'000'000U);
      };
      qos.liveliness().lease_duration = milliseconds(settings.lease_ms);
      qos.liveliness().announcement_period = milliseconds(settings.lease_ms / 3);
    }
    qos.writer_data_lifecycle().autodispose_unregistered_instances = false;
    // Every 3 s otherwise, and only after one does a reader say what it has.
    qos.reliable_writer_qos().times.heartbeatPeriod = {0, 5'000'000};
    qos.data_sharing().off();
    // The generator takes a sequence without a limit for one of 100 elements.
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    fast::DataWriter* made = participant_->create_publisher(group)->create_datawriter(topic<Type>(settings), qos);
    if (made == nullptr) throw std::runtime_error("no writer of " + settings.suffix);
    return made;
  }
  template <class Type>
  fast::DataReader* reader(const TopicSettings& settings) {
    fast::SubscriberQos group;
    if (!settings.partition.empty()) group.partition().push_back(settings.partition.c_str());
    fast::DataReaderQos qos;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = settings.is_durable ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    qos.history().kind = fast::KEEP_ALL_HISTORY_QOS;
    qos.resource_limits().max_samples = 0;
    qos.resource_limits().max_samples_per_instance = 0;
    qos.resource_limits().max_instances = 0;
    qos.data_sharing().off();
    qos.endpoint().history_memory_policy = eprosima::fastrtps::rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    fast::DataReader* made = participant_->create_subscriber(group)->create_datareader(topic<Type>(settings), qos);
    if (made == nullptr) throw std::runtime_error("no reader of " + settings.suffix);
    return made;
  }

 private:
  template <class Type>
  fast::Topic* topic(const TopicSettings& settings) {
    const fast::TypeSupport type(new Type);
    type.register_type(participant_);
    fast::Topic* made =
        participant_->create_topic(settings.prefix + settings.suffix, type.get_type_name(), fast::TOPIC_QOS_DEFAULT);
    if (made == nullptr) throw std::runtime_error("no topic " + settings.suffix);
    return made;
  }

  fast::DomainParticipant* participant_ = nullptr;
};

inline void wait_for_match(fast::DataWriter* writer, const std::string& what) {
  wait_until(
      [&] {
        fast::PublicationMatchedStatus status;
        writer->get_publication_matched_status(status);
        return status.current_count > 0;
      },
      "a reader of " + what);
}
inline void wait_for_match(fast::DataReader* reader, const std::string& what) {
  wait_until(
      [&] {
        fast::SubscriptionMatchedStatus status;
        reader->get_subscription_matched_status(status);
        return status.current_count > 0;
      },
      "a writer of " + what);
}

}  // namespace collided::interop
