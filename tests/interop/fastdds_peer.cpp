// A program that speaks to the server through another vendor's DDS, with the IDL alone and nothing of ours linked in:
//   fastdds_peer DOMAIN load PATH        loads a file as a scene, prints the answer's JSON
//   fastdds_peer DOMAIN ask RAYS         asks rays (seven doubles each, as bytes); prints a line for each answer
//   fastdds_peer DOMAIN publish COUNT    a ball that goes to and fro, COUNT poses; stays until SIGTERM
//   fastdds_peer DOMAIN define LAYOUT    a ball by a type that lacks members, has one more or differs; stays until SIGTERM
//   fastdds_peer DOMAIN watch COUNT      is ready once it has heard of an event; prints COUNT events of fast/ball, then the
//                                        contacts that hold
// Numbers are printed in hexadecimal, so that they are those of the wire to the last bit.

#include <signal.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "collidedPubSubTypes.h"
#include "idl/scene_generated.h"
#include "tests/interop/fastdds_link.hpp"

namespace collided::interop {
namespace {

using namespace wire_v2;

constexpr std::uint32_t kQuestionsAChunk = 1'000;
constexpr std::uint32_t kChunksUnderWay = 4;
constexpr std::uint64_t kClient = 0x5ca1ab1eULL;

/// Questions and their replies.
class Asker {
 public:
  explicit Asker(int domain)
      : link_(domain),
        replies_(link_.reader<ReplyPubSubType>({.suffix = "reply_v2", .partition = "client_1e"})),
        queries_(link_.writer<QueryPubSubType>({.suffix = "query_v2"})) {
    wait_for_match(queries_, "questions");
    // The server writes in a client's partition once it was asked; replies arrive from the first one on that does.
    Query hello = query(QUESTION_HELLO);
    const auto is_greeted = [&] {
      send(hello);
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      return next(hello.request()).has_value();
    };
    wait_until(is_greeted, "the reply to a greeting");
  }

  Query query(std::uint32_t kind) {
    Query made;
    made.client(kClient);
    made.request(++requests_);
    made.chunk_count(1);
    made.kind(static_cast<std::uint8_t>(kind));
    made.mask(0xffffffff);
    made.max_hits(1);
    return made;
  }
  void send(Query& made) {
    if (!queries_->write(&made)) throw std::runtime_error("the server takes no more questions");
  }
  /// The next reply to this request, if one is there.
  std::optional<Reply> next(std::uint64_t request) {
    Reply reply;
    fast::SampleInfo info;
    while (replies_->take_next_sample(&reply, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && reply.client() == kClient && reply.request() == request) return reply;
    }
    return std::nullopt;
  }
  Reply wait_for(std::uint64_t request) {
    std::optional<Reply> reply;
    wait_until([&] { return (reply = next(request)).has_value(); }, "a reply");
    return std::move(*reply);
  }

