#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <collided/clearance.hpp>
#include <collided/commands.hpp>
#include <collided/events.hpp>
#include <collided/explanations.hpp>
#include <collided/pair.hpp>
#include <collided/probes.hpp>
#include <collided/publisher.hpp>
#include <collided/questions.hpp>
#include <collided/result.hpp>
#include <collided/shown_objects.hpp>
#include <collided/standing.hpp>
#include <collided/what_if.hpp>

/// The client of a collision server: connect, ask, watch, and change the world. This header includes all that these
/// calls need. Separate headers: certificate, containment, diagnosis, fleet, recording, robot, shards, voxels,
/// vcollide.
///
/// units    metres, seconds, right-handed frames; quaternions w first; times as std::chrono::nanoseconds
/// errors   calls return a Result and throw no exceptions of their own
/// threads  every class may be used from any thread, by one call at a time per object unless it says otherwise
#pragma GCC visibility push(default)

namespace collided {

/// Where to look for a server.
struct ConnectOptions {
  int domain = 0;                       // DDS domain, 0 to 230
  std::string name_space = "collided";  // of one server; several may share a domain
  std::string interface = "lo";         // network interface; "auto": DDS chooses, so other machines are reached
  std::vector<std::string> peers = {};  // addresses of machines that multicast does not reach
  std::chrono::nanoseconds wait{2'000'000'000};  // for a server to answer; a busy one gets 10 s at least
  std::string keys = {};  // folder of keys made by `collide keys`, if the server uses keys; empty: none
  /// For shard maps at etcds://: a folder with ca.crt, tls.crt and tls.key, username and password; each pair may be missing.
  std::string etcd_keys = {};

  bool replicas = true;  // send questions to replicas of the server too; see AskOptions
  /// Never wait longer than `wait`. Otherwise a server on this machine gets more time if it is busy or the machine is
  /// overloaded.
  bool wait_is_limit = false;

  /// Reads the options as the command line does, from COLLIDED_DOMAIN (else ROS_DOMAIN_ID), COLLIDED_NAMESPACE,
  /// COLLIDED_INTERFACE, COLLIDED_KEYS and COLLIDED_ETCD_KEYS. Variables that are not set leave the defaults above. Error
  /// bad_input for an invalid domain.
  ///
  /// variable  returns a variable's value, empty if it is not set; by default it reads the process's environment
  static Result<ConnectOptions> from_environment(const std::function<std::string(const char* name)>& variable = {});
};

/// A publisher as the server sees it.
struct PublisherInfo {
  std::string name;                    // as given to Client::publish
  std::uint64_t applied_sequence = 0;  // of its newest message that is applied; Publisher::flush returns such numbers
  std::chrono::nanoseconds silent{0};  // time since its last message
  bool lost = false;                   // it ended, or its lease ran out
};

/// The server's status, published twenty times a second. Counts are since its start.
struct ServerStatus {
  std::string name_space;                  // that it serves
  std::string version_text;                // of the server program, "0.2.0"
  std::uint32_t pid = 0;                   // of its process
  std::string state;                       // starting, recovering, ready, stopping
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t version = 0;               // of the newest state; grows with each change of the world
  std::chrono::nanoseconds world_time{0};  // of that state, since 1970, by the publishers' clocks
  std::uint64_t last_event_sequence = 0;   // Event::sequence
  std::uint32_t contacts = 0;              // that hold now
  bool contacts_truncated = false;         // there are more contacts than the server's limit (its max_contacts)
  std::vector<std::string> scenes;         // names of those loaded
  std::uint64_t static_triangles = 0;      // of the meshes of all scenes
  std::uint32_t objects = 0;               // in the world, with the parts of scenes
  std::uint32_t moving = 0;                // of the objects
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_dropped = 0;  // malformed, or from more publishers at a time than the server takes
  std::uint64_t questions_answered = 0;
  std::uint64_t questions_refused = 0;
  std::uint64_t undecided_answers = 0;    // of the answers
  std::vector<PublisherInfo> publishers;  // that it knows
  // Duration so far of the running step. Until the step ends, the server answers about the state before it and applies
  // nothing. 0: no step takes longer than the interval between statuses
  std::chrono::nanoseconds step_lasting{0};
  std::chrono::nanoseconds age{0};  // of this status
};

/// Messages on the server's topics from other processes, which pose as the server: a second server on the namespace, or
/// a process that forges its messages.
struct Strangers {
  std::uint64_t samples = 0;  // their replies, events, contacts, probes and statuses, all ignored by this client
  bool speak_now = false;     // a message of the server came after one of theirs: there are two, it was not replaced
};

namespace client {
class Connection;
class ShardLinks;
}  // namespace client

/// A connection to one server and its replicas. While the server is silent, calls fail with disconnected. When it is
/// back or has been replaced, the connection resumes by itself.
///
/// owner    the caller; a Watch, ProbeWatch or Publisher keeps the connection open as long as it needs it
/// threads  several threads may call at once. Destroying it waits until all asynchronous questions are answered
class Client {
 public:
  /// Waits until a server answers a greeting. If none does, the error no_server describes what was seen on the domain.
  static Result<Client> connect(const ConnectOptions& options);
  /// Connects with ConnectOptions::from_environment().
  static Result<Client> connect();
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  // Questions.

