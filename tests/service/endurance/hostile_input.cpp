// Everything that comes from outside, wrong in every way: definitions, shapes, poses, questions and commands at the
// engine's border, then samples over DDS and packets of RTPS junk at a running server:
//   hostile_input SERVER INPUTS
// Prints one line and the seed; exits 1 where something crashed, got past the border without being a number, or took long.

#include <arpa/inet.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <random>
#include <string>
#include <string_view>

#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/commands/command_arguments.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/ask.hpp"
#include "server/world/objects/indexed_mesh.hpp"
#include "server/world/query/query.hpp"
#include "tests/oracle/seed.hpp"
#include "tests/scenes/meshes.hpp"
#include "tests/service/child_process.hpp"
#include "tests/service/server_wire_asker.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided::testing_support {
using namespace engine;
namespace {

using namespace std::chrono_literals;
using service::DefinitionSample;
using service::PoseSample;
using wire_contract::QuestionKind;

constexpr double kMostCall_us = 10'000;
/// A step looks at all that has moved; longer than this, and the server would be taken for dead.
constexpr double kMostStep_us = 1e-3 * wire_contract::kStatusLostNs;

/// What the process of its own came to; shared with who started it, since it may crash.
struct Result {
  std::uint64_t inputs = 0;
  std::uint64_t not_finite = 0;
  double longest_us = 0;
  std::string longest_kind;
  double longest_step_us = 0;
};

/// Processor time of this thread: a busy machine is nobody's input.
double thread_us() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Numbers and bytes that somebody might not have thought of.
class Malice {
 public:
  explicit Malice(std::uint64_t seed) : random_(seed) {}

  std::uint64_t below(std::uint64_t limit) { return random_() % limit; }
  bool chance(double probability) { return std::bernoulli_distribution(probability)(random_); }
  double number() {
    static const double kOdd[] = {0,
                                  -0.0,
                                  1,
                                  -1,
                                  5e-324,
                                  -2.2250738585072014e-308,
                                  1e-300,
                                  1e300,
                                  1.7976931348623157e308,
                                  -1e308,
                                  std::numeric_limits<double>::infinity(),
                                  -std::numeric_limits<double>::infinity(),
                                  std::numeric_limits<double>::quiet_NaN(),
                                  1e-9,
                                  1 + 1e-7,
                                  4503599627370497.5};
    if (chance(0.3)) return kOdd[below(std::size(kOdd))];
    if (chance(0.1)) return std::bit_cast<double>(random_());
    return std::uniform_real_distribution<double>(-3, 3)(random_);
  }
  /// Mostly a pose.
  void fill_pose(double* numbers) {
    for (int i = 0; i < 3; ++i)
      numbers[i] = chance(0.1) ? number() : std::uniform_real_distribution<double>(-3, 3)(random_);
    const Quat turn = Quat(normal_(random_), normal_(random_), normal_(random_), normal_(random_)).normalized();
    const double q[] = {turn.w(), turn.x(), turn.y(), turn.z()};
    for (int i = 0; i < 4; ++i) numbers[3 + i] = chance(0.05) ? number() : q[i];
  }
  std::string name() {
    if (chance(0.7)) return "object " + std::to_string(below(20));
    std::string text(below(300), 'x');
    for (char& letter : text) letter = static_cast<char>(below(256));
    return text;
  }
  void spoil(std::vector<std::uint8_t>& bytes) {
    for (std::uint64_t i = below(6); i > 0 && !bytes.empty(); --i) {
      const std::size_t at = below(bytes.size());
      switch (below(4)) {
        case 0: bytes[at] = static_cast<std::uint8_t>(below(256)); break;
        case 1: bytes[at] = static_cast<std::uint8_t>(bytes[at] ^ (1U << below(8))); break;
        case 2: bytes.resize(at); break;
        default: {
          const double odd = number();
          if (bytes.size() >= 8) std::memcpy(bytes.data() + std::min(at / 8 * 8, bytes.size() - 8), &odd, 8);
        }
      }
    }
  }
  std::vector<std::uint8_t> shape() {
    Shape shape;
    switch (below(5)) {
      case 0: shape.primitives.emplace_back(Box{.center = {0, 0, 0}, .half_m = {0.5, 0.2, 0.1}}); break;
      case 1: shape.primitives.emplace_back(Capsule{{0, 0, 0}, {1, 0, 0}, 0.2}); break;
      case 2: shape.mesh = std::make_shared<const TriangleMesh>(scenes::icosphere(1, 0.5)); break;
      case 3: shape.primitives.emplace_back(Cylinder{.a = {0, 0, 0}, .b = {0, 0, 1}, .radius_m = 0.3}); [[fallthrough]];
      default: shape.primitives.emplace_back(Sphere{{0, 0, 0}, 0.5});
    }
    const std::vector<std::byte> encoded = encode_shape(shape);
    std::vector<std::uint8_t> bytes(encoded.size());
    std::memcpy(bytes.data(), encoded.data(), encoded.size());
    if (chance(0.5)) spoil(bytes);
    return bytes;
  }
  std::vector<std::uint8_t> junk(std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(below(256));
    return bytes;
  }
  std::uint64_t any_bits() { return random_(); }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

// ---- at the border, in a process of its own

class Border {
 public:
  Border(std::uint64_t seed, Result& result) : malice_(seed), result_(result) {
    Scene scene = embedded_scene();
    const auto indexed = World::index_scene(scene, {.threads = 1, .progress = {}, .cancelled = {}});
    static_cast<void>(world_.add_scene(indexed));
    step();
  }

