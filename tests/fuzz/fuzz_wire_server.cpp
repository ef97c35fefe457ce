#include <memory>

#include "server/intake/scene.hpp"
#include "server/intake/scene_file/scene_file.hpp"
#include "server/service/ingest/decoding.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/questions/ask.hpp"
#include "server/world/query/query.hpp"
#include "tests/fuzz/framed.hpp"
#include "tests/fuzz/fuzz_target.hpp"
#include "tests/service/wire/rows.hpp"

// What publishers and askers, or whoever speaks like one, may send to a server: definitions, poses and questions in any
// order, steps between. The world goes on; every question is refused with a reason or answered.

namespace {

using namespace collided;
using namespace collided::engine;
using service::Applied;
using wire_contract::QuestionKind;

class Side {
 public:
  void take(std::uint8_t kind, std::span<const std::byte> bytes) {
    now_ns_ += 1'000'000;
    switch (kind % 6) {
      case 0: return define(bytes);
      case 1: return move(bytes);
      case 2: return ask(bytes);
      case 3: return step();
      case 4: return repeat([&] { return publishers_.writer_lost(kind / 6, service::WriterKind::pose, now_ns_); });
      default: return publishers_.settle(now_ns_);
    }
  }

 private:
  template <class Apply>
  void repeat(const Apply& apply) {
    int steps = 0;
    while (apply() == Applied::step_first) {
      step();
      fuzz::require(++steps < 10, "a step lets a sample through");
    }
  }
  void step() {
    fuzz::require(world_.step(now_ns_, 1, {.contacts = true, .persisted = true}), "nobody holds the states");
    publishers_.stepped();
  }
  void define(std::span<const std::byte> bytes) {
    dds::Sample<wire::Definition> sample;
    if (!wire::read_cdr(bytes, sample)) return;
    const std::unique_ptr<service::DefinitionSample> definition = service::decoded(*sample);
    if (!definition->claims) {
      DecodedShape shape = decode_shape(std::as_bytes(std::span(definition->shape_bytes)),
                                        {.max_triangles = 1'000, .max_primitives = 100});
      if (shape.shape) definition->shape = std::move(*shape.shape);
      else definition->shape = Refusal{shape.refusal};
    }
    repeat([&] { return publishers_.define(*definition, now_ns_); });
    repeat([&] { return publishers_.release_parked(now_ns_); });
  }
  void move(std::span<const std::byte> bytes) {
    dds::Sample<wire::PoseBatch> sample;
    if (!wire::read_cdr(bytes, sample)) return;
    service::PoseSample poses;
    service::decode(*sample, poses);
    repeat([&] { return publishers_.move(poses, now_ns_); });
  }
  void ask(std::span<const std::byte> bytes) {
    dds::Sample<wire::Query> query;
    if (!wire::read_cdr(bytes, query) || service::why_refused(*query)) return;
    const auto kind = static_cast<QuestionKind>(query->kind);
    const std::optional<std::uint32_t> count = wire::question_count(*query);
    if (count.value_or(0) == 0 || kind == QuestionKind::sweep) return;
    // A question may take long where everything is asked of it; many of them teach nothing more.
    if (*count > 4) return;
    std::vector<double> numbers;
    wire::gather_rows(*query, wire::question_columns(kind), numbers);
    const SnapshotRing::Lease state = world_.newest();
    const Questions questions{.kind = static_cast<QuestionKind>(query->kind),
                              .mode = static_cast<HitMode>(query->mode),
                              .mask = query->mask,
                              .max_hits = query->max_hits,
                              .only = query->only,
                              .skip = query->skip,
                              .deadline_ns = 0,
                              .error_m = query->error_asked,
                              .numbers = numbers,
                              .mover = nullptr};
    answer(*state, questions, answers_, scratch_);
    fuzz::require(answers_.answers.size() == *count, "every question has an answer");
  }

  World world_{WorldOptions{.epoch = 1, .max_objects = 1'000, .max_contacts = 10'000}};
  service::Publishers publishers_{world_, {}};
  std::int64_t now_ns_ = 1'000'000'000;
  Answers answers_;
  QueryScratch scratch_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  Side side;
  collided::fuzz::for_each_frame(std::as_bytes(std::span(data, size)),
                                 [&](std::uint8_t kind, std::span<const std::byte> bytes) { side.take(kind, bytes); });
  return 0;
}

std::vector<std::string> fuzz_seeds() {
  using namespace collided;
  using namespace collided::engine;
  std::string run;
  std::vector<std::uint32_t> numbers;
  for (std::uint32_t number = 0; number < 3; ++number) {
    dds::Sample<wire::Definition> definition;
    definition->publisher = 1;
    definition->incarnation = 1;
    definition->object_number = number;
    definition->sequence_number = number + 1;
    definition->moving = true;
    definition->layers = definition->mask = 0xffffffff;
    definition->orientation[0] = 1;
    static_cast<void>(dds::set_text(definition->publisher_name, "arm"));
    static_cast<void>(dds::set_text(definition->name, "link " + std::to_string(number)));
    Shape shape;
    if (number == 0) shape.primitives.emplace_back(Sphere{{0, 0, 0}, 1});
    if (number == 1) shape.primitives.emplace_back(Box{.center = {1, 0, 0}, .half_m = {1, 1, 1}});
    if (number == 2) shape.primitives.emplace_back(Capsule{{0, 0, 0}, {1, 0, 0}, 1});
    const std::vector<std::byte> bytes = encode_shape(shape);
    const std::span octets(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    dds::borrow(definition->shape, octets);
    fuzz::append_frame(run, 0, *definition);
    numbers.push_back(number);
  }
  dds::Sample<wire::PoseBatch> batch;
  batch->publisher = 1;
  batch->incarnation = 1;
  batch->sequence_number = 4;
  batch->definitions_through = 3;
  const std::vector<double> poses{0, 0, 0, 1, 0, 0, 0, 0.5, 0, 0, 1, 0, 0, 0, 3, 0, 0, 0, 1, 0, 0};
  dds::borrow(batch->object_numbers, numbers);
  test::put_poses(*batch, poses);
  fuzz::append_frame(run, 1, *batch);
  fuzz::append_frame(run, 3, *batch);
  std::string asked = run;
  for (const auto& [kind, values] :
       std::vector<std::pair<QuestionKind, std::vector<double>>>{{QuestionKind::ray, {-9, 0, 0, 1, 0, 0, 20}},
                                                                 {QuestionKind::sphere, {0, 0, 0, 1}},
                                                                 {QuestionKind::box, {0, 0, 0, 1, 1, 1, 1, 0, 0, 0}},
                                                                 {QuestionKind::near, {5, 0, 0, 9}}}) {
    dds::Sample<wire::Query> query;
    query->client = query->request = query->chunk_count = 1;
    query->kind = static_cast<std::uint8_t>(kind);
    query->mask = 0xffffffff;
    query->max_hits = 10;
    test::put_questions(*query, values);
    fuzz::append_frame(asked, 2, *query);
  }
  batch->sequence_number = 5;
  std::string moved = asked;
  fuzz::append_frame(moved, 1, *batch);
  fuzz::append_frame(moved, 10, *batch);
  return {run, asked, moved};
}
