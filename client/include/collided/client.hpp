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

/// The client of a collision server: connect, ask, watch, and change what is there. This header includes what these calls
/// need. Separate are: certificate, containment, diagnosis, fleet, recording, robot, shards, voxels, vcollide.
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
  std::vector<std::string> peers = {};  // addresses of machines to look at where multicast does not reach
  std::chrono::nanoseconds wait{2'000'000'000};  // for a server to answer; one that is found but busy has 10 s at least
  std::string keys = {};  // folder of keys, as `collide keys` makes them, for a server that has some; empty: none

  bool replicas = true;  // questions go to replicas of the server too, where there are some; see AskOptions
  /// No longer than `wait`. Without it a server of this machine is given more time where one is found but busy, or where
  /// the machine has more to do than it can.
  bool wait_is_limit = false;

  /// The options as the command line takes them: COLLIDED_DOMAIN (else ROS_DOMAIN_ID), COLLIDED_NAMESPACE,
  /// COLLIDED_INTERFACE and COLLIDED_KEYS where they are set, the defaults above where not. Error bad_input for an invalid domain.
  ///
  /// variable  returns a variable's value, empty where it is not set; not given: the process's own environment
  static Result<ConnectOptions> from_environment(const std::function<std::string(const char* name)>& variable = {});
};

/// A publisher as the server sees it.
struct PublisherInfo {
  std::string name;                    // as given to Client::publish
  std::uint64_t applied_sequence = 0;  // of its newest message that is applied; Publisher::flush returns such numbers
  std::chrono::nanoseconds silent{0};  // time since its last message
  bool lost = false;                   // it ended, or its lease ran out
};

/// What the server says of itself, twenty times a second. Counts are since its start.
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
  // How long the step under way has lasted: until it ends the server answers about the state before it, and applies
  // nothing. 0: no step takes longer than statuses are apart
  std::chrono::nanoseconds step_lasting{0};
  std::chrono::nanoseconds age{0};  // of this status
};

/// What processes other than the server wrote on the server's topics, so that they seem to be it: a second server on the
/// namespace, or somebody who forges what a server says.
struct Strangers {
  std::uint64_t samples =
      0;                   // replies, events, contacts, probes and statuses of theirs, of which this client took none
  bool speak_now = false;  // the server was heard after one of them: it has not been replaced, there are two
};

namespace client {
class Connection;
class ShardLinks;
}  // namespace client

/// A connection to one server, and to its replicas. When the server is silent, calls fail with disconnected; when it is back or replaced by
/// another one, the connection resumes by itself.
///
/// owner    the caller; a Watch, ProbeWatch or Publisher keeps the connection alive for as long as it needs it
/// threads  several threads may call at once. Destroying it waits until all asynchronous questions are answered
class Client {
 public:
  /// Waits until a server answers a greeting. Else the error no_server says what was seen on the domain.
  static Result<Client> connect(const ConnectOptions& options);
  /// The same with ConnectOptions::from_environment().
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
  /// Asks 1 to 100,000 questions of one kind about one state of the world. Either all are answered or there is an
  /// error.
  ///
  /// questions  a vector, array or span of them
  /// earlier    the answers of an earlier batch: their memory is used again, which saves a third of a ray's time here
  template <std::ranges::contiguous_range Questions>
  requires Question<std::ranges::range_value_t<Questions>> Result<Answers> ask(const Questions& questions,
                                                                               const AskOptions& options = {},
                                                                               Answers&& earlier = {}) {
    return ask_all(std::span<const std::ranges::range_value_t<Questions>>(questions), options, std::move(earlier));
  }
  /// The same on one of the library's four threads. Up to 1,024 calls may wait; more are refused.
  template <Question Q>
  std::future<Result<Answers>> ask_async(std::vector<Q> questions, AskOptions options = {});

  /// The solids that hold a point: ask() with an InsideQuestion.
  Result<Answer> inside(const Vec3& point, const AskOptions& options = {}) {
    return ask(InsideQuestion{.point = point}, options);
  }

