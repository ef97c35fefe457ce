// Poses in, without their transport: batches as DDS hands them over are decoded, put into the inbox, taken out by the
// world's thread, checked and applied to the world, all on one thread. Steps of the world lie between the rounds and
// are not timed.
// usage: pose_bench [--quick] [--csv FILE] [--only NAME] [--no-header]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <vector>

#include "idl/columns.hpp"
#include "server/service/ingest/decoding.hpp"
#include "server/service/ingest/inbox.hpp"
#include "server/service/ingest/publishers.hpp"
#include "server/service/runtime/clock.hpp"
#include "tests/studies/bench/clock.hpp"
#include "tests/studies/bench/rows.hpp"

namespace {

using namespace collided;
using namespace collided::engine;
using namespace collided::engine::service;

constexpr std::uint64_t kPublisher = 7;

struct Size {
  std::uint32_t movers = 1'000;
  std::uint32_t batch = 1'000;
};

void define(Publishers& publishers, std::uint32_t number, std::int64_t now_ns) {
  DefinitionSample sample;
  sample.publisher = kPublisher;
  sample.object_number = number;
  sample.incarnation = 1;
  sample.sequence = number + 1;
  sample.publisher_name = "bench";
  sample.name = "bench/" + std::to_string(number);
  sample.pose[0] = number;
  Shape ball;
  ball.primitives.emplace_back(Sphere{.center = Vec3::Zero(), .radius_m = 0.1});
  sample.shape = ball;
  if (publishers.define(sample, now_ns) != Applied::done) std::abort();
}

/// One batch as DDS lends it.
struct Batch {
  std::vector<std::uint32_t> numbers;
  std::vector<double> poses, columns;
  dds::Sample<wire::PoseBatch> wire;
};

std::vector<Batch> make_batches(const Size& size) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> turn;
  std::uniform_real_distribution<double> place(-50, 50);
  std::vector<Batch> batches((size.movers + size.batch - 1) / size.batch);
  for (std::uint32_t number = 0; number < size.movers; ++number) {
    Batch& batch = batches[number / size.batch];
    const Quat rotation = Quat(turn(random), turn(random), turn(random), turn(random)).normalized();
    batch.numbers.push_back(number);
    batch.poses.insert(batch.poses.end(), {place(random), place(random), place(random), rotation.w(), rotation.x(),
                                           rotation.y(), rotation.z()});
  }
  for (Batch& batch : batches) {
    batch.wire->publisher = kPublisher;
    batch.wire->incarnation = 1;
    batch.wire->definitions_through = size.movers;
    batch.wire->flags = wire_contract::kPosesTeleported;  // else the first way would lead through all the others
    dds::borrow(batch.wire->object_numbers, batch.numbers);
    wire::lend_columns<wire::PoseBatch>(batch.poses, wire::kPoseColumns, batch.columns, *batch.wire);
  }
  return batches;
}

struct Course {
  explicit Course(const Size& asked) : size(asked), world({.max_objects = asked.movers + 1}) {
    for (std::uint32_t number = 0; number < size.movers; ++number) define(publishers, number, clock.now_ns());
    step();
  }
  void step() {
    if (!world.step(clock.now_ns(), 1, {.contacts = false})) std::abort();
    publishers.stepped();
  }
  /// Every mover moves once. Seconds of this thread.
  double round(std::vector<Batch>& batches) {
    const double started = bench::thread_seconds();
    const std::int64_t now_ns = clock.now_ns();  // without an instant, every way of the past would wait to be decided
    for (Batch& batch : batches) {
      batch.wire->sequence_number = ++sequence;
      batch.wire->source_time_ns = now_ns;
      std::unique_ptr<PoseSample> sample = inbox.spare();
      decode(*batch.wire, *sample);
      sample->received_ns = clock.now_ns();
      inbox.push(std::move(sample));
      inbox.take_round({}, arrivals);
      for (Arrival& arrival : arrivals) {
        auto& poses = std::get<std::unique_ptr<PoseSample>>(arrival);
        if (publishers.move(*poses, clock.now_ns()) != Applied::done) std::abort();
        inbox.give_back(std::move(poses));
      }
    }
    return bench::thread_seconds() - started;
  }

  Size size;
  World world;
  Publishers publishers{world, {}};
  Inbox inbox;
  WorldClock clock;
  std::vector<Arrival> arrivals;
  std::uint64_t sequence = size.movers;
};

}  // namespace

int main(int argc, char** argv) {
  const bench::Options options = bench::read_options(argc, argv);
  for (const std::uint32_t movers : {1'000U, 10'000U, 100'000U}) {
    if (!options.wants("spheres", "poses in") || (options.quick && movers > 10'000)) continue;
    Course course({.movers = movers});
    std::vector<Batch> batches = make_batches(course.size);
    const int rounds = std::max(2, static_cast<int>((options.quick ? 100'000 : 400'000) / movers));
    std::uint64_t sent = 0;
    const auto run = [&] {
      double seconds = 0;
      for (int i = 0; i < rounds; ++i) {
        seconds += course.round(batches);
        sent += movers;
        course.step();
      }
      return 1e9 * seconds / (static_cast<double>(movers) * rounds);
    };
    std::vector<bench::Method> methods{{.name = "collided, 1,000 a batch", .own_ns = run}};
    measure(options, {.scene = "spheres", .size = movers, .name = "poses in"}, methods);
    if (course.publishers.counts().poses_applied == sent) continue;
    std::fprintf(stderr, "pose_bench: %llu poses sent, %llu applied\n", static_cast<unsigned long long>(sent),
                 static_cast<unsigned long long>(course.publishers.counts().poses_applied));
    return 1;
  }
  return 0;
}
