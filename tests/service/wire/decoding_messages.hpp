#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/watching/probes.hpp"
#include "client/library/watching/watch_decoding.hpp"
#include "idl/instant.hpp"
#include "idl/topics.hpp"
#include "tests/service/wire/rows.hpp"

namespace collided {

using client::AnswerCollector;
using client::Names;
using std::chrono::nanoseconds;

/// n, n + 1, ... as the elements of a message's list.
template <class Number>
std::vector<Number> counted(std::size_t count, double first) {
  std::vector<Number> numbers(count);
  std::iota(numbers.begin(), numbers.end(), static_cast<Number>(first));
  return numbers;
}

inline Vec3 three(double first) { return {first, first + 1, first + 2}; }

/// The answers to three questions, a miss, one with two hits, one undecided: every field has a number of its own.
struct ReplyMessage {
  wire::Reply reply{};
  std::vector<std::uint8_t> answers{0, 1, 2}, reasons{0, 0, 4}, levels{1, 2, 0},
      hit_flags{wire_contract::kHitInside, wire_contract::kHitStale};
  std::vector<std::uint32_t> hit_counts{0, 2, 0}, nodes{10, 11, 12}, exact_tests{20, 21, 22},
      triangles{30, wire_contract::kNoTriangle};
  std::vector<std::uint64_t> objects{7, 9 + (std::uint64_t{3} << 32)};
  std::vector<double> numbers = counted<double>(2 * wire_contract::kHitNumbers, 100), columns;
  std::vector<std::uint64_t> named_ids{9 + (std::uint64_t{3} << 32), 7};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"nine", "seven"});

  ReplyMessage() {
    reply.epoch = 40;
    reply.version = 41;
    reply.world_time_ns = 42;
    reply.oldest_pose_age_ns = 43;
    reply.compute_ns = 44;
  }
  wire::Reply& message() {
    dds::borrow(reply.answers, answers);
    dds::borrow(reply.reasons, reasons);
    dds::borrow(reply.levels, levels);
    dds::borrow(reply.hit_flags, hit_flags);
    dds::borrow(reply.hit_counts, hit_counts);
    dds::borrow(reply.nodes, nodes);
    dds::borrow(reply.exact_tests, exact_tests);
    dds::borrow(reply.triangles, triangles);
    dds::borrow(reply.objects, objects);
    wire::lend_columns<wire::Reply>(numbers, wire::kHitColumns, columns, reply);
    dds::borrow(reply.named_ids, named_ids);
    dds::borrow(reply.names, names);
    return reply;
  }
};

struct FrameMessage {
  wire::EventFrame frame{};
  std::vector<std::uint8_t> kinds{0, 1, 2}, reasons{0, 0, 7}, doubts{0, 0, 0}, shards{40, 41, 42};
  std::vector<std::uint64_t> a{1, 2, 3}, b{4, 5, 6}, episodes{50, 51, 52};
  std::vector<std::uint32_t> a_triangles{60, 61, wire_contract::kNoTriangle},
      b_triangles{70, wire_contract::kNoTriangle, 72};
  std::vector<double> numbers = counted<double>(3 * wire::width_of<wire::EventFrame>(wire::kEventColumns), 100),
                      columns;
  std::vector<std::uint64_t> named_ids{1, 5};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"one", "five"});

  FrameMessage() {
    frame.server = 80;
    frame.epoch = 81;
    frame.first_sequence = 82;
    frame.version = 83;
    frame.world_time_ns = 84;
  }
  const wire::EventFrame& message() {
    dds::borrow(frame.kinds, kinds);
    dds::borrow(frame.reasons, reasons);
    dds::borrow(frame.shards, shards);
    dds::borrow(frame.a, a);
    dds::borrow(frame.b, b);
    dds::borrow(frame.episodes, episodes);
    dds::borrow(frame.a_triangles, a_triangles);
    dds::borrow(frame.b_triangles, b_triangles);
    dds::borrow(frame.doubts, doubts);
    wire::lend_columns<wire::EventFrame>(numbers, wire::kEventColumns, columns, frame);
    dds::borrow(frame.named_ids, named_ids);
    dds::borrow(frame.names, names);
    return frame;
  }
};

struct ShardMessage {
  wire::ContactShard shard{};
  std::vector<std::uint8_t> doubts{0, 2};
  std::vector<std::uint64_t> a{1, 2}, b{4, 5}, episodes{50, 51};
  std::vector<std::uint32_t> a_triangles{60, wire_contract::kNoTriangle}, b_triangles{70, 71};
  std::vector<std::int64_t> began_ns{90, 91};
  std::vector<double> numbers = counted<double>(2 * wire::width_of<wire::ContactShard>(wire::kContactColumns), 100),
                      columns;
  std::vector<std::uint64_t> named_ids{2};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"two"});

  ShardMessage() {
    shard.server = 80;
    shard.shard = 81;
    shard.epoch = 82;
    shard.version = 83;
    shard.as_of_sequence = 84;
  }
  const wire::ContactShard& message() {
    dds::borrow(shard.a, a);
    dds::borrow(shard.b, b);
    dds::borrow(shard.a_triangles, a_triangles);
    dds::borrow(shard.b_triangles, b_triangles);
    dds::borrow(shard.episodes, episodes);
    dds::borrow(shard.began_ns, began_ns);
    dds::borrow(shard.doubts, doubts);
    wire::lend_columns<wire::ContactShard>(numbers, wire::kContactColumns, columns, shard);
    dds::borrow(shard.named_ids, named_ids);
    dds::borrow(shard.names, names);
    return shard;
  }
};

struct ProbeMessage {
  wire::ProbeFrame frame{};
  std::vector<std::uint8_t> states{2, 0, 99};
  std::vector<std::uint64_t> objects{1, 0, 3}, met{4, 0, 6};
  std::vector<std::uint32_t> triangles{70, wire_contract::kNoTriangle, 72};
  std::vector<double> numbers = counted<double>(3 * wire::width_of<wire::ProbeFrame>(wire::kProbeColumns), 100),
                      columns;
  std::vector<std::uint8_t> probe_names = wire_contract::pack_names(std::vector<std::string>{"p", "q", "r"});
  std::vector<std::uint64_t> named_ids{1, 4};
  std::vector<std::uint8_t> names = wire_contract::pack_names(std::vector<std::string>{"car", "road"});

  ProbeMessage() {
    frame.epoch = 80;
    frame.version = 81;
    frame.world_time_ns = 82;
  }
  const wire::ProbeFrame& message() {
    dds::borrow(frame.states, states);
    dds::borrow(frame.objects, objects);
    dds::borrow(frame.met, met);
    dds::borrow(frame.triangles, triangles);
    wire::lend_columns<wire::ProbeFrame>(numbers, wire::kProbeColumns, columns, frame);
    dds::borrow(frame.probe_names, probe_names);
    dds::borrow(frame.named_ids, named_ids);
    dds::borrow(frame.names, names);
    return frame;
  }
};

}  // namespace collided