 private:
  Link link_;
  fast::DataReader* replies_;
  fast::DataWriter* queries_;
  std::uint64_t requests_ = 0;
};

int load(int domain, const std::string& path) {
  Asker asker(domain);
  Query query = asker.query(QUESTION_COMMAND);
  query.text(R"({"command":"load","path":")" + path + R"("})");
  asker.send(query);
  Reply reply = asker.wait_for(query.request());
  while (reply.status() == REPLY_PROGRESS) reply = asker.wait_for(query.request());
  const std::string text(reply.text().begin(), reply.text().end());
  std::printf("%s %s\n", reply.status() == REPLY_OK ? "ok" : "refused", text.c_str());
  return reply.status() == REPLY_OK ? 0 : 1;
}

struct RayAnswer {
  std::uint8_t verdict = 0xff;
  std::uint64_t object = 0;
  double distance_m = 0;
  double error_m = 0;
  double point_m[3] = {};
};

void put(const Reply& reply, std::vector<RayAnswer>& answers) {
  std::size_t hit = 0;
  for (std::size_t i = 0; i < reply.answers().size(); ++i) {
    RayAnswer& answer = answers.at(reply.first_question() + i);
    answer.verdict = reply.answers()[i];
    if (reply.hit_counts()[i] > 0) {
      answer.object = reply.objects()[hit];
      answer.distance_m = reply.distances()[hit];
      answer.error_m = reply.distance_errors()[hit];
      std::copy_n(reply.points().begin() + static_cast<std::ptrdiff_t>(3 * hit), 3, answer.point_m);
    }
    hit += reply.hit_counts()[i];
  }
}

int ask(int domain, const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  std::vector<double> rays(bytes.size() / sizeof(double));
  std::memcpy(rays.data(), bytes.data(), rays.size() * sizeof(double));
  const auto count = static_cast<std::uint32_t>(rays.size() / 7);
  const std::uint32_t chunks = (count + kQuestionsAChunk - 1) / kQuestionsAChunk;

  Asker asker(domain);
  Query query = asker.query(QUESTION_RAY);
  query.chunk_count(chunks);
  std::vector<RayAnswer> answers(count);
  std::uint32_t sent = 0, answered = 0;
  std::vector<std::uint32_t> left(chunks);
  while (answered < chunks) {
    for (; sent < chunks && sent < answered + kChunksUnderWay; ++sent) {
      const std::uint32_t first = sent * kQuestionsAChunk, end = std::min(count, first + kQuestionsAChunk);
      std::vector<double> points, directions, lengths;
      for (std::uint32_t i = first; i < end; ++i) {
        const double* ray = &rays[std::size_t{7} * i];
        points.insert(points.end(), ray, ray + 3);
        directions.insert(directions.end(), ray + 3, ray + 6);
        lengths.push_back(ray[6]);
      }
      query.chunk_index(sent);
      query.first_question(first);
      query.points(std::move(points));
      query.directions(std::move(directions));
      query.lengths(std::move(lengths));
      left[sent] = end - first;
      asker.send(query);
    }
    const Reply reply = asker.wait_for(query.request());
    if (reply.status() != REPLY_OK)
      throw std::runtime_error("refused: " + std::string(reply.text().begin(), reply.text().end()));
    put(reply, answers);
    // A chunk may take several replies.
    std::uint32_t& still = left.at(reply.chunk_index());
    still -= static_cast<std::uint32_t>(reply.answers().size());
    if (still == 0) ++answered;
  }
  for (const RayAnswer& a : answers)
    std::printf("%u %llu %a %a %a %a %a\n", a.verdict, static_cast<unsigned long long>(a.object), a.distance_m,
                a.error_m, a.point_m[0], a.point_m[1], a.point_m[2]);
  return 0;
}

/// The shape's bytes as scene.fbs describes them.
std::vector<std::uint8_t> ball(double radius_m) {
  flatbuffers::FlatBufferBuilder builder;
  const format::Sphere sphere(format::Vec3(0, 0, 0), radius_m);
  const auto spheres = builder.CreateVectorOfStructs(&sphere, 1);
  format::ShapeBuilder shape(builder);
  shape.add_spheres(spheres);
  builder.Finish(shape.Finish());
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

enum class OtherLayout { lacks, more, differs };

/// The type of definitions as another version of the IDL might have it, under the same name: without its last members, with
/// one more at the end, or with the first of another size.
template <OtherLayout layout>
class OtherDefinition : public DefinitionPubSubType {
 public:
  bool serialize(void* data, eprosima::fastrtps::rtps::SerializedPayload_t* payload) override {
    if (!DefinitionPubSubType::serialize(data, payload)) return false;
    constexpr std::uint32_t kHeader = 4, kNumber = 8;
    if (layout == OtherLayout::lacks) payload->length /= 2;
    if (payload->length + kNumber > payload->max_size) payload->reserve(payload->length + kNumber);
    if (layout == OtherLayout::more) std::memset(payload->data + payload->length, 0x7f, kNumber);
    if (layout == OtherLayout::differs) {
      std::memmove(payload->data + kHeader + kNumber, payload->data + kHeader, payload->length - kHeader);
      std::memset(payload->data + kHeader, 0x7f, kNumber);
    }
    if (layout != OtherLayout::lacks) payload->length += kNumber;
    return true;
  }
  std::function<std::uint32_t()> getSerializedSizeProvider(void* data) override {
    return [this, data] { return DefinitionPubSubType::getSerializedSizeProvider(data)() + 8; };
  }
};

template <OtherLayout layout>
int define(int domain) {
  Link link(domain);
  fast::DataWriter* objects =
      link.writer<OtherDefinition<layout>>({.suffix = "object_v2", .is_durable = true, .lease_ms = 60'000});
  wait_for_match(objects, "objects");
  Definition definition;
  definition.publisher(0x7000000000000000ULL + static_cast<std::uint64_t>(layout));
  definition.object_number(1);
  definition.incarnation(1);
  definition.sequence_number(1);
  definition.publisher_name("other");
  definition.name("other/ball");
  definition.layers(0xffffffff);
  definition.mask(0xffffffff);
  definition.orientation({1, 0, 0, 0});
  definition.shape(ball(0.1));
  const bool is_written = objects->write(&definition);
  std::printf("%s\n", is_written ? "written" : "not written");
  std::fflush(stdout);
  if (!is_written) return 1;
  std::this_thread::sleep_for(std::chrono::seconds(30));  // until the test has seen enough
  return 0;
}

/// What the server's status says of one publisher.
class AppliedSequence {
 public:
  AppliedSequence(fast::DataReader* status, std::uint64_t publisher) : status_(status), publisher_(publisher) {}

  /// The number up to which its samples are in the world.
  std::uint64_t newest() {
    fast::SampleInfo info;
    while (status_->take_next_sample(&heard_, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      for (std::size_t i = 0; i < heard_.publishers().size(); ++i) {
        if (heard_.publishers()[i] == publisher_) applied_ = heard_.applied_sequences()[i];
      }
    }
    return applied_;
  }
  void wait_for(std::uint64_t sequence) {
    wait_until([&] { return newest() >= sequence; }, "sample " + std::to_string(sequence) + " to be applied");
  }
  /// A reader that this side has matched may know nothing of the writer yet, and then misses what it writes: a batch of
  /// nothing, written again until it is applied, costs no pose.
  void wait_until_heard(fast::DataWriter* poses, PoseBatch batch) {
    const auto is_heard = [&] {
      if (!poses->write(&batch)) throw std::runtime_error("the first batch was not taken");
      for (int wait = 0; wait < 50 && newest() < batch.sequence_number(); ++wait)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return newest() >= batch.sequence_number();
    };
    wait_until(is_heard, "the first batch to be applied");
  }

 private:
  fast::DataReader* status_;
  std::uint64_t publisher_;
  Status heard_;
  std::uint64_t applied_ = 0;
};

int publish(int domain, std::uint64_t count) {
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &ends, nullptr);  // before there are threads that would take it
  Link link(domain);
  constexpr int kLease_ms = 60'000;  // a program that does not run for a while on a crowded machine is not lost
  fast::DataWriter* objects =
      link.writer<DefinitionPubSubType>({.suffix = "object_v2", .is_durable = true, .lease_ms = kLease_ms});
  fast::DataWriter* poses = link.writer<PoseBatchPubSubType>({.suffix = "pose_v2", .lease_ms = kLease_ms});
  fast::DataReader* status = link.reader<StatusPubSubType>({.suffix = "status_v3", .is_durable = true});
  wait_for_match(objects, "objects");
  wait_for_match(poses, "poses");
  const std::jthread pulse([&](const std::stop_token& is_over) {
    while (!is_over.stop_requested()) {
      objects->assert_liveliness();
      poses->assert_liveliness();
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });

  const std::uint64_t publisher = std::random_device{}() | 1ULL << 40;

  const auto now_ns = [] {
    return static_cast<std::int64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  };
  const auto incarnation = static_cast<std::uint64_t>(now_ns());
  const auto place = [](std::uint64_t step) {
    return step % 20 < 10 ? -0.5 + 0.01 * std::sin(static_cast<double>(step)) : 0.25;
  };

  Definition definition;
  definition.publisher(publisher);
  definition.object_number(1);
  definition.incarnation(incarnation);
  definition.sequence_number(1);
  definition.moving(true);
  definition.publisher_name("fast");
  definition.name("fast/ball");
  definition.layers(0xffffffff);
  definition.mask(0xffffffff);
  definition.position({place(0), 0, 0});
  definition.orientation({1, 0, 0, 0});
  definition.shape(ball(0.1));
  if (!objects->write(&definition)) throw std::runtime_error("the object was not taken");

  AppliedSequence applied(status, publisher);
  PoseBatch batch;
  batch.publisher(publisher);
  batch.incarnation(incarnation);
  batch.definitions_through(1);
  constexpr std::uint64_t kBefore = 2;  // the definition and the batch of nothing
  batch.sequence_number(kBefore);
  applied.wait_until_heard(poses, batch);
  batch.object_numbers({1});
  batch.orientations({1, 0, 0, 0});
  for (std::uint64_t step = 1; step <= count; ++step) {
    batch.sequence_number(kBefore + step);
    batch.source_time_ns(now_ns());
    batch.positions({place(step), 1e-3 * std::cos(static_cast<double>(step)), 0});
    if (!poses->write(&batch)) throw std::runtime_error("pose " + std::to_string(step) + " was not taken");
    constexpr std::uint64_t kRound = kSamplesKept / 2;
    if (step % kRound != 0) continue;
    // A full history refuses instead of waiting where the topic has keys.
    if (poses->wait_for_acknowledgments({10, 0}) != ReturnCode_t::RETCODE_OK)
      throw std::runtime_error("pose " + std::to_string(step) + " was not acknowledged within 10 s");
    // An acknowledged sample is not yet in the world: of those that wait the server keeps some hundreds, and of more than
    // that each object's newest pose alone.
    applied.wait_for(kBefore + step - kRound);
  }
  applied.wait_for(kBefore + count);
  std::printf("published %llu poses, the last at %a %a\n", static_cast<unsigned long long>(count), place(count),
              1e-3 * std::cos(static_cast<double>(count)));
  std::fflush(stdout);
  int signal = 0;
  sigwait(&ends, &signal);
  return 0;
}

/// Names travel beside their ids, zero-terminated.
template <class Message>
void read_names(const Message& message, std::map<std::uint64_t, std::string>& names) {
  auto from = message.names().begin();
  for (const std::uint64_t id : message.named_ids()) {
    const auto zero = std::find(from, message.names().end(), std::uint8_t{0});
    names[id] = std::string(from, zero);
    from = zero == message.names().end() ? zero : zero + 1;
  }
}

int watch(int domain, std::uint64_t count) {
  Link link(domain);
  fast::DataReader* events = link.reader<EventFramePubSubType>({.suffix = "event_v3"});
  fast::DataReader* contacts = link.reader<ContactShardPubSubType>({.suffix = "contact_v2", .is_durable = true});
  wait_for_match(events, "events");
  wait_for_match(contacts, "contacts");

  std::map<std::uint64_t, std::string> names;
  std::uint64_t told = 0, last = 0;
  EventFrame frame;
  fast::SampleInfo info;
  const auto wait_for_frame = [&](const std::string& what) {
    const auto has_come = [&] {
      return events->take_next_sample(&frame, &info) == ReturnCode_t::RETCODE_OK && info.valid_data;
    };
    wait_until(has_come, what);
  };
  // That this reader knows of the server's writer does not say that the writer knows of it; and Fast DDS passes over what
  // was written before the first heartbeat that it hears, which may come behind a sample.
  constexpr int kInARow = 4;
  for (int heard = 0; heard < kInARow;) {
    wait_for_frame("first events");
    heard = last + 1 == frame.first_sequence() ? heard + 1 : 1;
    last = frame.first_sequence() + frame.kinds().size() - 1;
  }
  std::printf("ready\n");
  std::fflush(stdout);
  while (told < count) {
    wait_for_frame("event " + std::to_string(told + 1) + " of " + std::to_string(count));
    read_names(frame, names);
    for (std::size_t i = 0; i < frame.kinds().size() && told < count; ++i) {
      if (names[frame.a()[i]] != "fast/ball" && names[frame.b()[i]] != "fast/ball") continue;
      ++told;
      last = frame.first_sequence() + i;
      std::printf("event %llu %u %u %s %s %a %a %a %a\n", static_cast<unsigned long long>(last), frame.kinds()[i],
                  frame.reasons()[i], names[frame.a()[i]].c_str(), names[frame.b()[i]].c_str(), frame.depths()[i],
                  frame.depth_errors()[i], frame.bracket_lows()[i], frame.bracket_highs()[i]);
    }
  }

  std::map<int, ContactShard> shards;
  const auto is_current = [&] {
    ContactShard shard;
    while (contacts->take_next_sample(&shard, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data) shards[shard.shard()] = shard;
    }
    return std::any_of(shards.begin(), shards.end(), [&](const auto& s) { return s.second.as_of_sequence() >= last; });
  };
  wait_until(is_current, "contacts as of event " + std::to_string(last));
  for (const auto& [number, shard] : shards) {
    read_names(shard, names);
    for (std::size_t i = 0; i < shard.a().size(); ++i)
      std::printf("contact %s %s %llu %a\n", names[shard.a()[i]].c_str(), names[shard.b()[i]].c_str(),
                  static_cast<unsigned long long>(shard.episodes()[i]), shard.depths()[i]);
  }
  return 0;
}

}  // namespace
}  // namespace collided::interop

int main(int argc, char** argv) {
  using namespace collided::interop;
  const std::string command = argc == 4 ? argv[2] : "";
  try {
    const int domain = argc == 4 ? std::stoi(argv[1]) : 0;
    if (command == "load") return load(domain, argv[3]);
    if (command == "ask") return ask(domain, argv[3]);
    if (command == "publish") return publish(domain, std::stoull(argv[3]));
    if (command == "watch") return watch(domain, std::stoull(argv[3]));
    if (command == "define" && argv[3] == std::string("lacks")) return define<OtherLayout::lacks>(domain);
    if (command == "define" && argv[3] == std::string("more")) return define<OtherLayout::more>(domain);
    if (command == "define") return define<OtherLayout::differs>(domain);
  } catch (const std::exception& wrong) {
    std::fprintf(stderr, "fastdds_peer: %s\n", wrong.what());
    return 1;
  }
  std::fprintf(stderr,
               "usage: fastdds_peer DOMAIN load PATH | ask RAYS | publish COUNT | define LAYOUT | watch COUNT\n");
  return 2;
}
