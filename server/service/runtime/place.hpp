#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "idl/topics.hpp"

namespace collided {
struct Wing;
}

namespace collided::engine {
class World;
}

namespace collided::engine::service {

class Answering;
class CommandFamily;
class Commands;
class DdsEventWriter;
class DurableState;
class Inbox;
class Inventory;
class WorldLoop;
struct CommandAsk;
struct CommandContext;
struct Epoch;
struct Identity;

/// This server cannot serve now; another start later may succeed.
struct CannotServeNow : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The parts of the server that a place works with, from attach() to close().
struct PlaceCollaborators {
  const Identity& identity;
  Epoch& epoch;
  World& world;
  DurableState* durable;  // null: nothing is kept
  const Inventory& inventory;
  Inbox& inbox;
  DdsEventWriter& event_writer;
  WorldLoop& loop;
  Commands& commands;
  Answering& answering;
  std::function<void()> be_present;    // leaves a mark on this machine, for clients that wait for a server
  std::function<void()> let_jobs_end;  // waits until the commands so far are carried out, 3 s at most
};

/// A server's role among those of its namespace. This class is the place of a single server: it answers and publishes
/// from its start to its end. The fleet derives another one.
class Place {
 public:
  /// asked_as  namespace in which clients ask this server
  explicit Place(std::string asked_as = {}) : asked_as_(std::move(asked_as)) {}
  virtual ~Place() = default;
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

  const std::string& asked_as() const { return asked_as_; }

  // While the server starts and ends; its main thread.
  /// The role at its start.
  virtual wire_contract::MemberRole first_role() const { return wire_contract::MemberRole::primary; }
  /// Whether it follows another server at its start, and so takes over that server's state instead of its own.
  bool begins_as_follower() const { return first_role() != wire_contract::MemberRole::primary; }
  bool is_replica() const { return first_role() == wire_contract::MemberRole::replica; }
  /// Whether no other server may answer in the namespace asked_as().
  virtual bool has_to_be_alone() const { return true; }
  /// This server's epoch, at least `least`. May wait for seconds; throws CannotServeNow.
  virtual std::uint64_t draw_epoch(std::uint64_t least) { return least; }
  /// Adds the commands that only servers with such a place have.
  virtual void add_commands(CommandContext&, std::vector<std::unique_ptr<CommandFamily>>&) {}
  /// Called before the first command, pose or question arrives.
  virtual void attach(PlaceCollaborators) {}
  /// Called once the world's thread runs.
  virtual void start() {}
  /// Called before the server stops: hands over, if another server is ready.
  virtual void leave() {}
  /// Called once nothing more is written.
  virtual void close() {}

  // While the server serves; any thread.
  /// Whether questions are answered here. If not, they are dropped, since another server answers them.
  virtual bool may_answer() const { return true; }
  /// Whether this server may publish and send answers now.
  virtual bool may_publish() const { return true; }
  /// Until when it may, if known; steady clock.
  virtual std::int64_t may_publish_until_ns() const { return std::numeric_limits<std::int64_t>::max(); }
  /// World time from which on this server's states are complete. Nothing: the newest one may be incomplete, and no
  /// question is answered.
  virtual std::optional<std::int64_t> whole_since_ns() const { return std::numeric_limits<std::int64_t>::min(); }
  /// The server whose place this one has taken; 0: none.
  virtual std::uint64_t predecessor() const { return 0; }
  /// Whether another server has taken this one's place without having been asked to.
  virtual bool has_given_way() const { return false; }
  /// Called when the server is about to end. True: it was asked to hand over, but no other server has taken over.
  virtual bool goes_on() { return false; }
  /// Adds its optional parts.
  virtual void list_wings(std::vector<Wing>&) const {}

  // On the world's thread.
  /// Called ten times a second.
  ///
  /// leaves_out_poses  poses were superseded since the last call
  virtual void tick([[maybe_unused]] bool leaves_out_poses) {}
  /// Called after a command has changed the world, in the order of the changes.
  virtual void changed(const CommandAsk&) {}

 private:
  const std::string asked_as_;
};

}  // namespace collided::engine::service
