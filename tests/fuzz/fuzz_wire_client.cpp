#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/recordings/asked_again.hpp"
#include "client/library/watching/standing_news.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "tests/fuzz/framed.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/service/wire/rows.hpp"
#include "tests/service/wire/standing_messages.hpp"

// What a server, or whoever speaks like one, may send to a client: replies, and everything that a watch hears. Nothing of it
// makes a watch tell of an end without a beginning.

namespace {

using namespace collided;

class Listener {
 public:
  void hear(std::uint8_t kind, std::span<const std::byte> bytes) {
    now_ += std::chrono::milliseconds(kind >= 128 ? 400 : 1);
    switch (kind % 7) {
      case 0: return hear_frame(bytes, false);
      case 1: return hear_frame(bytes, true);
      case 2: return hear_shard(bytes);
      case 3: return hear_status(bytes);
      case 4: return hear_reply(bytes);
      case 5: return hear_standing_frame(bytes);
      default: return hear_standing_shard(bytes);
    }
  }

 private:
  void hear_frame(std::span<const std::byte> bytes, bool persisted) {
    dds::Sample<wire::EventFrame> frame;
    if (!wire::read_cdr(bytes, frame)) return;
    if (const auto heard = client::decode(*frame, names_))
      persisted ? state_.hear_persisted(*heard) : state_.hear(*heard, now_);
  }
  void hear_shard(std::span<const std::byte> bytes) {
    dds::Sample<wire::ContactShard> shard;
    if (!wire::read_cdr(bytes, shard)) return;
    if (const auto heard = client::decode(*shard, names_)) state_.hear(*heard, now_);
  }
  void hear_status(std::span<const std::byte> bytes) {
    dds::Sample<wire::Status> status;
    if (!wire::read_cdr(bytes, status)) return;
    state_.hear(client::decode(*status), now_);
    pulse_.hear(status);
    fuzz::require(pulse_.status().has_value(), "a status is one");
  }
  void hear_reply(std::span<const std::byte> bytes) {
    dds::Sample<wire::Reply> reply;
    if (!wire::read_cdr(bytes, reply)) return;
    static_cast<void>(collector_.add(*reply));
    client::ComparedAnswers answers;
    static_cast<void>(answers.add(*reply));
    static_cast<void>(answers.take());
  }
  void hear_standing_frame(std::span<const std::byte> bytes) {
    dds::Sample<wire::StandingFrame> frame;
    if (!wire::read_cdr(bytes, frame)) return;
    if (const auto heard = client::decode(*frame, names_)) standing_.hear(*heard, now_);
  }
  void hear_standing_shard(std::span<const std::byte> bytes) {
    dds::Sample<wire::StandingShard> shard;
    if (!wire::read_cdr(bytes, shard)) return;
    if (const auto sum = client::bookmark_in(*shard)) return standing_.hear(*sum, now_);
    if (const auto heard = client::decode(*shard, names_)) standing_.hear(*heard, now_);
  }
  void emit(const client::StandingNews& news) {
    static_cast<void>(client::event_of(news));
    const client::StandingNames names = client::names_of(news);
    if (news.kind == EventKind::ended) fuzz::require(holds_.erase(names) == 1, "what ends held");
    else fuzz::require(holds_.insert(names).second, "nothing begins twice to hold");
  }
  void emit(const Event& event) {
    // Numbers of objects belong to one life of a server, names outlive it.
    const std::pair<std::string, std::string> pair = std::minmax(event.a, event.b);
    if (event.kind == EventKind::ended) {
      fuzz::require(open_.erase(pair) == 1, "what ends has begun");
    } else if (event.kind == EventKind::began || event.kind == EventKind::open) {
      fuzz::require(open_.insert(pair).second, "nothing begins twice");
    }
  }

