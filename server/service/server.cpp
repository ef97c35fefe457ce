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
#include "server/service/commands/command_arguments.hpp"
#include "server/service/first_look.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/random_number.hpp"
#include "server/service/self_test.hpp"
#include "server/service/server_parts.hpp"
#include "server/service/start_scenes.hpp"

namespace collided::engine::service {
namespace {

/// How long a server waits after a crash for its publishers and clients: they look for servers every 2 s.
constexpr std::int64_t kRecoveryNs = 3'000'000'000;

StartError not_alone(const Options& options, const Place& place, long pid) {
  return StartError(
      fmt::format("another collided (pid {}) serves namespace '{}' on domain {}\n"
                  "       stop it, or use another {} or --domain",
                  pid, place.asked_as(), options.domain, place.is_replica() ? "--member" : "--namespace"));
}

/// Throws StartError if another server has this namespace: both would answer every question.
void make_sure_to_be_alone(const dds::Participant& participant, const Options& options, const Place& place) {
  if (const std::optional<long> pid = heard_primary(participant, place.asked_as(), !options.keys.empty()))
    throw not_alone(options, place, *pid);
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

}  // namespace

std::string version_text() { return COLLIDED_VERSION; }

Questioning::Questioning(const World& world, const Options& options, spdlog::logger& log)
    : leases(world),
      audit(
          options.audit_every, [&log](const std::string& sentence) { log.error("{}", sentence); }, options.asks_fcl),
      overload([&log](const std::string& sentence) { log.warn("{}", sentence); }) {}

Epoch Server::Parts::make_epoch() {
  if (place->has_to_be_alone()) make_sure_to_be_alone(participant, options, *place);
  Epoch kept = next_epoch(options.state_dir, options.domain, options.name_space,
                          [](const char* name) { return std::getenv(name); });
  if (kept.rival_pid != 0 && place->begins_as_follower())
    throw StartError(fmt::format("the state folder is used by pid {}\n       give {} a --state-dir of its own",
                                 kept.rival_pid, place->is_replica() ? "a replica" : "a standby"));
  if (kept.rival_pid != 0) throw not_alone(options, *place, kept.rival_pid);
  if (!kept.damage.empty()) log->warn("{}", kept.damage);
  kept.value = place->draw_epoch(kept.value);
  return kept;
}

Server::Parts::Parts(const Options& given, std::shared_ptr<spdlog::logger> logger, const MakePlace& make_place,
                     std::function<void()> end)
    : options(given),
      log(std::move(logger)),
      participant(join(options, *log)),
      peers(options.keys.empty() ? nullptr : std::make_unique<KeyedPeers>(options.keys, handshake_library())),
      place(make_place(options, participant, clock, log, std::move(end))),
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
      questioning(world, options, *log),
      flight(record()),
      inventory({[this](const Inventory::Changes& changes) {
                   if (durable) durable->keep(changes);
                 },
                 [this](const Inventory::Changes& changes) {
                   if (flight) flight->note_changes(changes);
                 }}),
      event_writer(participant, answering_identity(), flight.get(), *place),
      loop(loop_collaborators(),
           {.step_ns = options.step_ns,
            .recovery_ns = has_crashed() ? kRecoveryNs : 0,
            .restores = durable && (!durable->commands_left().empty() || durable->has_losses()),
            .limits = {.object_numbers = 2 * options.max_objects, .forget_after_ns = options.forget_after_ns}}),
      commands(command_collaborators(),
               epoch.kept_in.empty() ? std::string()
                                     : std::filesystem::path(epoch.kept_in).replace_extension(".uploads").string()),
      reply_topic(participant, place->asked_as()) {
  if (participant.configured_by_environment())
    log->warn("CYCLONEDDS_URI is set: used as it is, [dds] interface and peers are not");
}

WorldLoop::Collaborators Server::Parts::loop_collaborators() {
  return {.world = world,
          .clock = clock,
          .inbox = inbox,
          .event_writer = event_writer,
          .write_barriers = questioning.write_barriers,
          .leases = questioning.leases,
          .questions = questioning.counts,
          .place = *place,
          .admit = [this](AskPointer ask) { answering->admit(std::move(ask)); },
          .tick = [this] { tick(); },
          .notice = [this](const std::string& sentence) { log->warn("{}", sentence); },
          .has_new_publisher =
              [this] {
                note_publishers();
                // On disk before the publisher's first contact is reported: after a crash, a client that knows of a
                // contact must not meet a server that does not wait for the publisher.
                if (durable) durable->wait(std::chrono::milliseconds(100));
              },
          .is_adding_again = [this] { return !commands.replayed() || (durable && durable->has_losses()); },
          .has_all_back = [this] { return has_all_back(); },
          .leaves_out_details = [this] { return questioning.overload.leaves_out_details(); }};
}

CommandCollaborators Server::Parts::command_collaborators() {
  return {.loop = loop,
          .inbox = inbox,
          .clock = clock,
          .counts = questioning.counts,
          .audit = questioning.audit,
          .durable = durable.get(),
          .inventory = inventory,
          .flight = flight.get(),
          .part_meshes = questioning.part_meshes,
          .samples = questioning.samples,
          .place = *place,
          .uses_keys = peers != nullptr,
          .clock_error_ns = options.clock_error_ns,
          .shard = options.shard ? &*options.shard : nullptr,
          .why_refused = [this](std::uint64_t publisher) {
            return listeners ? listeners->owners().why_refused(publisher) : std::string();
          }};
}

Answering::Collaborators Server::Parts::answering_collaborators() {
  Questioning& q = questioning;
  return {world, clock, q.write_barriers, q.leases, q.counts, q.audit, q.part_meshes, q.samples, *place};
}

void Server::Parts::be_present() {
  const bool is_heard = options.keys.empty() && !participant.configured_by_environment();
  presence.emplace(options.domain, place->asked_as(), is_heard ? options.interface : std::string());
}

Identity Server::Parts::answering_identity() const {
  Identity told = identity;
  told.name_space = place->asked_as();
  return told;
}

bool Server::Parts::has_crashed() const {
  if (place->begins_as_follower()) return false;
  return epoch.past == PastEnd::running || (durable && durable->crashed());
}

/// The journal first, then the epoch: after a crash between the two, the journal reports that nothing is missing.
std::unique_ptr<DurableState> Server::Parts::keep() {
  if (epoch.kept_in.empty()) {
    say_unwritten();
    log->warn("nothing is kept: what commands do is lost when the server ends, and --durable refuses it");
    return nullptr;
  }
  const std::filesystem::path summand = std::filesystem::path(epoch.kept_in).replace_extension(".journal");
  const std::string folder = summand.parent_path().string();
  // A standby fetches the primary's state; the state of an earlier process in its folder is older.
  const DurableState::Start start =
      place->begins_as_follower() || options.is_fresh ? DurableState::Start::drops : DurableState::Start::restores;
  std::unique_ptr<DurableState> kept;
  try {
    kept = std::make_unique<DurableState>(
        disk_in(folder), summand.filename().string(), epoch.past,
        [this](const std::string& sentence) { log->warn("{}", sentence); }, start);
  } catch (const StateError& wrong) {
    throw StartError(fmt::format("{}/{}\n       collided --fresh drops what the folder keeps", folder, wrong.what()));
  }
  open_epoch(epoch);
  if (!epoch.problem.empty()) say_unwritten();
  if (!place->begins_as_follower() && (epoch.past == PastEnd::running || kept->crashed()))
    log->warn("the last server did not end in order; recovering for up to {} s", kRecoveryNs / 1'000'000'000);
  for (const std::string& loss : kept->losses())
    log->error("lost: {}; recovering until somebody says: collide accept-loss", loss);
  if (kept->had_covers()) world.state_covers("", {});
  if (!kept->publishers_left().empty())
    log->warn("waiting for {} publishers from before", kept->publishers_left().size());
  if (!kept->commands_left().empty())
    log->info("carrying out again {} commands from before; collided --fresh starts without them",
              kept->commands_left().size());
  if (options.is_fresh)
    log->info("--fresh: what was kept is dropped: {}", kept->dropped().empty() ? "nothing" : kept->dropped());
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
  // Publishers that have not come back yet stay in the journal, since this server may crash too.
  if (loop.recovering()) there.insert(durable->publishers_left().begin(), durable->publishers_left().end());
  durable->set_publishers(there);
}

void Server::Parts::tick() {
  note_publishers();
  const std::uint64_t superseded_now = inbox.counts().poses_superseded;
  const bool leaves_out_poses = superseded_now != std::exchange(last_tick.superseded, superseded_now);
  place->tick(leaves_out_poses);
  answering->tick(listeners->query_owners());
  commands.look_for_gone();
  questioning.overload.note(leaves_out_poses, answering->was_pressed());
  listeners->take_left_definitions();
  listeners->drop_unmatched_writers();
  if (peers) {
    if (const std::string news = peers->look_for_revoked(); !news.empty()) log->info("keys: {}", news);
    if (const std::string news = peers->look_for_turned_away(); !news.empty()) log->warn("keys: {}", news);
  }
  note_refused();
}

/// Logs refused publishers and clients: the first time, and whenever their number has doubled.
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
  if (std::bit_width(away) == std::bit_width(last_tick.turned_away)) return;
  last_tick.turned_away = away;
  log->warn(
      "too many clients: the server takes {} of all, {} of one process, and the last {} only from processes with fewer "
      "than {}. Requests of others that were not answered so far: {}",
      Clients::kMost, Clients::kMostOfParticipant, Clients::kReserved, Clients::kFew, away);
}

void Server::Parts::let_jobs_end() {
  constexpr std::chrono::seconds kPatience{3};
  const auto done = std::make_shared<std::promise<void>>();
  inbox.push_own_job([done] { done->set_value(); });
  done->get_future().wait_for(kPatience);
}

Server::Server(const Options& options, std::shared_ptr<spdlog::logger> log, const MakePlace& make_place,
               std::function<void()> end)
    : parts_(std::make_unique<Parts>(options, std::move(log), make_place, std::move(end))) {
  load_start_scenes(options, parts_->world, parts_->clock.now_ns());
  std::set<std::string> names;
  for (const auto& scene : parts_->world.newest()->scenes) names.insert(scene->name);
  parts_->inventory.set_start_scenes(std::move(names));
  if (parts_->durable) parts_->durable->restore(parts_->inventory);
}

Server::~Server() { stop(); }

std::string Server::start() {
  Parts& p = *parts_;
  p.answering = std::make_unique<Answering>(
      p.answering_collaborators(), p.reply_topic,
      AnsweringOptions{p.identity.server, p.identity.epoch, thread_count(p.options), p.options.deadline_ns,
                       p.options.error_m, [&p] { return p.loop.recovering(); }, &p.questioning.overload, p.flight.get(),
                       p.peers.get()},
      [this](CommandAsk ask) { parts_->commands.run(std::move(ask)); });
  // Everything that the first sample may need is made before the readers.
  p.commands.connect(*p.answering);
  p.place->attach({.identity = p.identity,
                   .epoch = p.epoch,
                   .world = p.world,
                   .durable = p.durable.get(),
                   .inventory = p.inventory,
                   .inbox = p.inbox,
                   .event_writer = p.event_writer,
                   .loop = p.loop,
                   .commands = p.commands,
                   .answering = *p.answering,
                   .be_present = [&p] { p.be_present(); },
                   .let_jobs_end = [&p] { p.let_jobs_end(); }});
  p.listeners = std::make_unique<Listeners>(p.participant, p.options.name_space, p.clock, p.inbox, *p.answering,
                                            p.flight.get(), p.peers.get(), *p.place);
  if (p.durable) p.commands.replay(p.durable->commands_left());
  p.world_thread = std::thread([&p] { p.loop.run(); });
  p.heartbeat.emplace([&p](std::int64_t now_ns) {
    // The world's thread may be too busy to fall silent when another server has taken over.
    const bool is_over = p.place->has_given_way();
    return is_over ? now_ns + wire_contract::kStatusPeriodNs : p.event_writer.repeat_status(now_ns, p.loop.state());
  });
  const wire_contract::MemberRole role = p.place->first_role();
  if (role != wire_contract::MemberRole::standby) p.be_present();
  p.place->start();
  const SnapshotRing::Lease state = p.world.newest();
  std::string scenes;
  for (const auto& scene : state->scenes) scenes += (scenes.empty() ? "" : ", ") + scene->name;
  const char* part = p.place->is_replica()                        ? "replica, "
                     : role == wire_contract::MemberRole::standby ? "standing by, "
                                                                  : "";
  return fmt::format("ready: {}namespace '{}', domain {}, pid {}, epoch {}, {}", part, p.place->asked_as(),
                     p.options.domain, getpid(), p.identity.epoch, scenes.empty() ? "no scene" : scenes);
}

bool Server::is_restoring() const {
  const Parts& p = *parts_;
  if (!p.commands.replayed()) return true;
  const bool waits_for_others = p.has_crashed() || (p.durable && p.durable->has_losses());
  return !waits_for_others && p.loop.recovering();
}

bool Server::has_given_way() const { return parts_->place->has_given_way(); }

bool Server::goes_on() { return parts_->place->goes_on(); }

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
  p.place->leave();
  p.presence.reset();
  // In this order no new command is accepted, those in flight and the queued questions are answered, and then the world
  // ends its contacts and reports that.
  p.commands.stop();
  p.let_jobs_end();
  if (p.durable) p.durable->finish();
  p.answering->stop();
  p.questioning.audit.stop();
  p.loop.stop();
  p.world_thread.join();
  p.heartbeat.reset();
  p.listeners.reset();
  p.event_writer.leave();
  p.place->close();
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
