#include "server/fleet/fleet_place.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <collided/commands.hpp>
#include <future>
#include <string>
#include <thread>
#include <utility>
#include <spdlog/logger.h>

#include "idl/etcd/etcd_client.hpp"
#include "idl/topics.hpp"
#include "server/fleet/shards/shard_commands.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/service/commands/commands.hpp"
#include "server/service/durability/epoch.hpp"
#include "server/service/first_look.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::MemberRole;
using wire_contract::ServerState;

std::string namespace_asked(const FleetOptions& fleet, const Options& options) {
  return fleet.replica_of.empty() ? options.name_space
                                  : wire_contract::replica_namespace(options.name_space, member_name(fleet.member));
}

/// The greatest epoch of the servers of the namespace, those that stand by among them; 0: there is none.
std::uint64_t greatest_epoch(const dds::Participant& participant, const std::string& name_space, bool uses_keys) {
  std::uint64_t greatest = 0;
  hear_servers<wire::Member>(participant, name_space, listening_ns(uses_keys), [&](const wire::Member& member) {
    greatest = std::max<std::uint64_t>(greatest, member.epoch);
    return false;
  });
  return greatest;
}

bool is_there_a_primary(const FleetOptions& fleet, const dds::Participant& participant, const Options& options) {
  // One that stands by may be about to take the place of the one that this server was.
  constexpr std::int64_t kLongNs = 1'000'000'000;
  return heard_primary(participant, options.name_space, !options.keys.empty(),
                       std::max(kLongNs, 2 * fleet.take_over_ns))
      .has_value();
}

MemberRole role_at_start(const FleetOptions& fleet, const dds::Participant& participant, const Options& options) {
  if (!fleet.replica_of.empty()) return MemberRole::replica;
  const bool follows = !fleet.standby_of.empty() || (fleet.joins && is_there_a_primary(fleet, participant, options));
  return follows ? MemberRole::standby : MemberRole::primary;
}

/// Null without an authority.
std::unique_ptr<Election> make_election(const FleetOptions& fleet, const Options& options, ServingTerm& term,
                                        const Election::Notice& notice) {
  if (!fleet.authority || !fleet.replica_of.empty()) return nullptr;  // a replica never is the primary
  const etcd::EtcdAddress& address = *fleet.authority;
  const std::string prefix =
      fmt::format("{}/{}/{}", address.key.empty() ? "collided" : address.key, options.domain, options.name_space);
  // All members may be asked, and asked again, before the term of a confirmation is over.
  const std::int64_t third_ns = std::int64_t{fleet.authority_lease_s} * 1'000'000'000 / 3;
  constexpr std::int64_t kLeastPatienceNs = 50'000'000;
  const std::int64_t patience_ns =
      std::max(kLeastPatienceNs, third_ns / 2 / static_cast<std::int64_t>(address.endpoints.size()));
  return std::make_unique<Election>(
      std::make_unique<etcd::EtcdClient>(address, patience_ns),
      ElectionOptions{
          .store = "etcd",
          .prefix = prefix,
          .life_s = fleet.authority_lease_s,
          .description = fleet.member.empty() ? fmt::format("pid {}", getpid()) : fmt::format("'{}'", fleet.member),
          .mode = fleet.authority_mode},
      term, notice);
}

/// Without an authority, or in its fast mode, a standby waits for --take-over-after alone, 0.2 s if nobody has said
/// otherwise to it. In strict mode it waits first for the end of the lease, which etcd may keep a second longer.
std::int64_t replaced_within_ns(const FleetOptions& fleet) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const bool waits_for_lease = fleet.authority && fleet.authority_mode == TakeOverMode::strict;
  return waits_for_lease ? (fleet.authority_lease_s + 2) * kSecondNs : kSecondNs;
}

}  // namespace

FleetPlace::FleetPlace(const FleetOptions& fleet, const Options& options, const dds::Participant& participant,
                       const WorldClock& clock, std::shared_ptr<spdlog::logger> log, std::function<void()> end)
    : Place(namespace_asked(fleet, options)),
      fleet_(fleet),
      options_(options),
      participant_(participant),
      clock_(clock),
      log_(std::move(log)),
      end_(std::move(end)),
      election_(make_election(fleet, options, term_, [this](const std::string& sentence) { warn(sentence); })),
      first_role_(role_at_start(fleet, participant, options)),
      takes_questions_(first_role_ != MemberRole::standby),
      readiness_(is_replica() ? std::make_unique<ReplicaReadiness>(clock) : nullptr) {}

