#pragma once

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "tests/keys/raw_participant.hpp"
#include "tests/service/eventually.hpp"

namespace collided::test {

/// A topic, or one partition of the topic of queries.
struct Way {
  const wire_contract::TopicQos* row;
  const dds_topic_descriptor_t* type;
  std::string partition;

  std::string name() const { return row->suffix + (row == &wire_contract::kQueryTopic ? ' ' + partition : ""); }
};

inline const std::vector<Way>& ways() {
  using namespace wire_contract;
  static const std::vector<Way> all = [] {
    std::vector<Way> made{{&kObjectTopic, &collided_wire_v2_Definition_desc, ""},
                          {&kPoseTopic, &collided_wire_v2_PoseBatch_desc, ""},
                          {&kReplyTopic, &collided_wire_v2_Reply_desc, "client_00"},
                          {&kStatusTopic, &collided_wire_v2_Status_desc, ""},
                          {&kMemberTopic, &collided_wire_v2_Member_desc, ""},
                          {&kChangeTopic, &collided_wire_v2_Change_desc, ""},
                          {&kStepTopic, &collided_wire_v2_Status_desc, ""},
                          {&kEventTopic, &collided_wire_v2_EventFrame_desc, ""},
                          {&kPersistedTopic, &collided_wire_v2_EventFrame_desc, ""},
                          {&kWatermarkTopic, &collided_wire_v2_EventFrame_desc, ""},
                          {&kContactTopic, &collided_wire_v2_ContactShard_desc, ""},
                          {&kProbeTopic, &collided_wire_v2_ProbeFrame_desc, ""},
                          {&kStandingEventTopic, &collided_wire_v2_StandingFrame_desc, ""},
                          {&kStandingStateTopic, &collided_wire_v2_StandingShard_desc, ""}};
    for (const QueryRight right : kQueryRights)
      made.push_back({&kQueryTopic, &collided_wire_v2_Query_desc, name_of(right)});
    return made;
  }();
  return all;
}

/// A reader and a writer of every way.
class Everything {
 public:
  Everything(const std::string& keys, int place) : participant_(keys, place) {
    for (const Way& way : ways()) ends_.push_back(make(way));
  }
  void write_all() {
    for (const Ends& ends : ends_) {
      // Only the key's place matters to DDS: all types are zero throughout.
      alignas(16) static const char zero[16'384] = {};
      dds_write(ends.writer, zero);
    }
  }
  /// The ways by which anything has come since the last call. Nobody hears himself.
  std::set<std::string> heard() {
    std::set<std::string> names;
    for (std::size_t i = 0; i < ends_.size(); ++i) {
      void* sample[1] = {nullptr};
      dds_sample_info_t info[1];
      while (true) {
        const dds_return_t count = dds_take(ends_[i].reader, sample, info, 1, 1);
        if (count <= 0) break;
        if (info[0].valid_data) names.insert(ways()[i].name());
        dds_return_loan(ends_[i].reader, sample, count);
      }
    }
    return names;
  }

 private:
  struct Ends {
    dds_entity_t reader;
    dds_entity_t writer;
  };

  Ends make(const Way& way) {
    dds_qos_t* const qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_BEST_EFFORT, 0);
    dds_qset_ignorelocal(qos, DDS_IGNORELOCAL_PARTICIPANT);
    const std::string topic_name = own_namespace() + '/' + way.row->suffix;
    const dds_entity_t participant = participant_.get();
    dds_entity_t topic = 0;
    if (const auto found = topics_.find(topic_name); found != topics_.end()) topic = found->second;
    else
      topic = topics_[topic_name] =
          dds::check(dds_create_topic(participant, way.type, topic_name.c_str(), nullptr, nullptr), topic_name);
    dds_qos_t* const group = dds_create_qos();
    if (!way.partition.empty()) dds_qset_partition1(group, way.partition.c_str());
    const dds_entity_t subscriber = dds::check(dds_create_subscriber(participant, group, nullptr), "subscriber");
    const dds_entity_t publisher = dds::check(dds_create_publisher(participant, group, nullptr), "publisher");
    const Ends ends{dds::check(dds_create_reader(subscriber, topic, qos, nullptr), topic_name + " reader"),
                    dds::check(dds_create_writer(publisher, topic, qos, nullptr), topic_name + " writer")};
    dds_delete_qos(group);
    dds_delete_qos(qos);
    return ends;
  }

  RawParticipant participant_;
  std::map<std::string, dds_entity_t> topics_;
  std::vector<Ends> ends_;
};

/// What `to` hears of `from` once all that is expected has come, and a little later; `patience` is for the former.
inline std::set<std::string> passes(Everything& from, Everything& to, const std::set<std::string>& expected = {},
                                    std::chrono::milliseconds patience = std::chrono::seconds(10)) {
  std::set<std::string> heard;
  const auto go_on = [&] {
    from.write_all();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    heard.merge(to.heard());
  };
  eventually([&] { return go_on(), std::ranges::includes(heard, expected); }, patience);
  for (int i = 0; i < 30; ++i) go_on();
  return heard;
}

}  // namespace collided::test
