#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "idl/shards/shard_split.hpp"
#include "server/service/commands/bound_command.hpp"
#include "server/service/commands/geometry_service.hpp"
#include "server/service/commands/scene_loading.hpp"
#include "server/service/commands/shard_place.hpp"
#include "server/service/commands/shard_watchers.hpp"
#include "server/service/commands/upload_receiver.hpp"
#include "server/service/durability/durable_state.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/questions/background_audit.hpp"
#include "server/service/runtime/fair_queue.hpp"
#include "server/service/runtime/work_queue.hpp"
#include "server/service/world_loop.hpp"
#include "server/geometry/function_ref.hpp"
#include "server/world/audit/menu.hpp"
#include "server/world/events/recent_events.hpp"
#include "server/world/explain/fence_explanation.hpp"
#include "server/world/explain/ray_explanation.hpp"
#include "server/world/fences/fence_table.hpp"
#include "server/world/groups/clearance.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine::service {

/// Carries out the commands of idl/commands.hpp. Most that only look are answered on the thread that asks, on a
/// snapshot; one that changes the world becomes a job of the world's thread; files, pairs of objects and shapes have
/// threads of their own.
class Commands {
 public:
  /// What it works with; all must outlive the Commands.
  struct Collaborators {
    WorldLoop& loop;
    Inbox& inbox;
    const WorldClock& clock;
    const QuestionCounts& counts;
    const BackgroundAudit& audit;
    DurableState* durable;   // keeps over a crash what commands add; null: nothing is kept
    FlightRecorder* flight;  // for `recording`; null: there is none
    PartMeshes& part_meshes;
    QuestionSamples& samples;
    std::int64_t clock_error_ns = 0;      // by which publishers' clocks may differ, as the world was told
    const ShardPlace* shard = nullptr;    // null: it holds all of the world
    std::int64_t replaced_within_ns = 0;  // of a shard: so long its place may be empty between it and a standby
    // Called on the world's thread with each command that has changed the world, for servers that follow; empty: there
    // can be none.
    std::function<void(const CommandAsk&)> changed = {};
    // The name of the server that takes this one's place, by the name that was asked for, or any; throws BadCommand.
    std::function<std::string(const std::string&)> hand_over = {};
    bool is_replica = false;                          // what changes the world is the primary's to do
    std::function<std::uint64_t()> predecessor = {};  // the server whose place this one has taken; 0: none
    // Why a publisher's samples are not taken; empty: they are. On the world's thread
    std::function<std::string(std::uint64_t)> why_refused = {};
  };

  /// uploads  folder for files that clients send; empty: none are taken
  Commands(const Collaborators& with, const std::string& uploads);
  ~Commands();

  /// Sets where the answers go. To be called before the first run().
  void connect(Answering& answering) { answering_ = &answering; }
  /// Carries out again what a crashed process had carried out: scenes on a thread of their own, the rest on the
  /// world's. To be called after connect(); returns at once.
  void replay(const std::vector<CommandAsk>& asks);
  /// Carries out what a command has done to another server's world, and waits for it. Returns why it was refused; empty:
  /// it was not. One thread, not the world's.
  std::string follow(CommandAsk ask);
  /// Whether replay() has nothing left to do. Any thread.
  bool replayed() const { return !replaying_.load(); }
  /// Carries out a command. Any thread; returns at once, or after looking. The answer comes through
  /// Answering::send_text().
  void run(CommandAsk ask);
  /// To be called now and then, on the world's thread: calls off pairs, clearances and menus whose clients have gone, and
  /// removes their fences.
  void look_for_gone();
  /// Calls off the load under way and ends the threads; commands that come later are refused.
  void stop();