void FleetPlace::warn(const std::string& sentence) const { log_->warn("{}", sentence); }

bool FleetPlace::has_to_be_alone() const { return is_replica() || (!begins_as_follower() && !fleet_.joins); }

std::uint64_t FleetPlace::draw_epoch(std::uint64_t least) {
  // A server that takes the primary's place has a greater one.
  if (begins_as_follower())
    least = std::max(least, greatest_epoch(participant_, options_.name_space, !options_.keys.empty()) + 1);
  if (!election_) return least;
  const std::uint64_t drawn = election_->begin(least);
  if (!begins_as_follower()) election_->win();
  return drawn;
}

void FleetPlace::add_commands(CommandContext& context, std::vector<std::unique_ptr<CommandFamily>>& families) {
  families.push_back(
      shard_commands(context, {.shard_map = fleet_.shard_map,
                               .replaced_within_ns = replaced_within_ns(fleet_),
                               .hand_over = [this](const std::string& name) { return hand_over_to(name); }}));
}

void FleetPlace::attach(PlaceCollaborators with) {
  with_.emplace(std::move(with));
  const Identity& identity = with_->identity;
  if (is_replica()) sign_ = std::make_unique<ReplicaSign>(participant_, options_.name_space);
  else if (with_->durable != nullptr)
    feed_ = std::make_unique<ChangeFeed>(participant_, identity.server, identity.name_space);
  succession_ = std::make_unique<Succession>(succession_collaborators(), first_role_);
  followers_ = std::make_unique<ServedFollowers>(
      identity.server,
      ServedFollowers::Collaborators{
          .send_all = [this](std::uint64_t follower, std::uint64_t fetch) { send_all(follower, fetch); },
          .ask_again = [this] { with_->loop.ask_publishers_again(); }});
  if (first_role_ == MemberRole::standby) with_->event_writer.fall_silent();
}

Succession::Collaborators FleetPlace::succession_collaborators() {
  return {.on_world_thread = [this](std::function<void()> job) { with_->inbox.push_own_job(std::move(job)); },
          .speak = [this](const SpokenBefore& before) { with_->loop.speak(before); },
          .fall_silent = [this] { with_->loop.fall_silent(); },
          .say_last_words = [this] { return with_->loop.say_last_words(); },
          .has_come_as_far = [this](const PublisherProgress& far) { return has_come_as_far(far); },
          .lend_place =
              [this] {
                if (election_) election_->lend();
              },
          .take_place_back = [this] { return !election_ || election_->take_back(); },
          .answer_held_questions = [this] { with_->answering.go_on(); },
          .takes_questions = takes_questions_,
          .self = with_->identity.server,
          .epoch = [this] { return epoch_now(); },
          .joins = fleet_.joins || is_replica(),
          .notice = [this](const std::string& sentence) { warn(sentence); },
          .became_primary =
              [this] {
                with_->be_present();
                membership_->say_now();
              },
          .end = end_};
}

void FleetPlace::start() {
  if (begins_as_follower()) stand_by();
  membership_ = std::make_unique<Membership>(participant_, with_->identity, describe_self(), with_->world, clock_,
                                             [this](const std::string& sentence) { warn(sentence); });
  if (election_) election_->connect([this](const std::string& why) { succession_->lose_place(why); });
}

void FleetPlace::leave() {
  if (membership_) {
    static_cast<void>(hand_over(""));
    // It calls the standby, which takes no place any more.
    membership_->leave();
  }
  if (standby_) standby_->leave();
}

/// The next primary may have the place once this server writes nothing more.
void FleetPlace::close() {
  if (election_) election_->close();
  // They hold states of the world, which ends before this object does.
  membership_.reset();
  standby_.reset();
}

std::optional<std::int64_t> FleetPlace::whole_since_ns() const {
  if (!readiness_) return Place::whole_since_ns();
  return readiness_->is_open() ? std::optional(readiness_->whole_since_ns()) : std::nullopt;
}

bool FleetPlace::goes_on() {
  const std::string chosen = succession_->take_choice();
  return !chosen.empty() && !hand_over(chosen);
}

void FleetPlace::list_wings(std::vector<Wing>& wings) const {
  const bool is_member = begins_as_follower() || fleet_.joins || options_.shard || has_given_way() ||
                         predecessor() != 0 || (feed_ && feed_->is_followed());
  wings.push_back({.name = "fleet", .in_use = is_member});
  wings.push_back({.name = "authority", .in_use = election_ != nullptr});
}

