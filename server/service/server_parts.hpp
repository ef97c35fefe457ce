#pragma once

#include <spdlog/fwd.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "idl/dds.hpp"
#include "idl/presence.hpp"
#include "server/service/authority/election.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/durability/durable_state.hpp"
#include "server/service/durability/epoch.hpp"
#include "server/service/events/dds_event_writer.hpp"
#include "server/service/events/heartbeat.hpp"
#include "server/service/fleet/change_feed.hpp"
#include "server/service/fleet/handover_words.hpp"
#include "server/service/fleet/membership.hpp"
#include "server/service/fleet/served_followers.hpp"
#include "server/service/fleet/standby.hpp"
#include "server/service/fleet/succession.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/listeners.hpp"
#include "server/service/options/options.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/questions/replica_readiness.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/roles/keyed_peers.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/serving_term.hpp"
#include "server/service/server.hpp"
#include "server/service/world_loop.hpp"
#include "server/world/world.hpp"

// What a Server is made of: server.cpp makes and ends it, server_fleet.cpp has what concerns other servers of the namespace.
namespace collided::engine::service {

/// Where a server is asked, and says how it is: a replica in a namespace of its own.
std::string asked_as(const Options& options);

/// A writer of the namespace's status that writes nothing. Clients learn of it by DDS's own discovery, and then look for
/// replicas: those of a server alone pay nothing for it.
struct ReplicaSign {
  ReplicaSign(const dds::Participant& participant, const std::string& name_space)
      : topic(participant, name_space), writer(topic) {}
  dds::Topic<wire::Status> topic;
  dds::Writer<wire::Status> writer;
};

/// All parts in the order in which they are made. They are destroyed in the reverse order, so nothing calls a part that
/// is gone.
struct Server::Parts {
  Parts(const Options& given, std::shared_ptr<spdlog::logger> logger, std::function<void()> end);
  /// Whether it began as one. So does a replica, which never takes the place.
  bool is_standby() const { return began_as_standby; }
  bool is_replica() const { return !options.replica_of.empty(); }
  /// What this server is where it answers.
  Identity answering_identity() const;
  /// Checks that no other server is there, unless this one stands by, and takes the next epoch. Throws StartError.
  Epoch make_epoch();
  /// What is due ten times a second; called on the world's thread.
  void tick();
  /// Logs publishers and clients that are not taken. Part of tick().
  void note_refused();
  void let_jobs_end();
  /// Opens the journal beside the epoch's file, and writes down that this epoch has begun; null where there is no folder.
  std::unique_ptr<DurableState> keep();
  void say_unwritten() const;
  bool has_crashed() const;
  /// Starts the flight recorder; null where it is off.
  std::unique_ptr<FlightRecorder> record();
  /// Whether every publisher from before the crash lives and has sent all its definitions.
  bool has_all_back() const;
  /// What this server says of itself to the others of its namespace.
  SelfDescription describe_self();
  /// Leaves a mark on this machine, for clients that wait for a server.
  void be_present();
  /// Makes what a standby needs.
  void stand_by();
  /// Whether what those of the publishers that live have sent is in the world up to there.
  bool has_come_as_far(const PublisherProgress& progress) const;
  /// An authority has given the primary's place to this server, which has not taken it yet.
  bool is_given_place() const;
  /// Of now: see Standby::epoch().
  std::uint64_t epoch_now() const { return standby ? standby->epoch() : identity.epoch; }
  /// See Standby::PlaceCollaborators.
  Standby::RaisedEpoch raise_epoch(std::uint64_t least);
  /// Makes this server the primary, if it may be; of a standby.
  bool take_over(const Standby::Predecessor& of, const std::string& why);
  /// The primary hands over to this server. Returns why it does not take the place; empty: it has.
  std::string take_place(const HandoverWords& words);
  /// Has a standby take this server's place, where one is ready. False: none has, and this server goes on.
  /// name  of the standby; empty: any
  bool hand_over(const std::string& name);
  /// The name of the server that will take this one's place when it ends, which is soon then. Throws BadCommand.
  std::string hand_over_to(const std::string& name);
  /// Sends all that is kept to a server that follows, in its place among the changes.
  void send_all(std::uint64_t follower, std::uint64_t fetch);
  /// Keeps which publishers are there, for the case of a crash.
  void note_publishers();

  const Options options;
  const std::shared_ptr<spdlog::logger> log;
  dds::Participant participant;
  std::unique_ptr<KeyedPeers> peers;  // null: no keys
  ServingTerm term;
  const std::unique_ptr<Election> election;  // null: no authority
  const bool began_as_standby;
  Epoch epoch;
  const Identity identity;
  WorldClock clock;
  World world;
  std::unique_ptr<DurableState> durable;  // null where there is no folder for it
  WriteBarriers write_barriers;
  SnapshotLeases leases;
  QuestionCounts questions;
  BackgroundAudit audit;
  Overload overload;
  std::uint64_t superseded = 0;   // poses, as of the last tick()
  std::uint64_t turned_away = 0;  // Answering::clients_turned_away(), as last logged
  Inbox inbox;
  std::unique_ptr<FlightRecorder> flight;  // null where it is off
  DdsEventWriter event_writer;
  std::atomic<bool> takes_questions;
  std::unique_ptr<ReplicaReadiness> readiness;  // null: it is no replica
  std::unique_ptr<ReplicaSign> sign;            // likewise
  std::unique_ptr<ChangeFeed> feed;             // null: nobody can follow
  WorldLoop loop;
  PartMeshes part_meshes;
  QuestionSamples samples;
  Commands commands;
  dds::Topic<wire::Reply> reply_topic;
  std::unique_ptr<Answering> answering;
  std::unique_ptr<Listeners> listeners;
  std::thread world_thread;
  std::optional<Heartbeat> heartbeat;  // while the world's thread runs
  std::optional<wire_contract::Presence> presence;
  Succession succession;
  ServedFollowers followers;         // of a primary
  std::unique_ptr<Standby> standby;  // null: it began as a primary
  std::unique_ptr<Membership> membership;
};

}  // namespace collided::engine::service