  void one() {
    ++result_.inputs;
    switch (malice_.below(5)) {
      case 0: return define();
      case 1:
      case 2: return move();
      case 3: return ask();
      default: return command();
    }
  }

 private:
  template <class Call>
  void timed(std::string_view kind, Call&& call) {
    const double before = thread_us();
    call();
    const double took = thread_us() - before;
    if (took > result_.longest_us) result_.longest_us = took, result_.longest_kind = kind;
  }
  void step() {
    time_ns_ += 1'000'000;
    const double before = thread_us();
    static_cast<void>(world_.step(time_ns_, 1, {.contacts = true, .persisted = true}));
    result_.longest_step_us = std::max(result_.longest_step_us, thread_us() - before);
    publishers_.stepped();
    const SnapshotRing::Lease state = world_.newest();
    for (std::size_t slot = 0; slot < state->poses.size(); ++slot) {
      const Pose& pose = state->poses[slot];
      const bool is_pose = pose.position.allFinite() && std::abs(pose.rotation.norm() - 1) < 1e-12;
      const bool is_used = slot < state->objects.size() && state->objects[slot];
      result_.not_finite += is_used && !is_pose ? 1 : 0;
    }
  }
  template <class Offer>
  void apply(const char* kind, Offer&& offer) {
    service::Applied applied = service::Applied::done;
    do {
      timed(kind, [&] { applied = offer(); });
      if (applied == service::Applied::step_first) step();
    } while (applied == service::Applied::step_first);
    if (malice_.chance(0.05)) step();
    publishers_.take_notices();
  }
  void define() {
    DefinitionSample sample;
    sample.publisher = malice_.below(4);
    sample.object_number = malice_.chance(0.9) ? static_cast<std::uint32_t>(malice_.below(12))
                                               : static_cast<std::uint32_t>(malice_.any_bits());
    sample.incarnation = 1 + (malice_.chance(0.01) ? malice_.below(3) : 0);
    sample.sequence = malice_.chance(0.95) ? ++sequence_ : malice_.any_bits() >> malice_.below(64);
    sample.removed = malice_.chance(0.2);
    sample.moving = malice_.chance(0.9);
    sample.lost_policy = static_cast<std::uint8_t>(malice_.below(5));
    sample.name = malice_.name();
    sample.publisher_name = malice_.name();
    malice_.fill_pose(sample.pose.data());
    timed("decode", [&] {
      const std::vector<std::uint8_t> bytes = malice_.shape();
      DecodedShape decoded = decode_shape(std::as_bytes(std::span(bytes)));
      if (decoded.shape) {
        sample.shape = std::move(*decoded.shape);
      } else {
        sample.shape = Refusal{std::move(decoded.refusal)};
      }
    });
    apply("define", [&] { return publishers_.define(sample, time_ns_); });
  }
  void move() {
    PoseSample sample;
    sample.publisher = malice_.below(4);
    sample.incarnation = 1 + (malice_.chance(0.01) ? malice_.below(3) : 0);
    sample.sequence = malice_.chance(0.95) ? ++sequence_ : malice_.any_bits() >> malice_.below(64);
    sample.definitions_through = malice_.chance(0.95) ? 0 : malice_.any_bits() >> malice_.below(64);
    sample.source_time_ns = malice_.chance(0.5) ? time_ns_ : static_cast<std::int64_t>(malice_.any_bits());
    sample.received_ns = time_ns_;
    sample.flags = static_cast<std::uint8_t>(malice_.chance(0.9) ? 0 : malice_.below(256));
    for (std::uint64_t i = malice_.below(5); i > 0; --i)
      sample.object_numbers.push_back(static_cast<std::uint32_t>(malice_.below(14)));
    sample.poses.resize(7 * sample.object_numbers.size());
    for (std::size_t i = 0; i < sample.object_numbers.size(); ++i) malice_.fill_pose(&sample.poses[7 * i]);
    if (malice_.chance(0.05)) sample.poses.resize(malice_.below(20), 1.0);
    if (malice_.chance(0.05)) sample.velocities.resize(malice_.below(20), malice_.number());
    apply("move", [&] { return publishers_.move(sample, time_ns_); });
  }
  void ask() {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(malice_.below(9));
    query->mode = static_cast<std::uint8_t>(malice_.chance(0.9) ? malice_.below(3) : malice_.below(256));
    query->importance = static_cast<std::uint8_t>(malice_.chance(0.9) ? malice_.below(3) : malice_.below(256));
    query->instant = static_cast<std::uint8_t>(malice_.chance(0.9) ? 0 : malice_.below(256));
    query->instant_ns = malice_.chance(0.9) ? 0 : static_cast<std::int64_t>(malice_.any_bits());
    query->mask = malice_.chance(0.9) ? 0xffffffff : static_cast<std::uint32_t>(malice_.any_bits());
    query->max_hits = malice_.chance(0.9) ? 100 : static_cast<std::uint32_t>(malice_.any_bits());
    query->chunk_count = malice_.chance(0.95) ? 1 : static_cast<std::uint32_t>(malice_.any_bits());
    query->chunk_index = malice_.chance(0.95) ? 0 : static_cast<std::uint32_t>(malice_.any_bits());
    query->first_question = malice_.chance(0.95) ? 0 : static_cast<std::uint32_t>(malice_.any_bits());
    query->error_asked = malice_.chance(0.9) ? 0 : malice_.number();
    query->deadline_ns = malice_.chance(0.95) ? 0 : static_cast<std::int64_t>(malice_.any_bits());
    static_cast<void>(dds::set_text(query->only, malice_.chance(0.9) ? "" : malice_.name()));
    const std::uint32_t stride = wire_contract::numbers_of(static_cast<QuestionKind>(query->kind));
    std::vector<double> numbers(malice_.chance(0.9) ? stride : malice_.below(30));
    for (double& number : numbers) number = malice_.number();
    test::put_questions(*query, numbers);
    if (malice_.chance(0.1)) dds::borrow(malice_.chance(0.5) ? query->radii : query->directions, numbers);
    std::optional<std::string> refusal;
    timed("check", [&] { refusal = service::why_refused(*query); });
    if (refusal || stride == 0 || numbers.size() != stride) return;
    const ObjectInfo mover = without_world(Shape{{Sphere{{0, 0, 0}, 0.3}}, nullptr});
    const Questions questions{.kind = static_cast<QuestionKind>(query->kind),
                              .mode = static_cast<HitMode>(query->mode),
                              .mask = query->mask,
                              .max_hits = query->max_hits,
                              .only = query->only,
                              .error_m = query->error_asked,
                              .numbers = numbers,
                              .mover = &mover};
    const SnapshotRing::Lease state = world_.newest();
    timed(name_of(questions.kind), [&] { answer(*state, questions, answers_, scratch_); });
    for (const AnswerHit& hit : answers_.hits) {
      const bool is_told =
          !std::isnan(hit.distance_m) && !std::isnan(hit.error_m) && !hit.point.hasNaN() && !hit.normal.hasNaN();
      result_.not_finite += is_told ? 0 : 1;
    }
  }
  void command() {
    std::string text = R"({"command":"add","name":"x","pose":[0,0,0,1,0,0,0],"layers":1,"moving":true})";
    for (std::uint64_t i = malice_.below(8); i > 0; --i)
      text[malice_.below(text.size())] = static_cast<char>(malice_.below(256));
    if (malice_.chance(0.05)) text = std::string(malice_.below(3'000), '[');
    timed("command", [&] {
      try {
        const service::Arguments arguments(text, *wire_contract::command::find_command("add"));
        arguments.refuse_unknown();
        static_cast<void>(arguments.text("name"));
        static_cast<void>(arguments.whole("layers"));
        static_cast<void>(arguments.truth("moving"));
        const std::optional<Pose> pose = arguments.pose("pose");
        result_.not_finite += !pose || pose->position.allFinite() ? 0 : 1;
      } catch (const service::BadCommand&) {}
    });
  }

  Malice malice_;
  Result& result_;
  World world_{WorldOptions{.epoch = 1, .max_objects = 1'000, .max_contacts = 10'000}};
  service::Publishers publishers_{world_, {}};
  std::int64_t time_ns_ = 1'000'000'000;
  std::uint64_t sequence_ = 0;
  Answers answers_;
  QueryScratch scratch_;
};

/// Whether it crashed; what it counted until then.
bool border_crashes(std::uint64_t seed, std::uint64_t inputs, Result& counted) {
  void* memory = mmap(nullptr, sizeof(Result), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  auto* result = new (memory) Result;
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    Border border(seed, *result);
    for (std::uint64_t i = 0; i < inputs; ++i) border.one();
    _exit(0);
  }
  int status = 0;
  waitpid(child, &status, 0);
  const bool crashed = !WIFEXITED(status) || WEXITSTATUS(status) != 0;
  if (crashed)
    std::fprintf(stderr, "the border crashed at input %llu of seed %llu\n",
                 static_cast<unsigned long long>(result->inputs), static_cast<unsigned long long>(seed));
  counted = *result;  // its texts are literals, in the same place in both
  munmap(memory, sizeof(Result));
  return crashed;
}

// ---- at a running server

/// Looks like RTPS for as long as it lasts.
std::vector<std::uint8_t> rtps_junk(Malice& malice) {
  std::vector<std::uint8_t> packet{'R', 'T', 'P', 'S', 2, 1, 1, 16};
  for (int i = 0; i < 12; ++i) packet.push_back(static_cast<std::uint8_t>(malice.below(256)));
  static const std::uint8_t kKinds[] = {1, 6, 7, 8, 9, 12, 13, 14, 15, 18, 19, 21, 22, 48, 128, 255};
  for (std::uint64_t i = 1 + malice.below(4); i > 0; --i) {
    std::vector<std::uint8_t> body = malice.junk(malice.below(200) & ~3ULL);
    const bool is_discovery = malice.chance(0.4) && body.size() >= 24;
    if (is_discovery) {
      // DATA of the participants' or endpoints' discovery, then parameters of any kind and length.
      const std::uint8_t head[] = {
          0, 0, 16, 0, 0, 0, 0, 0, 0, 1, 0, static_cast<std::uint8_t>(malice.chance(0.5) ? 0xc2 : 0xc7),
          0, 0, 0,  0, 1, 0, 0, 0, 0, 3, 0, 0};
      std::copy(std::begin(head), std::end(head), body.begin());
    }
    packet.push_back(is_discovery ? 0x15 : kKinds[malice.below(std::size(kKinds))]);
    packet.push_back(is_discovery ? 5 : static_cast<std::uint8_t>(malice.below(256)));
    const std::size_t told = malice.chance(0.8) ? body.size() : malice.below(65'536);
    packet.push_back(static_cast<std::uint8_t>(told));
    packet.push_back(static_cast<std::uint8_t>(told >> 8));
    packet.insert(packet.end(), body.begin(), body.end());
  }
  return packet;
}

void throw_junk(int domain, Malice& malice, std::uint64_t packets) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  for (std::uint64_t i = 0; i < packets; ++i) {
    const std::vector<std::uint8_t> packet = malice.chance(0.9) ? rtps_junk(malice) : malice.junk(malice.below(1'500));
    // Discovery and data of the first two participants of the domain (RTPS 9.6.1.1).
    const int port = 7'400 + 250 * domain + 10 + static_cast<int>(malice.below(4));
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    static_cast<void>(
        ::sendto(socket, packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&to), sizeof to));
  }
  ::close(socket);
}

/// Samples that DDS carries, and nobody should believe.
void write_samples(WireAsker& asker, Malice& malice, std::uint64_t count) {
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::vector<std::uint8_t> shape = malice.shape();
    std::vector<double> numbers(malice.below(40));
    for (double& number : numbers) number = malice.number();
    if (malice.chance(0.3)) {
      dds::Sample<wire::Definition> definition;
      definition->publisher = 1 + malice.below(50);
      definition->incarnation = malice.below(3);
      definition->object_number = static_cast<std::uint32_t>(malice.below(50));
      definition->sequence_number = i;
      definition->removed = malice.chance(0.3);
      definition->moving = malice.chance(0.8);
      double pose[7];
      malice.fill_pose(pose);
      std::copy_n(pose, 3, definition->position);
      std::copy_n(pose + 3, 4, definition->orientation);
      // As far as DDS takes it: text without a zero in it, no longer than the field.
      const std::string name = malice.name();
      static_cast<void>(
          dds::set_text(definition->name, name.substr(0, std::min(name.find('\0'), name.size())).substr(0, 250)));
      dds::borrow(definition->shape, shape);
      asker.define(*definition);
    } else if (malice.chance(0.5)) {
      dds::Sample<wire::PoseBatch> batch;
      batch->publisher = 1 + malice.below(50);
      batch->incarnation = malice.below(3);
      batch->sequence_number = i;
      batch->flags = static_cast<std::uint8_t>(malice.below(256));
      const std::vector<std::uint32_t> objects(malice.below(6), static_cast<std::uint32_t>(malice.below(50)));
      dds::borrow(batch->object_numbers, objects);
      test::put_poses(*batch, numbers);
      if (malice.chance(0.3))
        dds::borrow(malice.chance(0.5) ? batch->orientations : batch->angular_velocities, numbers);
      asker.pose(*batch);
    } else {
      dds::Sample<wire::Query> query;
      query->kind = static_cast<std::uint8_t>(malice.below(256));
      query->mode = static_cast<std::uint8_t>(malice.below(256));
      query->mask = 0xffffffff;
      query->max_hits = 10;
      query->chunk_count = static_cast<std::uint32_t>(malice.chance(0.7) ? 1 : malice.below(5));
      query->chunk_index = static_cast<std::uint32_t>(malice.chance(0.7) ? 0 : malice.below(5));
      query->barrier_publisher = malice.chance(0.9) ? 0 : malice.below(50);
      query->importance = static_cast<std::uint8_t>(malice.below(256));
      query->instant = static_cast<std::uint8_t>(malice.below(256));
      query->instant_ns = static_cast<std::int64_t>(malice.any_bits());
      test::put_questions(*query, numbers);
      if (malice.chance(0.3)) dds::borrow(malice.chance(0.5) ? query->points : query->end_points, numbers);
      dds::borrow(query->blob, shape);
      asker.send(*query);
    }
    if (i % 64 == 63) std::this_thread::sleep_for(1ms);
  }
}

/// Whether the server is no longer as it was.
bool server_crashes(const std::string& server_path, std::uint64_t seed, std::uint64_t inputs) {
  const ScratchFolder folder;
  const int domain = own_domain();
  ChildProcess server({server_path, "--domain", std::to_string(domain), "--state-dir", folder.path()}, folder.path(),
                      "server");
  if (!server.says("ready:", 20s)) return true;
  Malice malice(seed);
  WireAsker asker(domain);
  if (!asker.greet()) return true;
  const auto is_well = [&] {
    dds::Sample<wire::Query> query;
    query->kind = static_cast<std::uint8_t>(QuestionKind::ray);
    query->mask = 0xffffffff;
    query->max_hits = 10;
    static_cast<void>(dds::set_text(query->only, "warehouse/*"));
    const std::vector<double> ray{0, 0, 5, 0, 0, -1, 100};
    test::put_questions(*query, ray);
    const auto reply = asker.ask(*query, 10s);
    return server.wait(0ms) == -1 && reply && reply->numbers.size() == 13 && std::abs(reply->numbers[0] - 3.8) < 1e-9;
  };
  bool well = is_well();
  for (int part = 0; part < 10 && well; ++part) {
    throw_junk(domain, malice, inputs / 20);
    write_samples(asker, malice, inputs / 20);
    well = is_well();
  }
  if (!well)
    std::fprintf(stderr, "the server is not well, exit code %d:\n%s", server.wait(0ms), server.errors().c_str());
  return !well;
}

int run(const std::string& server, std::uint64_t inputs) {
  const std::uint64_t seed = oracle::seeded(53)();
  Result result;
  int crashes = border_crashes(seed, inputs * 8 / 10, result) ? 1 : 0;
  const std::uint64_t to_server = inputs * 2 / 10;
  crashes += server_crashes(server, seed, to_server) ? 1 : 0;
  std::printf("inputs=%llu crashes=%d nonfinite_past_gate=%llu max_call_us=%.0f (%s) max_step_us=%.0f\n",
              static_cast<unsigned long long>(result.inputs + to_server), crashes,
              static_cast<unsigned long long>(result.not_finite), result.longest_us, result.longest_kind.c_str(),
              result.longest_step_us);
  return crashes == 0 && result.not_finite == 0 && result.longest_us <= kMostCall_us &&
                 result.longest_step_us <= kMostStep_us
             ? 0
             : 1;
}

}  // namespace
}  // namespace collided::testing_support

int main(int argc, char** argv) {
  if (argc != 3) {
    std::fprintf(stderr, "usage: hostile_input SERVER INPUTS\n");
    return 2;
  }
  return collided::testing_support::run(argv[1], std::strtoull(argv[2], nullptr, 10));
}