void FleetPlace::tick(bool leaves_out_poses) {
  if (const std::int64_t lapsed_ns = with_->event_writer.lapsed_ns(); lapsed_ns != 0 && may_publish())
    with_->loop.speak({.heard_ns = lapsed_ns});
  if (!readiness_) return;
  readiness_->note_turn();
  // Between the poses that are left the movers went another way than in the primary's world.
  if (leaves_out_poses) readiness_->doubt();
}

void FleetPlace::changed(const CommandAsk& ask) {
  const bool is_told = feed_ && succession_->role() == MemberRole::primary;
  if (!is_told || !feed_->is_followed()) return;
  // In the order of the journal, in which all that is kept has its place too.
  with_->durable->then([this, change = WorldChange{ask.text, ask.blob}](const std::string&) { feed_->tell(change); });
}

SelfDescription FleetPlace::describe_self() {
  return {.role = [this] { return succession_->role(); },
          .epoch = [this] { return epoch_now(); },
          .name = member_name(fleet_.member),
          .state = [this] { return own_state(); },
          .alarm = [this] { return alarm(); },
          .settled_ns = [this] { return with_->loop.settled_lately_ns(); },
          .following = [this] { return following(); },
          .heard =
              [this](const OtherMember& other) {
                if (is_following()) return standby_->hear(other);
                succession_->hear(other);
                followers_->hear(other);
              },
          .gone = [this](std::uint64_t server) { succession_->forget(server); },
          .digested =
              [this](const DigestMaker& made) {
                if (is_following()) standby_->note_own(made.newest(), made.state());
              }};
}

std::string FleetPlace::alarm() const {
  const std::string lacks = is_following() ? standby_->alarm() : std::string();
  std::string lines;
  for (const std::string& line : {election_ ? election_->problem() : std::string(), lacks,
                                  with_->durable != nullptr ? with_->durable->problem() : std::string()})
    lines += (lines.empty() || line.empty() ? "" : "\n") + line;
  return lines;
}

ServerState FleetPlace::own_state() const {
  const bool is_open = is_replica() && standby_ && standby_->state() == ServerState::ready;
  if (is_following() && !is_open) return standby_->state();
  return may_publish() ? with_->loop.state() : ServerState::recovering;
}

Following FleetPlace::following() const {
  if (is_following()) return standby_->following();
  const std::uint64_t predecessor = succession_->predecessor();
  return {.primary = predecessor, .fetch = predecessor == 0 ? 0 : standby_->carried_out() + 1};
}

void FleetPlace::stand_by() {
  standby_ = std::make_unique<Standby>(
      participant_, with_->identity,
      ChangeFollower::Collaborators{.carry_out = [this](const WorldChange& change) { return carry_out(change); },
                                    .notice = [this](const std::string& sentence) { warn(sentence); }},
      Standby::PlaceRules{.silent_after_ns = is_replica() ? 0 : fleet_.take_over_ns, .is_replica = is_replica()},
      Standby::PlaceCollaborators{
          .take_over = [this](const Standby::Predecessor& of, const std::string& why) { return take_over(of, why); },
          .has_place = [this] { return is_given_place(); },
          .raise_epoch = [this](std::uint64_t least) { return raise_epoch(least); },
          .cannot_follow = [this] { cannot_follow(); }});
  if (readiness_)
    standby_->on_compared(
        [this](std::int64_t instant_ns, bool is_same) { readiness_->note_compared(instant_ns, is_same); });
}

std::string FleetPlace::carry_out(const WorldChange& change) {
  const std::optional<HandoverWords> words = read_handover(change.text);
  if (words) return words->to == with_->identity.server ? take_place(*words) : std::string();
  return with_->commands.follow({0, 0, change.text, change.blob});
}

void FleetPlace::cannot_follow() {
  if (!is_given_place()) return succession_->cannot_follow();
  succession_->lose_place("this server was given the place, and gives it up: it ends, for another one to start");
}

std::uint64_t FleetPlace::epoch_now() const { return standby_ ? standby_->epoch() : with_->identity.epoch; }

bool FleetPlace::has_come_as_far(const PublisherProgress& progress) const {
  return std::ranges::all_of(progress, [&](const auto& entry) {
    const auto& [publisher, sequence] = entry;
    return !with_->loop.publishers().is_live(publisher) ||
           with_->loop.publishers().applied_through(publisher) >= sequence;
  });
}