 private:
  static constexpr std::size_t kMostSlowJobs = 4;    // waiting
  static constexpr std::size_t kMostPairJobs = 128;  // waiting, half of them at most by one client alone
  static constexpr std::size_t kMostRecordings = 4;  // files kept to be fetched
  /// A `load` command, parsed.
  struct Load {
    CommandAsk ask;
    std::string path;
    LoadOptions options;
    std::vector<Aabb> covers;
    bool replace = false;
    bool is_moving = false;                 // its objects take poses
    bool is_durable = false;                // refused where it cannot be kept
    std::optional<std::uint32_t> checksum;  // CRC-32 of the file; nothing: whatever it holds is taken
  };

  void answer_followed(wire_contract::ReplyStatus status, const std::string& text);
  void tell_followers(const CommandAsk& ask) const;
  std::string why_not_allowed(const CommandAsk& ask, const Arguments& arguments) const;
  const BoundCommand& handler_of(const Arguments& arguments) const;
  void send(const CommandAsk& ask, wire_contract::ReplyStatus status, std::string text);
  void answer(const CommandAsk& ask, const std::function<nlohmann::json()>& work);
  void answer_once_kept(const CommandAsk& ask, const std::function<nlohmann::json()>& work, bool is_durable = false);
  void once_there_is_room(const CommandAsk& ask, bool is_durable, std::function<void()> go_on);
  void queue_for_world(CommandAsk ask, const BoundCommand& handler, const Arguments& arguments);
  void drop_uploads();
  void forget_upload(const std::string& path);
  void replay_on_world_thread(const std::vector<CommandAsk>& asks);
  bool is_removed_already(const Arguments& arguments) const;

  // The commands of each family, in the file that has their handlers.
  std::vector<BoundCommand> object_commands();
  std::vector<BoundCommand> scene_commands();
  std::vector<BoundCommand> rule_commands();
  std::vector<BoundCommand> probe_commands();
  std::vector<BoundCommand> fence_commands();
  std::vector<BoundCommand> measuring_commands();
  std::vector<BoundCommand> shard_commands();
  std::vector<BoundCommand> server_commands();

