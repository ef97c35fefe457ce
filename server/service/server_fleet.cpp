#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>
#include <spdlog/logger.h>

#include "idl/topics.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/service/server_parts.hpp"

// A server among others of its namespace: what it says of itself, and how it takes and gives up the primary's place.
namespace collided::engine::service {

std::string asked_as(const Options& options) {
  return options.replica_of.empty() ? options.name_space
                                    : wire_contract::replica_namespace(options.name_space, member_name(options.member));
}

SelfDescription Server::Parts::describe_self() {
  using wire_contract::MemberRole;
  using wire_contract::ServerState;
  const auto is_following = [this] { return standby && succession.role() != MemberRole::primary; };
  const auto alarm = [this, is_following] {
    const std::string lacks = is_following() ? standby->alarm() : std::string();
    std::string lines;
    for (const std::string& line :
         {election ? election->problem() : std::string(), lacks, durable ? durable->problem() : std::string()})
      lines += (lines.empty() || line.empty() ? "" : "\n") + line;
    return lines;
  };
  return {.role = [this] { return succession.role(); },
          .epoch = [this] { return epoch_now(); },
          .name = member_name(options.member),
          .state =
              [this, is_following] {
                const bool is_open = is_replica() && standby && standby->state() == ServerState::ready;
                if (is_following() && !is_open) return standby->state();
                return term.is_over() ? ServerState::recovering : loop.state();
              },
          .alarm = alarm,
          .settled_ns = [this] { return loop.settled_lately_ns(); },
          .following =
              [this, is_following] {
                if (is_following()) return standby->following();
                const std::uint64_t predecessor = succession.predecessor();
                return Following{.primary = predecessor, .fetch = predecessor == 0 ? 0 : standby->carried_out() + 1};
              },
          .heard =
              [this, is_following](const OtherMember& other) {
                if (is_following()) return standby->hear(other);
                succession.hear(other);
                followers.hear(other);
              },
          .gone = [this](std::uint64_t server) { succession.forget(server); },
          .digested =
              [this, is_following](const DigestMaker& made) {
                if (is_following()) standby->note_own(made.newest(), made.state());
              }};
}

void Server::Parts::be_present() {
  const bool is_heard = options.keys.empty() && !participant.configured_by_environment();
  presence.emplace(options.domain, asked_as(options), is_heard ? options.interface : std::string());
}

void Server::Parts::stand_by() {
  standby = std::make_unique<Standby>(
      participant, identity,
      ChangeFollower::Collaborators{.carry_out =
                                        [this](const WorldChange& change) {
                                          const std::optional<HandoverWords> words = read_handover(change.text);
                                          if (words)
                                            return words->to == identity.server ? take_place(*words) : std::string();
                                          return commands.follow({0, 0, change.text, change.blob});
                                        },
                                    .notice = [this](const std::string& sentence) { log->warn("{}", sentence); }},
      Standby::PlaceRules{.silent_after_ns = is_replica() ? 0 : options.take_over_ns, .is_replica = is_replica()},
      Standby::PlaceCollaborators{
          .take_over = [this](const Standby::Predecessor& of, const std::string& why) { return take_over(of, why); },
          .has_place = [this] { return is_given_place(); },
          .raise_epoch = [this](std::uint64_t least) { return raise_epoch(least); },
          .cannot_follow =
              [this] {
                if (is_given_place())
                  succession.lose_place(
                      "this server was given the place, and gives it up: it ends, for another one to start");
                else succession.cannot_follow();
              }});
  if (readiness)
    standby->on_compared(
        [this](std::int64_t instant_ns, bool is_same) { readiness->note_compared(instant_ns, is_same); });
}

bool Server::Parts::has_come_as_far(const PublisherProgress& progress) const {
  return std::ranges::all_of(progress, [&](const auto& entry) {
    const auto& [publisher, sequence] = entry;
    return !loop.publishers().is_live(publisher) || loop.publishers().applied_through(publisher) >= sequence;
  });
}

bool Server::Parts::is_given_place() const {
  return election && election->has_place() && succession.role() == wire_contract::MemberRole::standby;
}

/// While it stands by it has told others only what it is: all else that it says comes with the primary's place.
Standby::RaisedEpoch Server::Parts::raise_epoch(std::uint64_t least) {
  std::uint64_t value = std::max(least, least_epoch_now());
  if (election) {
    const std::optional<std::uint64_t> drawn = election->draw_again(value);
    if (!drawn) return {.problem = election->problem()};
    value = *drawn;
  }
  if (std::string problem = service::raise_epoch(epoch, value); !problem.empty()) return {.problem = problem};
  const auto done = std::make_shared<std::promise<void>>();
  inbox.push_own_job([this, value, done] {
    world.set_epoch(value);
    event_writer.set_epoch(value);
    answering->set_epoch(value);
    // A state with the epoch of before must not be the newest when this server begins to answer.
    loop.step_now();
    done->set_value();
  });
  constexpr std::chrono::seconds kPatience{3};
  if (done->get_future().wait_for(kPatience) != std::future_status::ready) return {.problem = "it has too much to do"};
  return {.value = value, .problem = {}};
}

bool Server::Parts::take_over(const Standby::Predecessor& of, const std::string& why) {
  if (election && !election->succeeds(of.epoch)) return false;
  if (feed) feed->continue_from(standby->carried_out());
  if (!succession.take_over(of.server, of.spoken, why)) return false;
  if (!of.is_same) {
    log->warn(
        "this server's world was not the other one's: publishers are asked to say all again, and what moved since "
        "the two heard each other last may have begun and ended no contact");
    loop.ask_publishers_again();
  }
  if (election && election->mode() == TakeOverMode::fast)
    log->warn("the one before may publish and answer until it next asks etcd, for {:.1f} s at most",
              options.authority_lease_s / 3.0);
  return true;
}

std::string Server::Parts::take_place(const HandoverWords& words) {
  succession.catch_up(words.progress);
  // Clients take another server's word once they have heard that the primary stops, which comes to them another way than this
  // to here: they are given what they have where a primary dies.
  std::this_thread::sleep_for(std::chrono::nanoseconds(wire_contract::kTakeOverNs - wire_contract::kMayHaveHeirNs));
  // An authority needs a moment to give the place.
  constexpr std::int64_t kPatienceNs = 1'500'000'000;
  const std::int64_t until_ns = steady_ns() + (election ? kPatienceNs : 0);
  for (;;) {
    if (standby->take_place("the primary hands over")) return {};
    if (steady_ns() >= until_ns) return "it hands over, and this server does not hold all that it had";
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

std::string Server::Parts::hand_over_to(const std::string& name) {
  const std::optional<Succession::Heir> to = feed ? succession.heir(name) : std::nullopt;
  if (!to)
    throw BadCommand(name.empty() ? std::string("no server stands by that is ready. Nothing was done")
                                  : fmt::format("'{}' does not stand by, or is not ready. Nothing was done", name),
                     "collide fleet shows who is there, and what is wrong");
  succession.choose(to->name);
  return to->name;
}

void Server::Parts::send_all(std::uint64_t follower, std::uint64_t fetch) {
  if (!feed) return log->warn("a standby cannot follow: this server keeps nothing, since it has no state folder");
  // On the world's thread, so that no command is half done.
  const bool taken = inbox.push_job([this, follower, fetch] {
    durable->list_kept([this, follower, fetch](const std::vector<CommandAsk>& kept) {
      std::vector<WorldChange> changes;
      for (const CommandAsk& ask : kept) changes.push_back({ask.text, ask.blob});
      feed->tell_all(follower, fetch, std::move(changes));
    });
  });
  if (!taken) log->warn("too many commands wait already: a standby must ask again for what is kept");
}

bool Server::Parts::hand_over(const std::string& name) {
  const std::optional<Succession::Heir> to = feed ? succession.heir(name) : std::nullopt;
  if (!to) return false;
  takes_questions.store(false);
  // What was carried out so far has its place before the handing over.
  let_jobs_end();
  if (durable) durable->wait(std::chrono::seconds(1));
  return succession.hand_over(*feed, *to);
}

}  // namespace collided::engine::service