  /// The first contact of a shape on each of 1 to 100,000 motions, while everything else stays as it is in one state of
  /// the world. A hit has the contact; a miss means that the motion is free; undecided, that a motion could not be
  /// followed to its end.
  Result<Answers> sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options = {});

  /// How two objects stand to each other: whether they touch, how deep or how far apart, and what the options ask for.
  Result<PairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});
  /// The nearest pairs of two groups of objects, signed: one search over all pairs, on one state.
  ///
  /// from  the first group: an object, a scene or a glob
  Result<ClearanceAnswer> clearance(const std::string& from, const ClearanceOptions& options = {});

  /// Whether each of 1 to 100,000 configurations of some objects is free, and how near it comes to what it is judged
  /// against. All are answered on one state of the world, which stays as it is.
  Result<WhatIfAnswers> what_if(const WhatIfConfigurations& configurations, const WhatIfOptions& options = {});

  // Events and probes.

  /// Subscribes to contact events, for polling with Watch::next.
  Result<Watch> watch(const WatchOptions& options = {});
  /// The same; the callback runs on a thread of the library, one event at a time, until the Watch is destroyed.
  Result<Watch> watch(const WatchOptions& options, std::function<void(const Event&)> callback);

  /// Adds a probe, or replaces the one of that name. The server keeps it until it is removed, even when this client has
  /// gone.
  Result<void> add_probe(const Probe& probe);
  /// Removes probes by name or glob, and returns how many there were.
  Result<std::size_t> remove_probes(const std::string& name);
  /// The readings in the newest state of the probes whose names match the glob; empty: of all.
  Result<std::vector<ProbeReading>> probes(const std::string& name_glob = {});
  /// Subscribes to the readings of probes after every step. `only` and `skip` are matched with the names of probes; of
  /// the other options only `capacity` counts.
  Result<ProbeWatch> watch_probes(const WatchOptions& options = {});

  // Standing questions.

  /// Adds a standing question. One that is not kept goes when this client does.
  Result<AddedStanding> add(const Standing& standing);
  /// Adds many in few messages. If one is refused, none of its message is added; those of earlier messages stay.
  Result<void> add(std::span<const Standing> standing);
  /// Removes standing questions by name or glob, and returns how many there were.
  ///
  /// form  of this form alone; nothing: of all
  Result<std::size_t> remove_standing(const std::string& name, std::optional<StandingForm> form = {});
  /// The standing questions whose names match the glob, and what they hold; empty: all.
  Result<std::vector<ListedStanding>> standing(const std::string& name_glob = {},
                                               std::optional<StandingForm> form = {});
  /// Subscribes to what standing questions report.
  Result<StandingWatch> watch_standing(const StandingWatchOptions& options = {});

  // Why?

  /// Why a ray meets what it meets, and what it passes: candidates, the arithmetic that decided, what a filter left out, what is
  /// in doubt.
  Result<ExplainedRay> explain_ray(const RayQuestion& ray, const ExplainOptions& options = {});
  /// How two objects stand to each other, how near they came, and what keeps their contacts from being told.
  Result<ExplainedPair> explain_pair(const std::string& a, const std::string& b, const ExplainOptions& options = {});
  /// What a region holds or what is nearest, what comes next, and what is left out, by how much and why.
  Result<ExplainedStanding> explain_standing(const std::string& name, const ExplainOptions& options = {});
  /// What is behind an event that was told, while the server remembers it: the last 4,096 of each kind.
  Result<ExplainedEvent> explain_event(std::uint64_t sequence, EventsOf of = EventsOf::contacts,
                                       const ExplainOptions& options = {});

  // What to draw.

  /// What is where, with every shape. A surface that several objects share is fetched once. Where objects come and go
  /// faster than their surfaces are fetched, those that have gone by then are left out.
  ///
  /// earlier  a result for the same options: its surfaces are not fetched again; may be null
  /// limits   one surface (12 million triangles with their edges) or all objects: 512 MiB; more is refused
  Result<ShownObjects> shapes(const ShapesOptions& options = {}, const ShownObjects* earlier = nullptr);
  /// Where everything that moves is, up to 400,000 objects. Up to 3,500 of them come as one message.
  Result<Poses> poses(std::chrono::nanoseconds timeout = std::chrono::seconds(2));

  // Publishing.

  /// Becomes a publisher of objects and their poses. Waits, as long as ConnectOptions::wait, until the server listens.
  Result<Publisher> publish(const std::string& publisher_name, const PublishOptions& options = {});

  // Commands that change the world. What they add stays when this client disconnects, until it is removed; a server that
  // is started again restores it. Error refused if the server refuses, with its reason.

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
  /// progress  called with a fraction in [0, 1], on the calling thread; each call starts the timeout anew
  Result<Loaded> load(const std::string& path, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  /// Loads a file that the server cannot read, from its bytes; see upload().
  Result<Loaded> load(std::span<const std::byte> bytes, std::string_view file_name, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  /// Lets each object of the first glob touch each of the second: their contacts are none, and those that hold end. The last
  /// rule that fits a pair decides.
  ///
  /// because  for whoever reads the rules
  Result<RuleChanged> allow(const std::string& a, const std::string& b, const std::string& because = {},
                            std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Takes such a rule back, and what other rules allow of these two.
  Result<RuleChanged> deny(const std::string& a, const std::string& b,
                           std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Has an object that no publisher has move along with another one, at its place relative to that as it is now, until
  /// it is detached or one of the two is removed. Between two poses of the parent it is swept, and touches what lies there.
  /// Refused for an object of a publisher, one that stands still, a parent that does, and a circle.
  Result<Attached> attach(const std::string& child, const std::string& parent,
                          std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// It stays where it is.
  Result<Attached> detach(const std::string& child, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Removes scenes, moving objects, or both.
  Result<Cleared> clear(const ClearOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  // Commands that say what is there.

  /// The objects in brief.
  Result<ObjectList> list(const ListOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// One object in full.
  Result<ObjectDetails> get(const std::string& name, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// The rules of which pairs may touch, in their order.
  Result<std::vector<ListedRule>> rules(std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// Which structures the server has built for what it holds, which it has left out, and why.
  Result<Plan> plan(std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  // Commands as JSON.

  /// Sends any command, also one that has no call of its own above. The arguments are a JSON object, and so is the
  /// answer except for the commands of viewers; idl/commands.hpp of the sources describes both.
  ///
  /// shape     for commands that take one, such as add
  /// progress  called with a fraction in [0, 1], on the calling thread; each call starts the timeout anew
  Result<std::string> command(std::string_view name, std::string_view json_arguments, const Shape& shape = {},
                              std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                              std::function<void(double)> progress = {});

  /// The same for commands that take bytes other than a shape; idl/commands.hpp says which do.
  Result<std::string> command_with_bytes(std::string_view name, std::string_view json_arguments,
                                         std::span<const std::byte> bytes,
                                         std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  /// Sends the bytes of a file that the server cannot read itself, up to 1 GiB, and has them loaded as a scene. The
  /// server reads them in a process that may do nothing else. Other files that the file names are not sent.
  ///
  /// file_name       letters, digits, dots, dashes and underscores, with the ending that tells the format
  /// json_arguments  those of the command load; the answer is its answer
  /// timeout         for each message
  /// progress        called with a fraction in [0, 1], on the calling thread: up to a half while sending, then while
  ///                 the server reads
  Result<std::string> upload(std::span<const std::byte> bytes, std::string_view file_name,
                             std::string_view json_arguments = {},
                             std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                             std::function<void(double)> progress = {});

  // About the server.

  /// The newest status heard. Right after connecting it waits for the first one, up to 240 ms.
  Result<ServerStatus> status();
  /// Whether others speak in the server's place, as far as this connection has heard. Waits for nothing.
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
