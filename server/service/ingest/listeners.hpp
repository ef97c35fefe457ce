#pragma once

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/geometry/function_ref.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/publisher_owners.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/participants.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::engine::service {

/// Learns from samples which publishers are behind which DDS writer, lets only a number's owner use it, and notifies
/// the inbox when a publisher's writer has come alive or is gone.
///
/// threads  any; DDS calls it from its own
class PublisherLiveliness {
 public:
  PublisherLiveliness(Inbox& inbox, PublisherOwners& owners, WriterKind kind)
      : inbox_(inbox), owners_(owners), kind_(kind) {}
  /// Whether a sample under this number is accepted.
  ///
  /// writer    its publication handle
  /// owner_of  called if the writer is new
  bool admits(std::uint64_t writer, std::uint64_t publisher, FunctionRef<NumberOwner()> owner_of);
  /// Drops the writers that are not among the matched ones and were not at the last call either: DDS names only the
  /// last of several that leave at once.
  void keep_only(std::span<const std::uint64_t> matched);
  /// A change in DDS's counts of live and silent writers. One that has sent no sample yet is not known and not
  /// reported.
  void liveliness(const dds::Liveliness& change);
  /// DDS reports that the publisher's instance has no writer left.
  void lost(std::uint64_t publisher);

 private:
  struct Writer {
    NumberOwner owner;
    bool is_alive = true;
    bool is_missed = false;  // by the last keep_only()
    std::vector<std::uint64_t> publishers;
  };
  void let_go(std::uint64_t handle, const Writer& writer);

  Inbox& inbox_;
  PublisherOwners& owners_;
  const WriterKind kind_;
  std::mutex mutex_;
  std::map<std::uint64_t, Writer> writers_;  // by handle
  std::uint32_t alive_ = 0;                  // DDS's counts at the last change
  std::uint32_t not_alive_ = 0;
};

/// The DDS readers of everything that comes in: definitions, poses, questions. Their callbacks take, stamp and pass on;
/// they decide nothing. References and pointers given to the constructor must outlive this.
class Listeners {
 public:
  /// name_space  whose publishers are received
  /// flight      records definitions and poses (Answering records the questions); null: none
  /// peers       rights by key; null: no keys
  /// place       where this server receives questions, and whether it answers; if not, questions are dropped unless
  ///             Answering holds them
  Listeners(const dds::Participant& participant, const std::string& name_space, const WorldClock& clock, Inbox& inbox,
            Answering& answering, FlightRecorder* flight, KeyedPeers* peers, const Place& place);

  /// Possible owners of the live clients' numbers: the query writers that are matched now, or with keys their
  /// participants. One thread.
  std::vector<std::uint64_t> query_owners();

  /// Takes the definitions that were left with DDS because the inbox was full. Call this regularly, from one thread.
  void take_left_definitions();
  /// Drops publishers whose writers left unnoticed. Called together with take_left_definitions().
  void drop_unmatched_writers();
  PublisherOwners& owners() { return owners_; }

 private:
  void take_definitions(const dds::Taker<wire::Definition>& taker);
  std::string why_not_allowed(const wire::Definition& definition, std::uint64_t writer);
  NumberOwner owner_of(Participants& known, dds_entity_t reader, std::uint64_t writer) const;
  void take_poses(const dds::Taker<wire::PoseBatch>& taker);

  const WorldClock& clock_;
  Inbox& inbox_;
  FlightRecorder* const flight_;
  KeyedPeers* const peers_;
  Participants definers_;       // under taking_definitions_
  Participants posers_;         // under taking_poses_
  Participants query_writers_;  // of query_owners()
  PublisherOwners owners_;
  PublisherLiveliness object_writers_;
  PublisherLiveliness pose_writers_;
  std::mutex taking_definitions_;  // DDS's callback and take_left_definitions() may run at once
  std::mutex taking_poses_;        // DDS's callback and the constructor
  std::atomic<bool> has_readers_{false};
  std::atomic<bool> definitions_left_{false};
  dds::Topic<wire::Definition> object_topic_;
  dds::Topic<wire::PoseBatch> pose_topic_;
  dds::Topic<wire::Query> query_topic_;
  dds::Reader<wire::Definition> object_reader_;
  dds::Reader<wire::PoseBatch> pose_reader_;
  dds::Reader<wire::Query> query_reader_;
};

}  // namespace collided::engine::service