  // On the thread that asks.
  nlohmann::json list(const Arguments& arguments) const;
  nlohmann::json plan() const;
  nlohmann::json covers() const;
  nlohmann::json shard();
  static nlohmann::json covers_json(const std::vector<Aabb>& boxes);
  nlohmann::json allowed() const;
  nlohmann::json audit() const;
  nlohmann::json figures() const;
  nlohmann::json hand_over(const Arguments& arguments) const;
  nlohmann::json steps(const Arguments& arguments) const;
  nlohmann::json sampled(const CommandAsk& ask, const Arguments& arguments);
  // On the world's thread.
  nlohmann::json get(const Arguments& arguments);
  nlohmann::json left_out(const Arguments& arguments);
  nlohmann::json settled(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json succession(const CommandAsk& ask, const Arguments& arguments);
  void succeed(shards::MapSuccession next);
  nlohmann::json add(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json move(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json remove(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json clear(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json probe(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json probes(const Arguments& arguments);
  nlohmann::json accept_loss(const Arguments& arguments);
  nlohmann::json fence(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json fences(const Arguments& arguments);
  void add_fence(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json remove_fences(const CommandAsk& ask, const Arguments& arguments);
  void remove_fences(const std::vector<std::string>& chosen);
  void drop_fences_of_gone();
  void for_each_standing(const std::string& glob,
                         FunctionRef<void(const FenceTable& table, std::uint32_t slot)> visit) const;
  void for_each_fence(const std::string& glob,
                      FunctionRef<void(const FenceTable& table, std::uint32_t slot)> visit) const;
  void for_each_band(const std::string& glob,
                     FunctionRef<void(const FenceTable& table, std::uint32_t slot)> visit) const;
  void for_each_margin(const std::string& glob, FunctionRef<void(const FenceDefinition& margin)> visit) const;
  nlohmann::json margins(const Arguments& arguments);
  nlohmann::json nearest(const Arguments& arguments);
  nlohmann::json allow(const Arguments& arguments);
  nlohmann::json deny(const Arguments& arguments);
  nlohmann::json attach(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json detach(const CommandAsk& ask, const Arguments& arguments);
  void keep_detached(const std::string& child);
  nlohmann::json note_ended_attachments();
  bool waits_for_parent(const CommandAsk& ask) const;
  void attach_again();
  nlohmann::json change_rules(const PairRule& changed, std::vector<PairRule> rules);
  nlohmann::json add_scene(const Load& load, LoadedScene& loaded);
  void keep_upload(const std::string& scene, const std::string& path);

  ObjectId find_object(const std::string& name) const;
  void refuse_if_live(const ObjectInfo& info) const;
  static void refuse_if_foreign(const CommandAsk& ask, std::string_view object, const char* not_done);
  const ObjectInfo* foreign_in_scene(const CommandAsk& ask, std::string_view scene) const;
  void refuse_foreign_load(const Load& load, const Scene& scene, bool replaces) const;
  std::uint64_t step();
  std::uint32_t ended_count() const;

  // On threads of their own, one job after the other: loads and menus on one, pairs on the second. A pair that costs
  // much goes on to the third, where recordings are written, so that no other waits behind it.
  using SlowJob = std::function<void()>;
  /// A `pair`, `clearance` or `menu` command: what it asks, and when nobody needs the answer any more (steady clock), or that its
  /// client has gone.
  struct AwaitedJob {
    CommandAsk ask;
    std::int64_t deadline_ns = 0;
    std::atomic<bool> called_off{false};

    bool is_over() const { return called_off.load() || (deadline_ns != 0 && steady_ns() > deadline_ns); }
  };
  std::shared_ptr<AwaitedJob> await(CommandAsk ask, const Arguments& arguments);
  bool is_wanted(const AwaitedJob& job) const;
  nlohmann::json finished(const AwaitedJob& job, const std::function<nlohmann::json()>& work) const;
  void end_awaited();
  /// Two objects of one state, what is asked about them, and about how many triangles that has to look at.
  struct AskedPair {
    SnapshotRing::Lease newest;
    std::shared_ptr<const Snapshot> past;  // null: the newest is asked about
    ObjectId a = 0;
    ObjectId b = 0;
    PairAsk options = {};
    bool is_fcl_asked = false;
    std::int64_t since_ns = 0;  // world time; of an explanation
    double cost = 0;

    const Snapshot& state() const { return past ? *past : *newest; }
  };
  /// Two groups of objects of one state, likewise.
  struct AskedGroups {
    SnapshotRing::Lease newest;
    std::shared_ptr<const Snapshot> past;
    ClearanceAsk options = {};
    double cost = 0;

    const Snapshot& state() const { return past ? *past : *newest; }
  };
  /// A ray of one state that is to be explained, likewise.
  struct AskedRay {
    SnapshotRing::Lease newest;
    std::shared_ptr<const Snapshot> past;
    RayExplanationAsk options = {};
    std::int64_t deadline_ns = 0;
    const std::atomic<bool>* called_off = nullptr;
    double cost = 0;

    const Snapshot& state() const { return past ? *past : *newest; }
  };
  /// An event that is to be explained.
  struct AskedEvent {
    RecentEvent recent;
    bool is_of_fence = false;
    std::int64_t deadline_ns = 0;
    const std::atomic<bool>* called_off = nullptr;
    double cost = 0;
  };
  void make_room(const char* what, const WorkQueue<SlowJob>& jobs) const;
  Load parse_load(CommandAsk ask, const Arguments& arguments) const;
  void load_later(CommandAsk ask, const Arguments& arguments);
  void load_one(Load load);
  void refuse_load(const Load& load, const std::string& why, const std::string& hint = {});
  void drop_file_of(const Load& load);
  void load_upload(CommandAsk ask, const std::string& path, std::uint32_t checksum);
  void menu_later(CommandAsk ask, const Arguments& arguments);
  nlohmann::json menu(const MenuOptions& options, const AwaitedJob& job) const;
  static void push_fairly(const char* what, FairQueue<SlowJob>& jobs, const Share& share, SlowJob job);
  /// A command up to this cost takes some milliseconds at most where its surfaces are not everywhere near each other, and
  /// some 50 ms where they are; what costs more has a thread of its own, where only its like waits for it.
  static constexpr double kCheapCost = 4'000;
  /// Certificates and lists of triangles take this many times longer.
  static constexpr double kDetailCost = 8;
  template <class Asked>
  void in_turn(CommandAsk ask, const Arguments& arguments, const char* what,
               Asked (Commands::*find)(const AwaitedJob&) const, nlohmann::json (Commands::*work)(const Asked&) const);
  void pair_later(CommandAsk ask, const Arguments& arguments);
  AskedPair asked_pair(const AwaitedJob& job) const;
  nlohmann::json examined(const AskedPair& asked) const;
  void explain_later(CommandAsk ask, const Arguments& arguments);
  AskedPair asked_explanation(const AwaitedJob& job) const;
  nlohmann::json explained(const AskedPair& asked) const;
  AskedRay asked_ray(const AwaitedJob& job) const;
  nlohmann::json explained_ray(const AskedRay& asked) const;
  void explain_fence_later(CommandAsk ask);
  void explain_fence_of(const CommandAsk& ask);
  nlohmann::json explained_fence(const FenceLook& look, const AwaitedJob& job) const;
  AskedEvent asked_event(const AwaitedJob& job) const;
  nlohmann::json explained_event(const AskedEvent& asked) const;
  std::shared_ptr<const Snapshot> past_state(const Arguments& arguments, const Snapshot& newest) const;
  void clearance_later(CommandAsk ask, const Arguments& arguments);
  AskedGroups asked_groups(const AwaitedJob& job) const;
  nlohmann::json measured(const AskedGroups& asked) const;
  void tell_flight_recorder(const CommandAsk& ask);
  void recording_later(CommandAsk ask, const Arguments& arguments);
  nlohmann::json write_recording(std::int64_t last_ns);
  std::string recording_path(std::uint64_t number);
  void forget_recordings();

  Collaborators with_;
  std::map<std::string_view, BoundCommand> handlers_;
  Answering* answering_ = nullptr;
  const std::int64_t started_ns_ = steady_ns();
  std::mutex recordings_mutex_;
  std::deque<std::pair<std::uint64_t, std::string>> recordings_;  // number and path, oldest first
  std::atomic<std::uint64_t> recordings_made_{0};
  std::atomic<bool> replaying_{false};
  std::mutex followed_mutex_;
  std::shared_ptr<std::promise<std::string>> followed_;  // of follow() under way, under followed_mutex_
  std::mutex awaited_mutex_;
  std::vector<std::weak_ptr<AwaitedJob>> awaited_;  // those not yet answered, and some that are
  WorkQueue<SlowJob> slow_jobs_;
  FairQueue<SlowJob> pair_jobs_;
  FairQueue<SlowJob> costly_jobs_;
  GeometryService geometry_;
  UploadReceiver uploads_;
  std::map<std::string, std::string> upload_of_scene_;  // path by scene; used by the world's thread alone
  std::set<std::uint64_t> fence_owners_;                // clients that may have fences; likewise
  ShardWatchers shard_watchers_;
  std::mutex succession_mutex_;
  std::optional<shards::MapSuccession> succession_;  // none: no other map than that of the start is known
  std::vector<CommandAsk> parted_;                   // by a crash: attachments whose parents may still come back
  std::atomic<bool> stopping_{false};
  std::shared_mutex gate_;  // held shared while run() hands a command on; stop() takes it alone once
  std::thread slow_thread_;
  std::thread pair_thread_;
  std::thread costly_thread_;
};

}  // namespace collided::engine::service
