#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// Names, codes and limits that both sides of the wire share. QoS beside each topic; dds.hpp turns it into entities.
namespace collided::wire_contract {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;

/// Of DDS. RTPS ports are 7400 + 250 * domain + ...: those of a later one leave the 16 bits.
inline constexpr int kLastDomain = 230;

enum class QueryKind : std::uint8_t { hello, ray, sphere, box, near, command, sweep };
inline const char* name_of(QueryKind kind) {
  static constexpr const char* kNames[] = {"hello", "ray", "sphere", "box", "near", "command", "sweep"};
  return kNames[static_cast<std::uint8_t>(kind)];
}
enum class RayMode : std::uint8_t { closest, any, all };
/// How much a question matters while not all can be answered: low ones are refused first, high ones never.
enum class Importance : std::uint8_t { normal, low, high };
enum class Verdict : std::uint8_t { miss, hit, undecided, invalid };
/// not_covered: what was asked reaches out of the space in which the loaded geometry was said to be complete.
enum class UndecidedReason : std::uint8_t { none, numeric, stale_object, recovering, truncated, deadline, not_covered };
enum class ReplyStatus : std::uint8_t { ok, refused, progress };
/// kInside: the ray begins inside the solid, or the point of near is in it or on it. kStale: the object's publisher is lost and its policy is `hold`.
enum HitFlags : std::uint8_t { kInside = 1, kStale = 2 };
enum class EventKind : std::uint8_t { began, persisted, ended };
/// decided: of a doubt; where no contact begins then, the two are apart.
enum class EndReason : std::uint8_t {
  none,
  separated,
  removed,
  publisher_lost,
  teleported,
  geometry_changed,
  server_stopping,
  server_restarted,
  decided
};
/// Why it is not known whether two objects touch. Such a pair is told as one that touches, by `began` and `ended`, until it is
/// decided: who takes it for a contact errs on the safe side. Its depth is 0 and the bound of that infinite.
/// numeric: the test came out undecided; cost_limit: the way from pose to pose could not be followed to its end;
/// publisher_lost: one is where its publisher said last, and may have gone on.
enum class Doubt : std::uint8_t { none, numeric, cost_limit, publisher_lost };
enum class ServerState : std::uint8_t { starting, recovering, ready, stopping };
enum class PublisherState : std::uint8_t { alive, silent, lost };
/// What becomes of a lost publisher's objects.
enum class LostPolicy : std::uint8_t { remove, freeze, hold };
/// kAllSaid: every definition of the publisher was sent anew before this batch, with the newest poses.
/// kStreamed: the publisher's objects move between their own poses; without, who is left out of an instant has rested.
/// kMoreFollows: more batches of the same instant come; all of them are applied with the last.
enum PoseFlags : std::uint8_t { kTeleported = 1, kAllSaid = 2, kStreamed = 4, kMoreFollows = 8 };
/// Of a probe: its object is not in the world; nothing within reach; ahead; at 0; behind the surface; behind it by more
/// than the probe looks back, so that the clearance is at most what is told; the test came out undecided.
enum class ProbeState : std::uint8_t { absent, nothing, gap, touching, collision, deeper, undecided };

inline constexpr std::uint32_t kRayNumbers = 7;
inline constexpr std::uint32_t kSphereNumbers = 4;
inline constexpr std::uint32_t kBoxNumbers = 10;
inline constexpr std::uint32_t kNearNumbers = 4;
inline constexpr std::uint32_t kSweepNumbers = 14;
/// 0 for what is no question about the world.
inline constexpr std::uint32_t numbers_of(QueryKind kind) {
  switch (kind) {
    case QueryKind::ray: return kRayNumbers;
    case QueryKind::sphere: return kSphereNumbers;
    case QueryKind::box: return kBoxNumbers;
    case QueryKind::near: return kNearNumbers;
    case QueryKind::sweep: return kSweepNumbers;
    default: return 0;
  }
}
inline constexpr std::uint32_t kPoseNumbers = 7;
inline constexpr std::uint32_t kVelocityNumbers = 6;
inline constexpr std::uint32_t kHitNumbers = 13;

/// Limits that the border checks; beyond them a sample is refused with the number, never cut in silence.
inline constexpr std::uint32_t kMaxQuestionsPerChunk = 1'000;
inline constexpr std::uint32_t kMaxQuestionsPerRequest = 100'000;
inline constexpr std::uint32_t kChunksInFlight = 4;
inline constexpr std::uint32_t kMaxHitsPerChunk = 8'192;  // 96 B a hit and more: a reply stays under 1 MiB
inline constexpr std::uint32_t kMaxPosesPerBatch = 4'096;
inline constexpr std::uint32_t kMaxEventsPerFrame = 1'024;
inline constexpr std::uint32_t kMaxProbesPerFrame = 1'024;
inline constexpr std::uint32_t kMaxTrianglePairs = 100'000;  // in one answer to `pair`
inline constexpr std::uint32_t kMaxTextBytesPerChunk = 256 * 1024;
inline constexpr std::uint32_t kMaxNameBytes = 255;
inline constexpr std::uint32_t kMaxMessageBytes = 1 << 20;
inline constexpr std::uint32_t kContactShards = 64;
/// Poses bring |q| = 1 to this: a quaternion of floats, multiplied a few times, passes; a scaled one does not.
inline constexpr double kUnitQuaternionSlack = 1e-6;
inline constexpr int kMaxParticipantIndex = 120;

enum class Reliability : std::uint8_t { best_effort, reliable };
enum class Durability : std::uint8_t { volatile_data, transient_local };

/// One row of the topic table. keep_last 0: keep all (bounded by max_samples on the reader).
struct TopicQos {
  const char* suffix;  // the topic is "<namespace>/<suffix>"
  Reliability reliability;
  Durability durability;
  int keep_last;
  int reader_max_samples;  // 0: no limit; else admission: the reader refuses more until it is taken
  bool autodispose;        // false: a crash reads "unknown", not "gone"
};

inline constexpr TopicQos kObjectTopic{"object_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};
inline constexpr TopicQos kPoseTopic{"pose_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
inline constexpr TopicQos kQueryTopic{"query_v2", Reliability::reliable, Durability::volatile_data, 0, 4'096, false};
inline constexpr TopicQos kReplyTopic{"reply_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
inline constexpr TopicQos kEventTopic{"event_v2", Reliability::reliable, Durability::volatile_data, 8'192, 0, false};
/// Contacts that go on, for who draws them: EventFrames of `persisted` only, first_sequence 0; written while it has readers.
inline constexpr TopicQos kPersistedTopic{"persisted_v2", Reliability::best_effort, Durability::volatile_data, 64, 0,
                                          false};
inline constexpr TopicQos kProbeTopic{"probe_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
inline constexpr TopicQos kContactTopic{"contact_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};
/// How far each publisher's samples are in each state: a Status with version, time and the columns of publishers only, after
/// every step while it has readers. Who records needs it to tell which poses an answer was about.
inline constexpr TopicQos kStepTopic{"step_v2", Reliability::reliable, Durability::volatile_data, 1'024, 0, false};
inline constexpr TopicQos kStatusTopic{"status_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};

/// A publisher that says nothing for this long is lost (liveliness, MANUAL_BY_TOPIC on object and pose).
inline constexpr std::int64_t kPublisherLeaseNs = 500'000'000;
inline constexpr std::int64_t kStatusPeriodNs = 50'000'000;
/// No status for this long: the client library says "disconnected". Nearly five periods, so that a machine with too much to
/// do seldom looks like a dead server, and a dead server is known within a quarter of a second.
inline constexpr std::int64_t kStatusLostNs = 240'000'000;
/// No status for this long: half of the lease after which DDS gives up another's readers and what it kept for them.
inline constexpr std::int64_t kForgottenNs = 5'000'000'000;

/// So many partitions hold all replies. Each is a writer of the server's, which stays: DDS loses some 400 bytes with every
/// writer that is made and deleted, and clients come by the thousand.
inline constexpr std::uint32_t kReplyPartitions = 256;
inline constexpr std::uint32_t reply_place(std::uint64_t client) {
  return static_cast<std::uint32_t>(client % kReplyPartitions);
}
/// "client_<2 hex digits>", the last ones of its number: the partition that a client's replies travel in, beside those of
/// others with the same; the replies say whose they are.
std::string reply_partition(std::uint64_t client);

/// "<name_space>/<suffix>". Throws std::invalid_argument unless name_space is [A-Za-z_/][A-Za-z0-9_/]*, which is all
/// that DDS accepts in a topic's name.
std::string topic_name(std::string_view name_space, const TopicQos& topic);

/// Names as they travel beside their ids: zero-terminated, one after the other.
std::vector<std::uint8_t> pack_names(std::span<const std::string> names);

/// Views into `packed`. A last name without its zero is left out, so that a cut message yields whole names only.
std::vector<std::string_view> unpack_names(std::span<const std::uint8_t> packed);

/// The shard of the contact topic that holds a pair (a < b).
std::uint8_t contact_shard(std::uint64_t a, std::uint64_t b);

/// Order-free hash of the pairs that hold: the sum of this over all (a, b, episode).
std::uint64_t contact_hash(std::uint64_t a, std::uint64_t b, std::uint64_t episode);

}  // namespace collided::wire_contract
