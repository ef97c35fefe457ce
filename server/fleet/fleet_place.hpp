#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <spdlog/fwd.h>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/fleet/authority/election.hpp"
#include "server/fleet/authority/serving_term.hpp"
#include "server/fleet/change_feed.hpp"
#include "server/fleet/fleet_options.hpp"
#include "server/fleet/handover_words.hpp"
#include "server/fleet/membership.hpp"
#include "server/fleet/replica_readiness.hpp"
#include "server/fleet/served_followers.hpp"
#include "server/fleet/standby.hpp"
#include "server/fleet/succession.hpp"
#include "server/service/runtime/clock.hpp"
#include "server/service/runtime/place.hpp"

namespace collided::engine::service {

/// A server among others of its namespace: what it reports of itself, and how it takes and gives up the primary's place.
class FleetPlace : public Place {
 public:
  /// participant and clock must outlive this.
  /// end  has stop() called soon, once another server has taken this one's place; called on any thread, returns at once
  FleetPlace(const FleetOptions& fleet, const Options& options, const dds::Participant& participant,
             const WorldClock& clock, std::shared_ptr<spdlog::logger> log, std::function<void()> end);

  wire_contract::MemberRole first_role() const override { return first_role_; }
  bool has_to_be_alone() const override;
  std::uint64_t draw_epoch(std::uint64_t least) override;
  void add_commands(CommandContext& context, std::vector<std::unique_ptr<CommandFamily>>& families) override;
  void attach(PlaceCollaborators with) override;
  void start() override;
  void leave() override;
  void close() override;

  bool may_answer() const override { return takes_questions_.load() && may_publish(); }
  bool may_publish() const override { return !term_.is_over(); }
  std::int64_t may_publish_until_ns() const override { return term_.until_ns(); }
  std::optional<std::int64_t> whole_since_ns() const override;
  std::uint64_t predecessor() const override { return succession_ ? succession_->predecessor() : 0; }
  bool has_given_way() const override { return succession_ && succession_->has_given_way(); }
  bool goes_on() override;
  void list_wings(std::vector<Wing>& wings) const override;

  void tick(bool leaves_out_poses) override;
  void changed(const CommandAsk& ask) override;

 private:
  /// A writer of the namespace's status that writes nothing. Clients learn of it by DDS's own discovery, and then look
  /// for replicas: those of a server alone pay nothing for it.
  struct ReplicaSign {
    ReplicaSign(const dds::Participant& participant, const std::string& name_space)
        : topic(participant, name_space), writer(topic) {}
    dds::Topic<wire::Status> topic;
    dds::Writer<wire::Status> writer;
  };

  void warn(const std::string& sentence) const;
  Succession::Collaborators succession_collaborators();
  SelfDescription describe_self();
  std::string alarm() const;
  wire_contract::ServerState own_state() const;
  Following following() const;
  /// Makes what a standby needs.
  void stand_by();
  /// This server has a standby's part now.
  bool is_following() const { return standby_ && succession_->role() != wire_contract::MemberRole::primary; }
  /// An authority has given the primary's place to this server, which has not taken it yet.
  bool is_given_place() const;
  void cannot_follow();
  std::string carry_out(const WorldChange& change);
  /// The present epoch; see Standby::epoch().
  std::uint64_t epoch_now() const;
  /// See Standby::PlaceCollaborators.
  Standby::RaisedEpoch raise_epoch(std::uint64_t least);
  /// Makes this server the primary, if it may be; of a standby.
  bool take_over(const Standby::Predecessor& of, const std::string& why);
  /// The primary hands over to this server. Returns why it does not take the place; empty: it has.
  std::string take_place(const HandoverWords& words);
  /// Whether what those of the publishers that live have sent is in the world up to there.
  bool has_come_as_far(const PublisherProgress& progress) const;
  /// Has a standby take this server's place, where one is ready. False: none has, and this server goes on.
  ///
  /// name  of the standby; empty: any
  bool hand_over(const std::string& name);
  /// The name of the server that will take this one's place when it ends, which is soon then. Throws BadCommand.
  std::string hand_over_to(const std::string& name);
  /// Sends all that is kept to a server that follows, in its place among the changes.
  void send_all(std::uint64_t follower, std::uint64_t fetch);

  const FleetOptions fleet_;
  const Options options_;
  const dds::Participant& participant_;
  const WorldClock& clock_;
  const std::shared_ptr<spdlog::logger> log_;
  const std::function<void()> end_;
  ServingTerm term_;
  const std::unique_ptr<Election> election_;  // null: no authority
  const wire_contract::MemberRole first_role_;
  std::atomic<bool> takes_questions_;
  std::unique_ptr<ReplicaReadiness> readiness_;  // null: it is no replica
  // From attach() on.
  std::optional<PlaceCollaborators> with_;
  std::unique_ptr<ReplicaSign> sign_;  // null: it is no replica
  std::unique_ptr<ChangeFeed> feed_;   // null: no server can follow
  std::unique_ptr<Succession> succession_;
  std::unique_ptr<ServedFollowers> followers_;  // of a primary
  std::unique_ptr<Standby> standby_;            // null: it began as a primary
  std::unique_ptr<Membership> membership_;
};

}  // namespace collided::engine::service
