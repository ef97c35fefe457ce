#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "collided/codes.hpp"
#include "idl/question_rules.hpp"

/// Names, codes, limits and times shared by server and client, and the table of topics with their QoS, from which
/// dds.hpp makes entities.
namespace collided::wire_contract {

using codes::Doubt;
using codes::EndReason;
using codes::EventKind;
using codes::HitMode;
using codes::Importance;
using codes::InstantKind;
using codes::is_known;
using codes::kCodeCount;
using codes::kDefaultGapNs;
using codes::kDoubtPosesMerged;
using codes::kHitByWinding;
using codes::kHitInside;
using codes::kHitStale;
using codes::kNoTriangle;
using codes::kObjectPublisherItself;
using codes::kPolicyEntersWithInstant;
using codes::kPosesAllSaid;
using codes::kPosesBringsObjects;
using codes::kPosesMoreFollows;
using codes::kPosesStreamed;
using codes::kPosesTeleported;
using codes::kPublisherBusyWorld;
using codes::kTriangleWithin;
using codes::LostPolicy;
using codes::MemberRole;
using codes::name_of;
using codes::ProbeState;
using codes::PublisherState;
using codes::QuestionKind;
using codes::ReplyStatus;
using codes::ServerState;
using codes::UndecidedReason;
using codes::Verdict;

/// The last DDS domain. RTPS ports are 7400 + 250 * domain + ...; those of a higher domain do not fit into 16 bits.
inline constexpr int kLastDomain = 230;

/// Number of numbers in a velocity and in a hit.
inline constexpr std::uint32_t kVelocityNumbers = 6;
inline constexpr std::uint32_t kHitNumbers = 13;

/// Limits checked by validation. A sample beyond them is refused with a message that names the number, and never
/// truncated silently.
inline constexpr std::uint32_t kMaxQuestionsPerChunk = 1'000;
inline constexpr std::uint32_t kMaxPosesPerChunk = 1'000;  // of what-if configurations
inline constexpr std::uint32_t kMaxQuestionsPerRequest = 100'000;
inline constexpr std::uint32_t kChunksInFlight = 4;       // of one request, sent but not answered
inline constexpr std::uint32_t kMaxHitsPerChunk = 8'192;  // 96 B or more per hit: a reply stays under 1 MiB
inline constexpr std::uint32_t kMaxPosesPerBatch = 4'096;
inline constexpr std::uint32_t kMaxEventsPerFrame = 1'024;
inline constexpr std::uint32_t kMaxProbesPerFrame = 1'024;
inline constexpr std::uint32_t kMaxTrianglePairs = 100'000;  // in one answer to `pair`
inline constexpr std::uint32_t kMaxTextBytesPerChunk = 256 * 1024;
inline constexpr std::uint32_t kMaxNameBytes = 255;
inline constexpr std::uint32_t kMaxMessageBytes = 1 << 20;
inline constexpr std::uint32_t kContactShards = 64;
inline constexpr std::uint8_t kStandingSum = 64;  // the shard of standing_state_v3 that has the sum of the others
inline constexpr int kMaxParticipantIndex = 120;

enum class Reliability : std::uint8_t { best_effort, reliable };
/// transient_local: a late joiner receives the samples that the writer keeps.
enum class Durability : std::uint8_t { volatile_data, transient_local };

/// One row of the topic table.
struct TopicQos {
  const char* suffix;  // the topic is "<namespace>/<suffix>"
  Reliability reliability;
  Durability durability;
  int keep_last;           // 0: keep all, bounded by reader_max_samples
  int reader_max_samples;  // 0: no limit; else a full reader accepts no more until it is drained
  bool autodispose;        // false: for a reader, a crashed writer's instances are unknown, not disposed
};

inline constexpr TopicQos kObjectTopic{"object_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};
inline constexpr TopicQos kPoseTopic{"pose_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
/// A sample has up to 80 kB, so 1,024 waiting samples are at most 80 MB; writers of more are blocked.
inline constexpr TopicQos kQueryTopic{"query_v2", Reliability::reliable, Durability::volatile_data, 0, 1'024, false};
inline constexpr TopicQos kReplyTopic{"reply_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
inline constexpr TopicQos kEventTopic{"event_v3", Reliability::reliable, Durability::volatile_data, 8'192, 0, false};
/// Persisting contacts, for subscribers that draw them: EventFrames of `persisted` only, first_sequence 0; written
/// while the topic has readers.
inline constexpr TopicQos kPersistedTopic{"persisted_v3", Reliability::best_effort, Durability::volatile_data, 64, 0,
                                          false};
/// World time up to which all events are decided: EventFrames without events. The next one replaces one that is lost.
inline constexpr TopicQos kWatermarkTopic{"watermark_v3", Reliability::best_effort, Durability::volatile_data, 64, 0,
                                          false};
inline constexpr TopicQos kProbeTopic{"probe_v2", Reliability::reliable, Durability::volatile_data, 256, 0, false};
inline constexpr TopicQos kContactTopic{"contact_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};
/// The newest sample of each publisher that each state includes: a Status with only version, time and the columns of
/// publishers, written after every step while the topic has readers. A recording needs it to determine which poses an
/// answer was about.
inline constexpr TopicQos kStepTopic{"step_v3", Reliability::reliable, Durability::volatile_data, 1'024, 0, false};
inline constexpr TopicQos kStatusTopic{"status_v3", Reliability::reliable, Durability::transient_local, 1, 0, false};
/// The servers. A crashed server's instance is not disposed; readers see that it has no writer.
inline constexpr TopicQos kMemberTopic{"member_v2", Reliability::reliable, Durability::transient_local, 1, 0, false};
/// The effects of commands, for followers. There are few followers, and each drains its reader at once.
inline constexpr TopicQos kChangeTopic{"change_v2", Reliability::reliable, Durability::volatile_data, 0, 0, false};
/// Events of standing questions, and their state.
inline constexpr TopicQos kStandingEventTopic{
    "standing_event_v3", Reliability::reliable, Durability::volatile_data, 8'192, 0, false};
inline constexpr TopicQos kStandingStateTopic{
    "standing_state_v3", Reliability::reliable, Durability::transient_local, 1, 0, false};

/// Rights to send on the topic of queries. With keys each right is a separate partition of that topic; without keys all
/// queries use the default partition. greet: hello. ask: questions, and commands that read. change: commands that
/// change the world, and those that return data of other clients (the flight recorder and samples of questions).
/// upload: files.
enum class QueryRight : std::uint8_t { greet, ask, change, upload };
inline constexpr std::array kQueryRights{QueryRight::greet, QueryRight::ask, QueryRight::change, QueryRight::upload};
inline const char* name_of(QueryRight right) {
  static constexpr const char* kNames[] = {"greet", "ask", "change", "upload"};
  return kNames[static_cast<std::uint8_t>(right)];
}

/// Default lease: a publisher that is silent for this long is lost (liveliness, MANUAL_BY_TOPIC on object and pose).
inline constexpr std::int64_t kPublisherLeaseNs = 500'000'000;
/// Limits of PublishOptions::gap; its default is kDefaultGapNs. No pair waits for a publisher that is 10 s behind.
inline constexpr std::int64_t kLeastGapNs = 1'000'000;
inline constexpr std::int64_t kMostGapNs = 8'000'000'000;
/// Interval between statuses.
inline constexpr std::int64_t kStatusPeriodNs = 50'000'000;
/// Interval between watermarks in a world that does not step.
inline constexpr std::int64_t kWatermarkPeriodNs = 20'000'000;
/// If a step lasts longer than this, a standby considers the server to hang.
inline constexpr std::int64_t kWorldHangsNs = 10'000'000'000;
/// Interval between a member's records about itself.
inline constexpr std::int64_t kMemberPeriodNs = 500'000'000;
/// Without a status for this long, the client library reports "disconnected". Nearly five periods: an overloaded
/// machine seldom looks like a dead server, and a dead server is detected within a quarter of a second.
inline constexpr std::int64_t kStatusLostNs = 240'000'000;
/// Without a status for this long, a standby that is ready takes over.
inline constexpr std::int64_t kTakeOverNs = 200'000'000;
/// Without a status for this long, a server with a greater epoch is accepted as the heir. It is less than the shortest
/// time until a standby takes over, since the heir publishes its first messages only once.
inline constexpr std::int64_t kMayHaveHeirNs = 150'000'000;
/// Without a status for this long, sent messages may be lost: it is half of the lease after which DDS drops another
/// participant's readers and the samples kept for them.
inline constexpr std::int64_t kForgottenNs = 5'000'000'000;

/// Number of partitions for replies. Each has a permanent writer in the server: DDS leaks some 400 bytes with every
/// writer that is made and deleted, and clients come by the thousand.
inline constexpr std::uint32_t kReplyPartitions = 256;
/// Index of the partition of a client's replies.
inline constexpr std::uint32_t reply_place(std::uint64_t client) {
  return static_cast<std::uint32_t>(client % kReplyPartitions);
}
/// The partition of a client's replies: "client_" and the last two hex digits of its number. It also carries the
/// replies to other clients with the same digits; each reply names its client.
std::string reply_partition(std::uint64_t client);

/// The name of a topic: "<name_space>/<suffix>". Throws std::invalid_argument unless name_space is
/// [A-Za-z_/][A-Za-z0-9_/]*, which is all that DDS accepts in a topic's name.
std::string topic_name(std::string_view name_space, const TopicQos& topic);

/// The namespace in which the replica of that name answers: "<name_space>/replica_<member>", with '_' for characters
/// that a topic's name cannot have.
std::string replica_namespace(std::string_view name_space, std::string_view member);

/// Packs names as they travel with their ids: zero-terminated, one after the other.
std::vector<std::uint8_t> pack_names(std::span<const std::string> names);

/// The names in `packed`, as views into it. A last name without its zero is left out, so that a truncated message
/// yields whole names only.
std::vector<std::string_view> unpack_names(std::span<const std::uint8_t> packed);

/// The shard of the contact topic that holds a pair, a < b.
std::uint8_t contact_shard(std::uint64_t a, std::uint64_t b);

/// One number for the sums of a Member's digest, for display and comparison.
std::uint64_t digest_hash(std::span<const std::uint64_t> sums);

/// Hash of an open contact. The sum over all contacts does not depend on their order.
std::uint64_t contact_hash(std::uint64_t a, std::uint64_t b, std::uint64_t episode);

}  // namespace collided::wire_contract
