#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/runtime/clock.hpp"

namespace collided::engine::service {

/// Which publisher is behind which DDS writer, learnt from its samples; tells who has died.
class PublisherLiveliness {
 public:
  PublisherLiveliness(Inbox& inbox, WriterKind kind) : inbox_(inbox), kind_(kind) {}
  void heard(std::uint64_t writer, std::uint64_t publisher);
  void liveliness(const dds::Liveliness& change);
  void lost(std::uint64_t publisher);

 private:
  Inbox& inbox_;
  const WriterKind kind_;
  std::mutex mutex_;
  std::map<std::uint64_t, std::uint64_t> publishers_;  // by writer
  std::uint32_t alive_ = 0;
  std::uint32_t not_alive_ = 0;
};

/// The readers of what comes in. Their callbacks take, stamp and hand over; nothing is decided here.
class Listeners {
 public:
  /// flight  hears of all but the questions, which Answering takes; may be null
  Listeners(const dds::Participant& participant, const std::string& name_space, const WorldClock& clock, Inbox& inbox,
            Answering& answering, FlightRecorder* flight);

  /// The query writers that are there now.
  std::vector<std::uint64_t> askers() const { return query_reader_.matched_writer_handles(); }

  /// Definitions that were left with DDS because the inbox was full. Now and then, from one thread.
  void take_left_definitions();

 private:
  void take_definitions(const dds::Taker<wire::Definition>& taker);
  void take_poses(const dds::Taker<wire::PoseBatch>& taker);

  const WorldClock& clock_;
  Inbox& inbox_;
  FlightRecorder* const flight_;
  PublisherLiveliness object_writers_;
  PublisherLiveliness pose_writers_;
  std::mutex taking_definitions_;
  std::atomic<bool> definitions_left_{false};
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::Query> query_topic_;
  dds::Reader<wire::Definition> object_reader_;
  dds::Reader<wire::PoseBatch> pose_reader_;
  dds::Reader<wire::Query> query_reader_;
};

}  // namespace collided::engine::service
