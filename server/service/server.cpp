#include "server/service/server.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <future>
#include <optional>
#include <set>
#include <utility>
#include <spdlog/logger.h>

#include "idl/clocks.hpp"
#include "idl/etcd/etcd_client.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/service/fleet/first_look.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/random_number.hpp"
#include "server/service/self_test.hpp"
#include "server/service/server_parts.hpp"
#include "server/service/start_scenes.hpp"

namespace collided::engine::service {
namespace {

/// How long a server waits after a crash for those that were there: publishers and clients look for servers every 2 s.
constexpr std::int64_t kRecoveryNs = 3'000'000'000;

StartError not_alone(const Options& options, long pid) {
  return StartError(
      fmt::format("another collided (pid {}) serves namespace '{}' on domain {}\n"
                  "       stop it, or use another {} or --domain",
                  pid, asked_as(options), options.domain, options.replica_of.empty() ? "--namespace" : "--member"));
}

/// Throws StartError where another server has this namespace: both would answer every question.
void make_sure_to_be_alone(const dds::Participant& participant, const Options& options) {
  if (const std::optional<long> pid = heard_primary(participant, asked_as(options), !options.keys.empty()))
    throw not_alone(options, *pid);
}

bool is_there_a_primary(const dds::Participant& participant, const Options& options) {
  // One that stands by may be about to take the place of the one that this server was.
  constexpr std::int64_t kLongNs = 1'000'000'000;
  return heard_primary(participant, options.name_space, !options.keys.empty(),
                       std::max(kLongNs, 2 * options.take_over_ns))
      .has_value();
}

wire_contract::MemberRole first_role(const Options& options, bool follows) {
  using wire_contract::MemberRole;
  if (!options.replica_of.empty()) return MemberRole::replica;
  return follows ? MemberRole::standby : MemberRole::primary;
}

unsigned thread_count(const Options& options) {
  return options.threads > 0 ? options.threads : std::max(1U, std::thread::hardware_concurrency());
}

unsigned step_thread_count(const Options& options) {
  constexpr unsigned kMost = 8;
  if (options.step_threads > 0) return options.step_threads;
  return std::clamp(std::thread::hardware_concurrency(), 1U, kMost);
}

dds::Participant join(const Options& options, spdlog::logger& log) {
  if (options.keys.empty() && options.interface != "lo") {
    log.warn("interface '{}' without keys: whoever reaches it may ask, change and publish; collide help roles",
             options.interface);
  }
  try {
    return dds::Participant({.domain = options.domain,
                             .role = dds::Role::server,
                             .interface = options.interface,
                             .peers = options.peers,
                             .keys = options.keys,
                             .handshake = options.keys.empty() ? std::string() : handshake_library()});
  } catch (const dds::DdsError& failed) { throw StartError(failed.what()); }
}

/// Null where there is no authority.
std::unique_ptr<Election> make_election(const Options& options, ServingTerm& term, const Election::Notice& notice) {
  if (!options.authority || !options.replica_of.empty()) return nullptr;  // a replica never is the primary
  const etcd::EtcdAddress& address = *options.authority;
  const std::string prefix =
      fmt::format("{}/{}/{}", address.key.empty() ? "collided" : address.key, options.domain, options.name_space);
  // All members may be asked, and asked again, before the term of a confirmation is over.
  const std::int64_t third_ns = std::int64_t{options.authority_lease_s} * 1'000'000'000 / 3;
  constexpr std::int64_t kLeastPatienceNs = 50'000'000;
  const std::int64_t patience_ns =
      std::max(kLeastPatienceNs, third_ns / 2 / static_cast<std::int64_t>(address.endpoints.size()));
  return std::make_unique<Election>(
      std::make_unique<etcd::EtcdClient>(address, patience_ns),
      ElectionOptions{
          .store = "etcd",
          .prefix = prefix,
          .life_s = options.authority_lease_s,
          .description = options.member.empty() ? fmt::format("pid {}", getpid()) : fmt::format("'{}'", options.member),
          .mode = options.authority_mode},
      term, notice);
}

/// Without an authority, or in its fast mode, a standby waits for --take-over-after alone, 0.2 s if nobody has said
/// otherwise to it. In strict mode it waits first for the end of the lease, which etcd may keep a second longer.
std::int64_t replaced_within_ns(const Options& options) {
  constexpr std::int64_t kSecondNs = 1'000'000'000;
  const bool waits_for_lease = options.authority && options.authority_mode == TakeOverMode::strict;
  return waits_for_lease ? (options.authority_lease_s + 2) * kSecondNs : kSecondNs;
}

}  // namespace

std::string version_text() { return COLLIDED_VERSION; }

Epoch Server::Parts::make_epoch() {
  if (is_replica() || (!is_standby() && !options.joins)) make_sure_to_be_alone(participant, options);
  const std::uint64_t greatest =
      is_standby() ? greatest_epoch(participant, options.name_space, !options.keys.empty()) : 0;
  Epoch kept = next_epoch(options.state_dir, options.domain, options.name_space,
                          [](const char* name) { return std::getenv(name); });
  if (kept.rival_pid != 0 && is_standby())
    throw StartError(fmt::format("the state folder is used by pid {}\n       give {} a --state-dir of its own",
                                 kept.rival_pid, is_replica() ? "a replica" : "a standby"));
  if (kept.rival_pid != 0) throw not_alone(options, kept.rival_pid);
  if (!kept.damage.empty()) log->warn("{}", kept.damage);
  // Whoever takes the primary's place has a greater one.
  kept.value = std::max(kept.value, greatest + 1);
  if (election) kept.value = election->begin(kept.value);
  if (election && !is_standby()) election->win();
  return kept;
}

Server::Parts::Parts(const Options& given, std::shared_ptr<spdlog::logger> logger, std::function<void()> end)
    : options(given),
      log(std::move(logger)),
      participant(join(options, *log)),
      peers(options.keys.empty() ? nullptr : std::make_unique<KeyedPeers>(options.keys, handshake_library())),
      election(make_election(options, term, [this](const std::string& sentence) { log->warn("{}", sentence); })),
      began_as_standby(!options.standby_of.empty() || is_replica() ||
                       (options.joins && is_there_a_primary(participant, options))),
      epoch(make_epoch()),
      identity{
          .server = random_number(), .epoch = epoch.value, .name_space = options.name_space, .version = version_text()},
      world({.epoch = identity.epoch,
             .max_objects = options.max_objects,
             .max_contacts = options.max_contacts,
             .max_intervals = options.max_intervals,
             .clock_error_ns = options.clock_error_ns,
             .memory = {.reach_ns = options.memory_ns},
             .step_threads = step_thread_count(options),
             .held = options.shard ? std::optional(options.shard->held) : std::nullopt}),
      durable(keep()),
      leases(world),
      audit(
          options.audit_every, [this](const std::string& sentence) { log->error("{}", sentence); }, options.asks_fcl),
      overload([this](const std::string& sentence) { log->warn("{}", sentence); }),
      flight(record()),
      event_writer(participant, answering_identity(), flight.get(), term),
      takes_questions(!is_standby() || is_replica()),
      readiness(is_replica() ? std::make_unique<ReplicaReadiness>(clock) : nullptr),
      sign(is_replica() ? std::make_unique<ReplicaSign>(participant, options.name_space) : nullptr),
      feed(durable && !is_replica() ? std::make_unique<ChangeFeed>(participant, identity.server, identity.name_space)
                                    : nullptr),
      loop({.world = world,
            .clock = clock,
            .inbox = inbox,
            .event_writer = event_writer,
            .write_barriers = write_barriers,
            .leases = leases,
            .questions = questions,
            .admit = [this](AskPointer ask) { answering->admit(std::move(ask)); },
            .tick = [this] { tick(); },
            .notice = [this](const std::string& sentence) { log->warn("{}", sentence); },
            .has_new_publisher =
                [this] {
                  note_publishers();
                  // On the disk before the publisher's first contact is reported: after a crash, no client that knows
                  // of a contact should meet a server that does not wait for the publisher.
                  if (durable) durable->wait(std::chrono::milliseconds(100));
                },
            .is_adding_again = [this] { return !commands.replayed() || (durable && durable->has_losses()); },
            .has_all_back = [this] { return has_all_back(); },
            .lags_primary = [this] { return readiness && !readiness->is_open(); },
            .leaves_out_details = [this] { return overload.leaves_out_details(); }},
           {.step_ns = options.step_ns,
            .recovery_ns = has_crashed() ? kRecoveryNs : 0,
            .limits = {.object_numbers = 2 * options.max_objects, .forget_after_ns = options.forget_after_ns}}),
      commands({loop, inbox, clock, questions, audit, durable.get(), flight.get(), part_meshes, samples,
                options.clock_error_ns, options.shard ? &*options.shard : nullptr, replaced_within_ns(options),
                [this](const CommandAsk& ask) {
                  // In the order of the journal, in which all that is kept has its place too.
                  const bool is_told = feed && succession.role() == wire_contract::MemberRole::primary;
                  if (!is_told || !feed->is_followed()) return;
                  durable->then(
                      [this, change = WorldChange{ask.text, ask.blob}](const std::string&) { feed->tell(change); });
                },
                [this](const std::string& name) { return hand_over_to(name); }, is_replica(),
                [this] { return succession.predecessor(); },
                [this](std::uint64_t publisher) {
                  return listeners ? listeners->owners().why_refused(publisher) : std::string();
                }},
               epoch.kept_in.empty() ? std::string()
                                     : std::filesystem::path(epoch.kept_in).replace_extension(".uploads").string()),
      reply_topic(participant, asked_as(options)),
      succession({.on_world_thread = [this](std::function<void()> job) { inbox.push_own_job(std::move(job)); },
                  .speak = [this](const SpokenBefore& before) { loop.speak(before); },
                  .fall_silent = [this] { loop.fall_silent(); },
                  .say_last_words = [this] { return loop.say_last_words(); },
                  .has_come_as_far = [this](const PublisherProgress& far) { return has_come_as_far(far); },
                  .lend_place =
                      [this] {
                        if (election) election->lend();
                      },
                  .take_place_back = [this] { return !election || election->take_back(); },
                  .takes_questions = takes_questions,
                  .self = identity.server,
                  .epoch = [this] { return epoch_now(); },
                  .joins = options.joins || is_replica(),
                  .notice = [this](const std::string& sentence) { log->warn("{}", sentence); },
                  .became_primary =
                      [this] {
                        be_present();
                        membership->say_now();
                      },
                  .end = std::move(end)},
                 first_role(options, is_standby())),
      followers(identity.server,
                {.send_all = [this](std::uint64_t follower, std::uint64_t fetch) { send_all(follower, fetch); },
                 .ask_again = [this] { loop.ask_publishers_again(); }}) {
  if (participant.configured_by_environment())
    log->warn("CYCLONEDDS_URI is set: used as it is, [dds] interface and peers are not");
}

Identity Server::Parts::answering_identity() const {
  Identity told = identity;
  told.name_space = asked_as(options);
  return told;
}

bool Server::Parts::has_crashed() const {
  if (is_standby()) return false;
  return epoch.past == PastEnd::running || (durable && durable->crashed());
}

/// The journal first, then the epoch: a crash between the two leaves a journal that says nothing is missing.
std::unique_ptr<DurableState> Server::Parts::keep() {
  if (epoch.kept_in.empty()) {
    say_unwritten();
    log->warn("nothing is kept: what commands do is lost with a crash, and --durable refuses it");
    return nullptr;
  }
  const std::filesystem::path summand = std::filesystem::path(epoch.kept_in).replace_extension(".journal");
  std::unique_ptr<Disk> disk = disk_in(summand.parent_path().string());
  // What a standby has it fetches; what an earlier process left is older.
  if (is_standby()) disk->remove(summand.filename().string());
  auto kept = std::make_unique<DurableState>(std::move(disk), summand.filename().string(),
                                             is_standby() ? PastEnd::stopped : epoch.past,
                                             [this](const std::string& sentence) { log->warn("{}", sentence); });
  open_epoch(epoch);
  if (!epoch.problem.empty()) say_unwritten();
  if (!is_standby() && (epoch.past == PastEnd::running || kept->crashed()))
    log->warn("the last server did not end in order; recovering for up to {} s", kRecoveryNs / 1'000'000'000);
  for (const std::string& loss : kept->losses())
    log->error("lost: {}; recovering until somebody says: collide accept-loss", loss);
  if (kept->had_covers()) world.state_covers("", {});
  if (!kept->publishers_left().empty())
    log->warn("waiting for {} publishers from before", kept->publishers_left().size());
  if (!kept->commands_left().empty())
    log->warn("adding again {} scenes and objects from before", kept->commands_left().size());
  return kept;
}

void Server::Parts::say_unwritten() const {
  log->warn("the epoch {} is not written down: {}; --state-dir names a folder that can be written", epoch.value,
            epoch.problem);
}

std::unique_ptr<FlightRecorder> Server::Parts::record() {
  if (options.flight_recorder_ns == 0) return nullptr;
  const std::string stem = std::filesystem::path(epoch.kept_in).replace_extension().string();
  auto recorder =
      std::make_unique<FlightRecorder>(options.name_space, options.flight_recorder_ns, stem, options.forget_after_ns);
  recorder->write_at_fatal_signals();
  return recorder;
}

bool Server::Parts::has_all_back() const {
  if (!durable) return false;
  const auto& left = durable->publishers_left();
  return std::all_of(left.begin(), left.end(),
                     [&](std::uint64_t publisher) { return loop.publishers().is_complete(publisher); });
}

void Server::Parts::note_publishers() {
  if (!durable) return;
  std::set<std::uint64_t> there;
  loop.publishers().for_each(clock.now_ns(), [&](const PublisherView& view) { there.insert(view.publisher); });
  // A publisher that has not come back yet stays noted, since this server may crash too.
  if (loop.recovering()) there.insert(durable->publishers_left().begin(), durable->publishers_left().end());
  durable->set_publishers(there);
}

void Server::Parts::tick() {
  note_publishers();
  if (event_writer.lapsed_ns() != 0 && !term.is_over()) loop.speak({.heard_ns = event_writer.lapsed_ns()});
  answering->tick(listeners->query_owners());
  commands.look_for_gone();
  const std::uint64_t superseded_now = inbox.counts().poses_superseded;
  const bool leaves_out_poses = superseded_now != std::exchange(superseded, superseded_now);
  overload.note(leaves_out_poses, answering->was_pressed());
  if (readiness) {
    readiness->note_turn();
    // Between the poses that are left the movers went another way than in the primary's world.
    if (leaves_out_poses) readiness->doubt();
  }
  listeners->take_left_definitions();
  listeners->drop_unmatched_writers();
  if (peers) {
    if (const std::string news = peers->look_for_revoked(); !news.empty()) log->info("keys: {}", news);
    if (const std::string news = peers->look_for_turned_away(); !news.empty()) log->warn("keys: {}", news);
  }
  note_refused();
}

/// Logs publishers and clients that are not taken: the first time, and whenever there are twice as many as then.
void Server::Parts::note_refused() {
  PublisherOwners& owners = listeners->owners();
  for (const std::uint64_t publisher : owners.take_forged()) {
    log->warn("publisher {}: another process has sent under its number and was refused. Samples refused so far: {}",
              printable(loop.publisher_name(publisher)), owners.refused());
  }
  if (const std::optional<std::uint64_t> refused = owners.take_refused()) {
    log->warn("publisher {:016x} refused: {}. Samples refused so far: {}", *refused, owners.why_refused(*refused),
              owners.refused());
  }
  const std::uint64_t away = answering->clients_turned_away();
  if (std::bit_width(away) == std::bit_width(turned_away)) return;
  turned_away = away;
  log->warn(
      "too many clients: the server takes {} of all, {} of one process, and the last {} only from processes with fewer "
      "than {}. Requests of others that were not answered so far: {}",
      Clients::kMost, Clients::kMostOfParticipant, Clients::kReserved, Clients::kFew, away);
}

/// Waits until the world's thread has carried out the jobs of all commands so far, at most 3 s.
void Server::Parts::let_jobs_end() {
  constexpr std::chrono::seconds kPatience{3};
  const auto done = std::make_shared<std::promise<void>>();
  inbox.push_own_job([done] { done->set_value(); });
  done->get_future().wait_for(kPatience);
}

Server::Server(const Options& options, std::shared_ptr<spdlog::logger> log, std::function<void()> end)
    : parts_(std::make_unique<Parts>(options, std::move(log), std::move(end))) {
  load_start_scenes(options, parts_->world, parts_->clock.now_ns());
  if (!parts_->durable) return;
  std::set<std::string> names;
  for (const auto& scene : parts_->world.newest()->scenes) names.insert(scene->name);
  parts_->durable->set_start_scenes(std::move(names));
}

Server::~Server() { stop(); }

std::string Server::start() {
  Parts& p = *parts_;
  p.answering = std::make_unique<Answering>(
      Answering::Collaborators{p.world, p.clock, p.write_barriers, p.leases, p.questions, p.audit, p.part_meshes,
                               p.samples},
      p.reply_topic,
      AnsweringOptions{p.identity.server, p.identity.epoch, thread_count(p.options), p.options.deadline_ns,
                       p.options.error_m, [&p] { return p.loop.recovering(); }, &p.overload, p.flight.get(),
                       p.peers.get(), p.readiness.get(), p.election ? &p.term : nullptr},
      [this](CommandAsk ask) { parts_->commands.run(std::move(ask)); });
  // Everything that the first sample may need is made before the readers are.
  p.commands.connect(*p.answering);
  p.listeners = std::make_unique<Listeners>(p.participant, p.options.name_space, asked_as(p.options), p.clock, p.inbox,
                                            *p.answering, p.flight.get(), p.peers.get(), p.takes_questions, p.term);
  if (p.durable) p.commands.replay(p.durable->commands_left());
  if (p.is_standby() && !p.is_replica()) p.event_writer.fall_silent();
  p.world_thread = std::thread([&p] { p.loop.run(); });
  p.heartbeat.emplace([&p](std::int64_t now_ns) {
    // The world's thread may have no time to fall silent where another server has this one's place.
    if (!p.succession.has_given_way()) p.event_writer.repeat_status(now_ns, p.loop.state());
  });
  if (!p.is_standby() || p.is_replica()) p.be_present();
  if (p.is_standby()) p.stand_by();
  p.membership = std::make_unique<Membership>(p.participant, p.identity, p.describe_self(), p.world, p.clock,
                                              [&p](const std::string& sentence) { p.log->warn("{}", sentence); });
  if (p.election) p.election->connect([&p](const std::string& why) { p.succession.lose_place(why); });
  const SnapshotRing::Lease state = p.world.newest();
  std::string scenes;
  for (const auto& scene : state->scenes) scenes += (scenes.empty() ? "" : ", ") + scene->name;
  const char* part = p.is_replica() ? "replica, " : p.is_standby() ? "standing by, " : "";
  return fmt::format("ready: {}namespace '{}', domain {}, pid {}, epoch {}, {}", part, asked_as(p.options),
                     p.options.domain, getpid(), p.identity.epoch, scenes.empty() ? "no scene" : scenes);
}

bool Server::has_given_way() const { return parts_->succession.has_given_way(); }

bool Server::goes_on() {
  const std::string chosen = parts_->succession.take_choice();
  return !chosen.empty() && !parts_->hand_over(chosen);
}

void Server::write_flight_recorder() {
  Parts& p = *parts_;
  if (!p.flight) return p.log->warn("SIGUSR1: the flight recorder is off");
  try {
    const auto now = std::chrono::system_clock::now();
    const FlightFile file =
        p.flight->write(fmt::format("{:%Y%m%dT%H%M%S}Z", fmt::gmtime(now)), p.options.flight_recorder_ns);
    p.log->info("flight recorder: {} messages of the last {:.1f} s, {} bytes, in {}{}", file.messages,
                static_cast<double>(file.to_ns - file.from_ns) * wire_contract::kNanosecond_s, file.bytes, file.path,
                file.dropped > 0 ? fmt::format("; {} samples since the start had no room", file.dropped) : "");
  } catch (const std::exception& failed) { p.log->error("flight recorder: {}. Nothing was written", failed.what()); }
}

void Server::stop() {
  Parts& p = *parts_;
  if (!p.world_thread.joinable()) return;
  static_cast<void>(p.hand_over(""));
  // It calls the standby; and no place is taken any more.
  p.membership->leave();
  if (p.standby) p.standby->leave();
  p.presence.reset();
  // In this order no new command is taken, those under way and the questions that are queued are answered, and then the
  // world ends its contacts and reports that.
  p.commands.stop();
  p.let_jobs_end();
  if (p.durable) p.durable->finish();
  p.answering->stop();
  p.audit.stop();
  p.loop.stop();
  p.world_thread.join();
  p.heartbeat.reset();
  p.listeners.reset();
  p.event_writer.leave();
  // Who comes next may have the place once nothing more is told.
  if (p.election) p.election->close();
  if (p.durable) p.durable->close();
  close_epoch(p.epoch);
}

int run_once(const Options& options) {
  World world({.epoch = 1, .max_objects = options.max_objects, .max_contacts = options.max_contacts});
  load_start_scenes(options, world, 1);
  const SelfTestResult result = self_test(*world.newest(), 200, 1);
  for (const std::string& difference : result.differences) fmt::print("differs: {}\n", difference);
  fmt::print("self-test: {} of {} answers equal to brute force by rationals\n", result.equal, result.asked);
  return result.equal == result.asked ? 0 : 1;
}

}  // namespace collided::engine::service
