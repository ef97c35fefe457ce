#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "collided/geometry.hpp"
#include "idl/columns.hpp"
#include "idl/standing_ids.hpp"
#include "idl/topics.hpp"

/// Messages about standing questions as a server writes them.
namespace collided::test {

/// The id of a standing question.
constexpr std::uint64_t standing_id(std::uint64_t number) { return codes::kStandingBit | number; }

inline constexpr std::uint8_t kDetectsAll = codes::kDetectEnter | codes::kDetectExit | codes::kDetectCross;

/// A row of a StandingFrame. The members have the names that wire::put_row() takes them by.
struct StandingRow {
  codes::StandingEventKind kind = codes::StandingEventKind::enter;
  std::uint64_t standing = 0;
  std::uint64_t object = 0;
  std::uint64_t other = 0;
  std::uint64_t episode = 0;
  double band_m = 0;
  codes::EndReason reason = codes::EndReason::none;
  std::uint8_t detect = kDetectsAll;
  std::uint8_t doubt = 0;  // with kDoubtPosesMerged
  double bracket_low_s = 0, bracket_high_s = 0;
  double left_low_s = 0, left_high_s = 0;
  Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
  double distance_m = 0, distance_error_m = 0;
  double closing = 0, closing_error = 0;
  double contact_low_s = 0, contact_high_s = 0;
};

/// A row of a StandingShard.
struct StandingStay {
  codes::StandingEventKind kind = codes::StandingEventKind::enter;
  codes::StandingForm form = codes::StandingForm::region;
  std::uint64_t standing = 0;
  std::uint64_t object = 0;
  std::uint64_t other = 0;
  std::uint64_t episode = 0;
  double band_m = 0;
  std::uint8_t detect = kDetectsAll;
  std::uint8_t doubt = 0;
  std::int64_t began_ns = 0;
  Vec3 point = Vec3::Zero(), normal = Vec3::Zero();
  double distance_m = 0, distance_error_m = 0;
};

inline codes::StandingForm form_of(codes::StandingEventKind kind) {
  using Kind = codes::StandingEventKind;
  if (kind == Kind::changed || kind == Kind::is) return codes::StandingForm::nearest;
  const bool is_region = kind == Kind::inside || kind == Kind::enter || kind == Kind::exit || kind == Kind::cross;
  return is_region ? codes::StandingForm::region : codes::StandingForm::bands;
}

/// A message with the columns that it points into.
template <class Columns>
struct StandingMessage {
  Columns columns;
  dds::Sample<typename Columns::Message> sample;

  /// Adds the names of `ids`; those without a name stay numbers.
  void add_names(const std::map<std::uint64_t, std::string>& names, const std::vector<std::uint64_t>& ids) {
    std::vector<std::string> added;
    for (const std::uint64_t id : ids) {
      if (const auto found = names.find(id); found != names.end()) {
        columns.named_ids.push_back(id);
        added.push_back(found->second);
      }
    }
    const std::vector<std::uint8_t> packed = wire_contract::pack_names(added);
    columns.names.insert(columns.names.end(), packed.begin(), packed.end());
  }
  /// Valid until the columns change.
  typename Columns::Message& message() {
    wire::lend(columns, *sample);
    return *sample;
  }
};
using StandingFrameMessage = StandingMessage<wire::StandingFrameColumns>;
using StandingShardMessage = StandingMessage<wire::StandingShardColumns>;

/// One run of a server: what its messages begin with, and the names of its ids.
struct StandingServer {
  std::uint64_t server = 1;
  std::uint64_t epoch = 1;
  std::map<std::uint64_t, std::string> names = {};

  StandingFrameMessage frame(std::int64_t time_ns, std::uint64_t first_sequence,
                             const std::vector<StandingRow>& rows) const {
    StandingFrameMessage frame = begin<StandingFrameMessage>(time_ns);
    frame.sample->first_sequence = first_sequence;
    for (const StandingRow& row : rows) {
      wire::put_row(frame.columns, row);
      frame.columns.forms.push_back(static_cast<std::uint8_t>(form_of(row.kind)));
      const std::uint64_t held = row.object != 0 ? row.object : row.other;  // where none is nearest, the one before
      frame.columns.shards.push_back(wire_contract::contact_shard(held, row.standing));
      frame.add_names(names, {row.object, row.standing, row.other});
    }
    return frame;
  }
  StandingShardMessage shard(std::int64_t time_ns, std::uint8_t number, std::uint64_t as_of,
                             const std::vector<StandingStay>& stays) const {
    StandingShardMessage shard = begin<StandingShardMessage>(time_ns);
    shard.sample->shard = number;
    shard.sample->as_of_sequence = as_of;
    for (const StandingStay& stay : stays) {
      wire::put_row(shard.columns, stay);
      shard.add_names(names, {stay.object, stay.standing, stay.other});
    }
    return shard;
  }
  /// The shard that has the sum of the others.
  StandingShardMessage sum(std::int64_t time_ns, std::uint64_t as_of, const std::vector<StandingStay>& stays) const {
    StandingShardMessage sum = shard(time_ns, wire_contract::kStandingSum, as_of, {});
    sum.sample->count = static_cast<std::uint32_t>(stays.size());
    for (const StandingStay& stay : stays)
      sum.sample->hash += wire_contract::contact_hash(stay.object, stay.standing, stay.episode);
    return sum;
  }

 private:
  template <class Message>
  Message begin(std::int64_t time_ns) const {
    Message message;
    message.sample->server = server;
    message.sample->epoch = epoch;
    message.sample->version = 1;
    message.sample->world_time_ns = time_ns;
    if constexpr (requires { message.sample->state; })
      message.sample->state = static_cast<std::uint8_t>(wire_contract::ServerState::ready);
    return message;
  }
};

}  // namespace collided::test