  /// Asks one question.
  template <Question Q>
  Result<Answer> ask(const Q& question, const AskOptions& options = {}) {
    Result<Answers> answers = ask_all(std::span<const Q>(&question, 1), options, {});
    if (!answers) return answers.error();
    return std::move(answers->answers.front());
  }
  /// Asks 1 to 100,000 questions of one kind about one state of the world. Either all are answered, or the call returns
  /// an error.
  ///
  /// questions  a vector, array or span of them
  /// earlier    the answers of an earlier batch, whose memory is reused; that saves a third of a ray's time in the
  ///            client
  template <std::ranges::contiguous_range Questions>
  requires Question<std::ranges::range_value_t<Questions>> Result<Answers> ask(const Questions& questions,
                                                                               const AskOptions& options = {},
                                                                               Answers&& earlier = {}) {
    return ask_all(std::span<const std::ranges::range_value_t<Questions>>(questions), options, std::move(earlier));
  }
  /// Asks on one of the library's four threads. Up to 1,024 calls may wait; more are refused.
  template <Question Q>
  std::future<Result<Answers>> ask_async(std::vector<Q> questions, AskOptions options = {});

  /// Finds the solids that contain a point: ask() with an InsideQuestion.
  Result<Answer> inside(const Vec3& point, const AskOptions& options = {}) {
    return ask(InsideQuestion{.point = point}, options);
  }

  /// Finds the first contact of a shape on each of 1 to 100,000 motions, with everything else at rest in one state of
  /// the world. A hit has the contact; a miss means that the motion is free; undecided means that the motion could not
  /// be followed to its end.
  Result<Answers> sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options = {});