bool FleetPlace::is_given_place() const {
  return election_ && election_->has_place() && succession_->role() == wire_contract::MemberRole::standby;
}

/// While it stands by it has told others only what it is: all else that it says comes with the primary's place.
Standby::RaisedEpoch FleetPlace::raise_epoch(std::uint64_t least) {
  std::uint64_t value = std::max(least, least_epoch_now());
  if (election_) {
    const std::optional<std::uint64_t> drawn = election_->draw_again(value);
    if (!drawn) return {.problem = election_->problem()};
    value = *drawn;
  }
  if (std::string problem = service::raise_epoch(with_->epoch, value); !problem.empty()) return {.problem = problem};
  const auto done = std::make_shared<std::promise<void>>();
  with_->inbox.push_own_job([this, value, done] {
    with_->world.set_epoch(value);
    with_->event_writer.set_epoch(value);
    with_->answering.set_epoch(value);
    // A state with the epoch of before must not be the newest when this server begins to answer.
    with_->loop.step_now();
    done->set_value();
  });
  constexpr std::chrono::seconds kPatience{3};
  if (done->get_future().wait_for(kPatience) != std::future_status::ready) return {.problem = "it has too much to do"};
  return {.value = value, .problem = {}};
}

bool FleetPlace::take_over(const Standby::Predecessor& of, const std::string& why) {
  if (election_ && !election_->succeeds(of.epoch)) return false;
  if (feed_) feed_->continue_from(standby_->carried_out());
  if (!succession_->take_over(of.server, of.spoken, why)) return false;
  if (!of.is_same) {
    log_->warn(
        "this server's world was not the other one's: publishers are asked to say all again, and what moved since "
        "the two heard each other last may have begun and ended no contact");
    with_->loop.ask_publishers_again();
  }
  if (election_ && election_->mode() == TakeOverMode::fast)
    log_->warn("the one before may publish and answer until it next asks etcd, for {:.1f} s at most",
               fleet_.authority_lease_s / 3.0);
  return true;
}

std::string FleetPlace::take_place(const HandoverWords& words) {
  succession_->catch_up(words.progress);
  // Clients take another server's word once they have heard that the primary stops, which comes to them another way than this
  // to here: they are given what they have where a primary dies.
  std::this_thread::sleep_for(std::chrono::nanoseconds(wire_contract::kTakeOverNs - wire_contract::kMayHaveHeirNs));
  // An authority needs a moment to give the place.
  constexpr std::int64_t kPatienceNs = 1'500'000'000;
  const std::int64_t until_ns = steady_ns() + (election_ ? kPatienceNs : 0);
  for (;;) {
    if (standby_->take_place("the primary hands over")) return {};
    if (steady_ns() >= until_ns) return "it hands over, and this server does not hold all that it had";
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

std::string FleetPlace::hand_over_to(const std::string& name) {
  const std::optional<Succession::Heir> to = feed_ ? succession_->heir(name) : std::nullopt;
  if (!to)
    throw BadCommand(name.empty() ? std::string("no server stands by that is ready. Nothing was done")
                                  : fmt::format("'{}' does not stand by, or is not ready. Nothing was done", name),
                     "collide fleet shows who is there, and what is wrong");
  succession_->choose(to->name);
  return to->name;
}

void FleetPlace::send_all(std::uint64_t follower, std::uint64_t fetch) {
  if (!feed_) return log_->warn("a standby cannot follow: this server keeps nothing, since it has no state folder");
  // On the world's thread, so that no command is half done.
  const bool taken = with_->inbox.push_job([this, follower, fetch] {
    std::vector<WorldChange> kept;
    for (KeptCommand& command : with_->durable->followed(with_->inventory))
      kept.push_back({std::move(command.text), std::move(command.blob)});
    // In the order of the journal, as the changes.
    with_->durable->then([this, follower, fetch, kept = std::move(kept)](const std::string&) {
      feed_->tell_all(follower, fetch, kept);
    });
  });
  if (!taken) log_->warn("too many commands wait already: a standby must ask again for what is kept");
}

bool FleetPlace::hand_over(const std::string& name) {
  const std::optional<Succession::Heir> to = feed_ ? succession_->heir(name) : std::nullopt;
  if (!to) return false;
  with_->answering.hold();
  // What was carried out so far has its place before the handing over.
  with_->let_jobs_end();
  if (with_->durable) with_->durable->wait(std::chrono::seconds(1));
  return succession_->hand_over(*feed_, *to);
}

}  // namespace collided::engine::service
