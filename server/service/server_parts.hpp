#pragma once

#include <spdlog/fwd.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>

#include "idl/dds.hpp"
#include "idl/presence.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/durability/durable_state.hpp"
#include "server/service/durability/epoch.hpp"
#include "server/service/events/dds_event_writer.hpp"
#include "server/service/events/heartbeat.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/listeners.hpp"
#include "server/service/options/options.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/recording/flight_recorder.hpp"
#include "server/service/roles/keyed_peers.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/place.hpp"
#include "server/service/server.hpp"
#include "server/service/world_loop.hpp"
#include "server/world/world.hpp"

// The parts of a Server; server.cpp makes and ends it.
namespace collided::engine::service {

/// The parts that answer questions, and their counts.
struct Questioning {
  Questioning(const World& world, const Options& options, spdlog::logger& log);

  WriteBarriers write_barriers;
  SnapshotLeases leases;
  QuestionCounts counts;
  BackgroundAudit audit;
  Overload overload;
  PartMeshes part_meshes;
  QuestionSamples samples;
};

/// All parts in the order in which they are made. They are destroyed in the reverse order, so nothing calls a part that
/// is gone.
struct Server::Parts {
  Parts(const Options& given, std::shared_ptr<spdlog::logger> logger, const MakePlace& make_place,
        std::function<void()> end);
  /// The identity under which this server answers.
  Identity answering_identity() const;
  /// Checks that no other server runs where this one must be alone, and takes the next epoch. Throws StartError.
  Epoch make_epoch();
  /// Tasks due ten times a second; called on the world's thread.
  void tick();
  /// Logs refused publishers and clients. Part of tick().
  void note_refused();
  /// Waits until the world's thread has carried out the jobs of all commands so far, at most 3 s.
  void let_jobs_end();
  /// Opens the journal next to the epoch's file, and records that this epoch has begun; null if there is no folder.
  std::unique_ptr<DurableState> keep();
  void say_unwritten() const;
  bool has_crashed() const;
  /// Starts the flight recorder; null if it is off.
  std::unique_ptr<FlightRecorder> record();
  /// Whether every publisher from before the crash lives and has sent all its definitions.
  bool has_all_back() const;
  WorldLoop::Collaborators loop_collaborators();
  CommandCollaborators command_collaborators();
  Answering::Collaborators answering_collaborators();
  /// Leaves a mark on this machine, for clients that wait for a server.
  void be_present();
  /// Stores which publishers are connected, for the case of a crash.
  void note_publishers();

  /// Values of the last tick().
  struct LastTick {
    std::uint64_t superseded = 0;   // poses
    std::uint64_t turned_away = 0;  // Answering::clients_turned_away(), at the last log line
  };

  const Options options;
  const std::shared_ptr<spdlog::logger> log;
  dds::Participant participant;
  std::unique_ptr<KeyedPeers> peers;  // null: no keys
  WorldClock clock;
  const std::unique_ptr<Place> place;
  Epoch epoch;
  const Identity identity;
  World world;
  std::unique_ptr<DurableState> durable;  // null if there is no folder for it
  Questioning questioning;
  LastTick last_tick;
  Inbox inbox;
  std::unique_ptr<FlightRecorder> flight;  // null if it is off
  Inventory inventory;                     // of the world's thread
  DdsEventWriter event_writer;
  WorldLoop loop;
  Commands commands;
  dds::Topic<wire::Reply> reply_topic;
  std::unique_ptr<Answering> answering;
  std::unique_ptr<Listeners> listeners;
  std::thread world_thread;
  std::optional<Heartbeat> heartbeat;  // while the world's thread runs
  std::optional<wire_contract::Presence> presence;
};

}  // namespace collided::engine::service