  /// Compares two objects: whether they touch, how deep or how far apart, and what the options ask for.
  Result<PairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});
  /// Finds the nearest pairs of two groups of objects, with signed distances, in one search over all pairs of one
  /// state.
  ///
  /// from  the first group: an object, a scene or a glob
  Result<ClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options = {});

  /// Tests whether each of 1 to 100,000 configurations of some objects is free, and how near it comes to the objects it
  /// is tested against. All answers refer to one state of the world, which does not change.
  Result<WhatIfAnswers> what_if(const WhatIfConfigurations& configurations, const WhatIfOptions& options = {});

  // Events and probes.

  /// Subscribes to contact events, for polling with Watch::next.
  Result<Watch> watch(const WatchOptions& options = {});
  /// Subscribes with a callback. It runs on a thread of the library, one event at a time, until the Watch is destroyed.
  Result<Watch> watch(const WatchOptions& options, std::function<void(const Event&)> callback);

  /// Adds a probe, or replaces the one of that name. The server keeps it until it is removed, even after this client
  /// disconnects.
  Result<void> add_probe(const Probe& probe);
  /// Removes probes by name or glob, and returns how many there were.
  Result<std::size_t> remove_probes(const std::string& name);
  /// Returns the readings, in the newest state, of the probes whose names match the glob; empty: of all probes.
  Result<std::vector<ProbeReading>> probes(const std::string& name_glob = {});
  /// Subscribes to the readings of probes after every step. `only` and `skip` match names of probes; `capacity` is the
  /// only other option used.
  Result<ProbeWatch> watch_probes(const WatchOptions& options = {});

  // Standing questions.

  /// Adds a standing question. Unless Standing::keep is set, the server removes it when this client disconnects.
  Result<AddedStanding> add(const Standing& standing);
  /// Adds many standing questions in few messages. If one is refused, no question of its message is added; those of
  /// earlier messages stay.
  Result<void> add(std::span<const Standing> standing);
  /// Removes standing questions by name or glob, and returns how many there were.
  ///
  /// form  remove only this form; nothing: all forms
  Result<std::size_t> remove_standing(const std::string& name, std::optional<StandingForm> form = {});
  /// Returns the standing questions whose names match the glob, with their current answers; empty: all.
  Result<std::vector<ListedStanding>> standing(const std::string& name_glob = {},
                                               std::optional<StandingForm> form = {});
  /// Subscribes to the events of standing questions.
  Result<StandingWatch> watch_standing(const StandingWatchOptions& options = {});

  // Why?

  /// Explains what a ray hits and what it passes: candidates, the arithmetic that decided, objects that a filter left
  /// out, and doubts.
  Result<ExplainedRay> explain_ray(const RayQuestion& ray, const ExplainOptions& options = {});
  /// Explains whether two objects touch, how near they came, and what prevents reports of their contacts.
  Result<ExplainedPair> explain_pair(const std::string& a, const std::string& b, const ExplainOptions& options = {});
  /// Explains a region's objects or the nearest one, the runners-up, and what is left out, by how much and why.
  Result<ExplainedStanding> explain_standing(const std::string& name, const ExplainOptions& options = {});
  /// Explains a reported event, as long as the server remembers it: the last 4,096 of each kind.
  Result<ExplainedEvent> explain_event(std::uint64_t sequence, EventsOf of = EventsOf::contacts,
                                       const ExplainOptions& options = {});

  // What to draw.

  /// Returns all objects with their shapes and poses. A surface that several objects share is fetched once. Objects
  /// that are removed before their surfaces are fetched are left out.
  ///
  /// earlier  an earlier result for the same options, whose surfaces are not fetched again; may be null
  /// limits   one surface (12 million triangles with their edges) or all objects: 512 MiB; more is refused
  Result<ShownObjects> shapes(const ShapesOptions& options = {}, const ShownObjects* earlier = nullptr);
  /// Returns the poses of all moving objects, at most 400,000. Up to 3,500 of them come in one message.
  Result<Poses> poses(std::chrono::nanoseconds timeout = std::chrono::seconds(2));

  // Publishing.

  /// Creates a publisher of objects and their poses. Waits, for at most ConnectOptions::wait, until the server receives
  /// from it.
  Result<Publisher> publish(const std::string& publisher_name, const PublishOptions& options = {});

  // Commands that change the world. Added objects and rules stay when this client disconnects, until they are removed;
  // a restarted server restores them. Error refused, with the server's reason, if it refuses.

  /// Adds an object without a publisher. Its name must be free in the world.
  Result<Added> add(const ObjectOptions& object, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Moves an object that has no living publisher. Contacts on the path count, unless it is teleported.
  Result<Moved> move(const std::string& name, const Pose& pose, bool teleport = false,
                     std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Removes objects by name or glob. Objects of a living publisher are refused.
  Result<Removed> remove(const std::string& name, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Loads a file that the server can read, as a scene.
  ///
  /// path      on the server's machine
  /// progress  called with a fraction in [0, 1], on the calling thread; each call restarts the timeout
  Result<Loaded> load(const std::string& path, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  /// Loads a file that the server cannot read, from its bytes; see upload().
  Result<Loaded> load(std::span<const std::byte> bytes, std::string_view file_name, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  /// Allows each object of the first glob to touch each of the second. Their contacts are no longer reported, and open
  /// ones end. The last rule that matches a pair decides.
  ///
  /// because  a remark that is listed with the rule
  Result<RuleChanged> allow(const std::string& a, const std::string& b, const std::string& because = {},
                            std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Removes such a rule, and what other rules allow for these two.
  Result<RuleChanged> deny(const std::string& a, const std::string& b,
                           std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Attaches an object without a publisher to another one: it moves along at its current relative pose, until it is
  /// detached or one of the two is removed. Between two poses of the parent it is swept, and its contacts on the way
  /// count. Refused if the object has a publisher, if the object or the parent is static, and for a cycle.
  Result<Attached> attach(const std::string& child, const std::string& parent,
                          std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Detaches an object, which stays where it is.
  Result<Attached> detach(const std::string& child, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Removes scenes, moving objects, or both.
  Result<Cleared> clear(const ClearOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  // Commands that list what is in the world.

  /// Returns the objects in brief.
  Result<ObjectList> list(const ListOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Returns one object in full.
  Result<ObjectDetails> get(const std::string& name, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Returns the rules about which pairs may touch, in order.
  Result<std::vector<ListedRule>> rules(std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Returns which index structures the server has built for its world, which it has left out, and why.
  Result<Plan> plan(std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  // Commands as JSON.

  /// Sends any command, also one without a function of its own above. Arguments and answer are JSON objects, except
  /// that the commands of viewers answer with bytes; idl/commands.hpp of the sources describes them.
  ///
  /// shape     for commands that take one, such as add
  /// progress  called with a fraction in [0, 1], on the calling thread; each call restarts the timeout
  Result<std::string> command(std::string_view name, std::string_view json_arguments, const Shape& shape = {},
                              std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                              std::function<void(double)> progress = {});

  /// Sends a command that takes bytes other than a shape; idl/commands.hpp lists them.
  Result<std::string> command_with_bytes(std::string_view name, std::string_view json_arguments,
                                         std::span<const std::byte> bytes,
                                         std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  /// Sends the bytes of a file that the server cannot read itself, up to 1 GiB, and loads them as a scene. The server
  /// parses them in a sandboxed process. Other files that the file refers to are not sent.
  ///
  /// file_name       letters, digits, dots, dashes and underscores; its extension selects the format
  /// json_arguments  those of the command load; the answer is that of load
  /// timeout         for each message
  /// progress        called with a fraction in [0, 1], on the calling thread: up to a half while sending, then while
  ///                 the server reads
  Result<std::string> upload(std::span<const std::byte> bytes, std::string_view file_name,
                             std::string_view json_arguments = {},
                             std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                             std::function<void(double)> progress = {});

  // About the server.

  /// Returns the newest status received. Right after connecting it waits for the first one, up to 240 ms.
  Result<ServerStatus> status();
  /// Returns what this connection has received from processes that pose as the server. Does not wait.
  Strangers strangers() const;

 private:
  struct State;
  friend class Recording;
  friend class client::ShardLinks;
  explicit Client(std::unique_ptr<State> state);
  static Client over(std::shared_ptr<client::Connection> connection);
  template <Question Q>
  Result<Answers> ask_all(std::span<const Q> questions, const AskOptions& options, Answers&& earlier);
  std::unique_ptr<State> state_;
};

/// The version of this library, such as "0.2.0".
std::string_view library_version();

}  // namespace collided

#pragma GCC visibility pop
