#pragma once

#include <chrono>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <ranges>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <collided/commands.hpp>
#include <collided/events.hpp>
#include <collided/pair.hpp>
#include <collided/probes.hpp>
#include <collided/publisher.hpp>
#include <collided/questions.hpp>
#include <collided/result.hpp>
#include <collided/shown_objects.hpp>

/// The client of a collision server: connect, ask, watch, and change what is there. Metres, seconds, right-handed;
/// quaternions w first. This header includes all the others.
/// Threads: every class here may be used from any thread, one call at a time per object unless said otherwise.
#pragma GCC visibility push(default)

namespace collided {

struct ConnectOptions {
  int domain = 0;  // 0 to 230
  std::string name_space = "collided";
  std::string interface = "lo";  // "auto" opens it to the network
  std::vector<std::string> peers = {};
  std::chrono::nanoseconds wait{2'000'000'000};  // for a server to answer

  /// As the command line has it: COLLIDED_DOMAIN (else ROS_DOMAIN_ID), COLLIDED_NAMESPACE, COLLIDED_INTERFACE where they are
  /// set, the above where not. Error bad_input for a domain that is none.
  /// variable  what a variable says, empty where it is not set; none: the process's own environment
  static Result<ConnectOptions> from_environment(const std::function<std::string(const char* name)>& variable = {});
};

struct PublisherInfo {
  std::string name;
  std::uint64_t applied_sequence = 0;
  std::chrono::nanoseconds silent{0};
  bool lost = false;
};

struct ServerStatus {
  std::string name_space;
  std::string version_text;
  std::uint32_t pid = 0;
  std::string state;  // starting, recovering, ready, stopping
  std::uint64_t epoch = 0;
  std::uint64_t version = 0;
  std::chrono::nanoseconds world_time{0};
  std::uint64_t last_event_sequence = 0;
  std::uint32_t contacts = 0;
  bool contacts_truncated = false;  // there are more than the server may tell (its max_contacts)
  std::vector<std::string> scenes;
  std::uint64_t static_triangles = 0;
  std::uint32_t objects = 0;
  std::uint32_t moving = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_dropped = 0;
  std::uint64_t questions_answered = 0;
  std::uint64_t questions_refused = 0;
  std::uint64_t undecided_answers = 0;
  std::vector<PublisherInfo> publishers;
  std::chrono::nanoseconds age{0};  // of this status
};

/// A connection to one server. Calls may come from several threads at once.
class Client {
 public:
  /// Waits until a server answers hello; Error no_server otherwise, with what was seen on the domain.
  static Result<Client> connect(const ConnectOptions& options);
  /// To where the environment says.
  static Result<Client> connect();
  ~Client();
  Client(Client&&) noexcept;
  Client& operator=(Client&&) noexcept;

  template <Question Q>
  Result<Answer> ask(const Q& question, const AskOptions& options = {}) {
    Result<Answers> answers = ask_all(std::span<const Q>(&question, 1), options, {});
    if (!answers) return answers.error();
    return std::move(answers->answers.front());
  }
  /// Up to 100,000 questions of one kind on one state of the world.
  /// questions  a vector, array or span of them
  /// earlier    answers of a batch before lend their memory, which saves a third of what a batch of rays costs here
  template <std::ranges::contiguous_range Questions>
  requires Question<std::ranges::range_value_t<Questions>> Result<Answers> ask(const Questions& questions,
                                                                               const AskOptions& options = {},
                                                                               Answers&& earlier = {}) {
    return ask_all(std::span<const std::ranges::range_value_t<Questions>>(questions), options, std::move(earlier));
  }
  /// The same on a thread of the library; 1,024 may wait.
  template <Question Q>
  std::future<Result<Answers>> ask_async(std::vector<Q> questions, AskOptions options = {});

  /// The first contact of a shape on each of up to 100,000 ways, with everything as it is in one state of the world: a hit
  /// in the answer; a miss: the way is free. undecided: what is met could not be followed to the end of the way.
  Result<Answers> sweep(const Shape& shape, std::span<const SweepQuestion> motions, const AskOptions& options = {});

  /// Two objects by name: touching and how deep, or apart and how far; the rest as the options ask for it.
  Result<PairAnswer> pair(const std::string& a, const std::string& b, const PairOptions& options = {});