  client::Clock::time_point now_{std::chrono::milliseconds(1'000)};
  std::set<std::pair<std::string, std::string>> open_;
  std::set<client::StandingNames> holds_;
  client::Names names_;
  client::ServerPulse pulse_;
  client::WatchState state_{[this](const Event& event) { emit(event); }};
  client::WatchStateOf<client::StandingNews> standing_{[this](const client::StandingNews& news) { emit(news); }};
  client::AnswerCollector collector_{5, 1'000, names_};
};

/// One comes in, crosses, is the nearest and gives way to another, and then the state and its sum.
std::string standing_seed() {
  using Kind = StandingEventKind;
  constexpr std::uint64_t kDock = test::standing_id(1), kNext = test::standing_id(2), kGap = test::standing_id(3);
  const test::StandingServer server{
      .names = {{1, "drone"}, {2, "crate"}, {kDock, "dock"}, {kNext, "next"}, {kGap, "gap"}}};
  auto frame = server.frame(1'000, 1,
                            {{.kind = Kind::enter, .standing = kDock, .object = 1, .episode = 1},
                             {.kind = Kind::cross, .standing = kDock, .object = 2, .episode = 2},
                             {.kind = Kind::changed, .standing = kNext, .object = 1},
                             {.kind = Kind::changed, .standing = kNext, .object = 2, .other = 1, .episode = 3},
                             {.kind = Kind::near, .standing = kGap, .object = 1, .other = 2, .episode = 5, .band_m = 2},
                             {.kind = Kind::exit, .standing = kDock, .object = 1, .episode = 1}});
  const std::vector<test::StandingStay> next{
      {.form = StandingForm::nearest, .standing = kNext, .object = 2, .episode = 4}};
  auto shard = server.shard(2'000, wire_contract::contact_shard(2, kNext), 6, next);
  auto sum = server.sum(2'000, 6, next);
  std::string seed;
  fuzz::append_frame(seed, 6, sum.message());
  fuzz::append_frame(seed, 5, frame.message());
  fuzz::append_frame(seed, 6, shard.message());
  fuzz::append_frame(seed, 132, sum.message());
  return seed;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Listener listener;
  collided::fuzz::for_each_frame(
      std::as_bytes(std::span(data, size)),
      [&](std::uint8_t kind, std::span<const std::byte> bytes) { listener.hear(kind, bytes); });
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace collided;
  const std::vector<std::uint64_t> a{1}, b{2}, episodes{1};
  const std::vector<std::uint64_t> ids{1, 2};
  const std::vector<std::string> both{"crate", "shelf"};
  const std::vector<std::uint8_t> names = wire_contract::pack_names(both), began{0}, ended{2}, none{0}, separated{1};
  const std::vector<std::uint8_t> shard{wire_contract::contact_shard(1, 2)};
  const std::vector<std::uint32_t> triangles{7};
  const std::vector<double> event_numbers(wire::width_of<wire::EventFrame>(wire::kEventColumns), 0.5),
      contact_numbers(wire::width_of<wire::ContactShard>(wire::kContactColumns), 0.5),
      hit_numbers(wire_contract::kHitNumbers, 1.5);
  const std::vector<std::int64_t> began_ns{5};

  dds::Sample<wire::EventFrame> frame;
  frame->server = frame->epoch = frame->first_sequence = 1;
  dds::borrow(frame->kinds, began);
  dds::borrow(frame->reasons, none);
  dds::borrow(frame->doubts, none);
  dds::borrow(frame->shards, shard);
  dds::borrow(frame->a, a);
  dds::borrow(frame->b, b);
  dds::borrow(frame->a_triangles, triangles);
  dds::borrow(frame->b_triangles, triangles);
  dds::borrow(frame->episodes, episodes);
  test::put_rows<wire::EventFrame>(*frame, wire::kEventColumns, event_numbers);
  dds::borrow(frame->named_ids, ids);
  dds::borrow(frame->names, names);

  dds::Sample<wire::ContactShard> contacts;
  contacts->server = contacts->epoch = contacts->as_of_sequence = 1;
  contacts->shard = shard[0];
  dds::borrow(contacts->doubts, none);
  dds::borrow(contacts->a, a);
  dds::borrow(contacts->b, b);
  dds::borrow(contacts->a_triangles, triangles);
  dds::borrow(contacts->b_triangles, triangles);
  dds::borrow(contacts->episodes, episodes);
  dds::borrow(contacts->began_ns, began_ns);
  test::put_rows<wire::ContactShard>(*contacts, wire::kContactColumns, contact_numbers);
  dds::borrow(contacts->named_ids, ids);
  dds::borrow(contacts->names, names);

  dds::Sample<wire::Status> status;
  status->server = status->epoch = 1;
  status->state = static_cast<std::uint8_t>(wire_contract::ServerState::ready);

  dds::Sample<wire::Reply> reply;
  reply->server = reply->epoch = 1;
  reply->chunk_count = 1;
  const std::vector<std::uint8_t> verdicts{1, 0, 0, 2, 0}, reasons{0, 0, 0, 1, 0}, levels(5, 0);
  const std::vector<std::uint32_t> hit_counts{1, 0, 0, 0, 0}, nodes(5, 3);
  dds::borrow(reply->answers, verdicts);
  dds::borrow(reply->reasons, reasons);
  dds::borrow(reply->levels, levels);
  dds::borrow(reply->hit_counts, hit_counts);
  dds::borrow(reply->nodes, nodes);
  dds::borrow(reply->exact_tests, nodes);
  dds::borrow(reply->objects, a);
  dds::borrow(reply->triangles, triangles);
  dds::borrow(reply->hit_flags, none);
  test::put_rows<wire::Reply>(*reply, wire::kHitColumns, hit_numbers);
  dds::borrow(reply->named_ids, ids);
  dds::borrow(reply->names, names);

  std::string whole, late;
  fuzz::append_frame(whole, 3, *status);
  fuzz::append_frame(whole, 0, *frame);
  fuzz::append_frame(whole, 1, *frame);
  status->last_event_sequence = 1;
  status->contact_count = 1;
  status->contact_hash = wire_contract::contact_hash(1, 2, 1);
  fuzz::append_frame(late, 2, *contacts);
  fuzz::append_frame(late, 3, *status);
  frame->first_sequence = 2;
  dds::borrow(frame->kinds, ended);
  dds::borrow(frame->reasons, separated);
  fuzz::append_frame(whole, 0, *frame);
  fuzz::append_frame(late, 133, *frame);  // of kind 0, after a while
  std::string answer;
  fuzz::append_frame(answer, 4, *reply);
  // It names a question that reaches out of the known space, and not where.
  std::string cut;
  const std::vector<std::uint32_t> first{0};
  dds::borrow(reply->uncovered_questions, first);
  fuzz::append_frame(cut, 4, *reply);
  return {whole, late, whole + late, answer, cut, standing_seed()};
}