  /// Poll with Watch::next.
  Result<Watch> watch(const WatchOptions& options = {});
  /// Calls back from a thread of the library until the Watch is destroyed.
  Result<Watch> watch(const WatchOptions& options, std::function<void(const Event&)> callback);

  /// Replaces a probe of that name. The server keeps it until it is removed, whoever comes and goes.
  Result<void> add_probe(const Probe& probe);
  /// By name or glob; how many there were.
  Result<std::size_t> remove_probes(const std::string& name);
  /// Every probe's reading in the newest state.
  Result<std::vector<ProbeReading>> probes(const std::string& name_glob = {});
  Result<ProbeWatch> watch_probes(const WatchOptions& options = {});

  /// What is where, with every shape: for whoever draws. A surface that many share comes once. Where objects come and go
  /// faster than their surfaces are fetched, those that have gone by then are left out.
  ///
  /// earlier  what the same options gave before: its surfaces are not fetched again; may be null
  /// limits   512 MiB of one surface (12 M triangles with their edges) or of all objects; beyond them it is refused
  Result<ShownObjects> shapes(const ShapesOptions& options = {}, const ShownObjects* earlier = nullptr);
  /// Up to 400,000 objects; one message for 3,500 of them and less.
  Result<Poses> poses(std::chrono::nanoseconds timeout = std::chrono::seconds(2));

  Result<Publisher> publish(const std::string& publisher_name);

  // What stays until it is removed, whoever comes and goes. After a crash the server has it again.

  /// Objects with no publisher. The name must be free.
  Result<Added> add(const ObjectOptions& object, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// An object of no living publisher; contacts are those of its way, unless it is teleported.
  Result<Moved> move(const std::string& name, const Pose& pose, bool teleport = false,
                     std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// By name or glob; refused for objects of a living publisher.
  Result<Removed> remove(const std::string& name, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// A file that the server can read.
  /// progress  is called with a fraction in [0, 1] from the calling thread; each call starts the timeout anew
  Result<Loaded> load(const std::string& path, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  /// The bytes of a file that it cannot, as upload() sends them.
  Result<Loaded> load(std::span<const std::byte> bytes, std::string_view file_name, const LoadOptions& options = {},
                      std::function<void(double)> progress = {});
  Result<Cleared> clear(const ClearOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  // What is there.

  Result<ObjectList> list(const ListOptions& options = {}, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  Result<ObjectDetails> get(const std::string& name, std::chrono::nanoseconds timeout = std::chrono::seconds(10));
  /// What this server has built for what it holds, what it has left out, and why.
  Result<Plan> plan(std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  /// The door behind the calls above, and for commands that have none: JSON in, JSON out. Arguments and answers stand in
  /// idl/commands.hpp of the sources.
  /// progress is called with a fraction in [0, 1] from the calling thread; each call starts the timeout anew.
  Result<std::string> command(std::string_view name, std::string_view json_arguments, const Shape& shape = {},
                              std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                              std::function<void(double)> progress = {});

  /// The same for commands that take other bytes than a shape; idl/commands.hpp says which.
  Result<std::string> command_with_bytes(std::string_view name, std::string_view json_arguments,
                                         std::span<const std::byte> bytes,
                                         std::chrono::nanoseconds timeout = std::chrono::seconds(10));

  /// Sends a file's bytes, for a server that cannot read the file itself, and has them loaded as a scene: the server reads
  /// them in a process that may do nothing else. file_name: letters, digits, dot, dash and underscore, with the ending that says
  /// the format; json_arguments and the answer: those of the command load. A file that names other files comes without them.
  /// progress is called with a fraction in [0, 1]: of what is sent up to a half, then of what is read; the timeout is for each
  /// step of it. Up to 1 GiB.
  Result<std::string> upload(std::span<const std::byte> bytes, std::string_view file_name,
                             std::string_view json_arguments = {},
                             std::chrono::nanoseconds timeout = std::chrono::seconds(10),
                             std::function<void(double)> progress = {});

  /// The newest status heard.
  Result<ServerStatus> status();

 private:
  struct State;
  explicit Client(std::unique_ptr<State> state);
  template <Question Q>
  Result<Answers> ask_all(std::span<const Q> questions, const AskOptions& options, Answers&& earlier);
  std::unique_ptr<State> state_;
};

/// "0.2.0"
std::string_view library_version();

}  // namespace collided

#pragma GCC visibility pop
