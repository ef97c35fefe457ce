#include "server/service/ingest/decoding.hpp"

#include <algorithm>

#include "idl/columns.hpp"

namespace collided::engine::service {

std::unique_ptr<DefinitionSample> decoded(const wire::Definition& from) {
  auto sample = std::make_unique<DefinitionSample>();
  sample->publisher = from.publisher;
  sample->object_number = from.object_number;
  sample->incarnation = from.incarnation;
  sample->sequence = from.sequence_number;
  sample->removed = from.removed;
  sample->moving = from.moving;
  sample->enters_with_instant = (from.lost_policy & wire_contract::kPolicyEntersWithInstant) != 0;
  sample->lost_policy = from.lost_policy & static_cast<std::uint8_t>(~wire_contract::kPolicyEntersWithInstant);
  sample->publisher_name = from.publisher_name;
  sample->name = from.name;
  sample->filter = {.layers = from.layers, .mask = from.mask, .group = from.group};
  std::copy_n(from.orientation, 4, std::copy_n(from.position, 3, sample->pose.begin()));
  const auto shape = dds::view(from.shape);
  sample->shape_bytes.assign(shape.begin(), shape.end());
  sample->claims = !from.removed && shape.empty();
  return sample;
}

void decode(const wire::PoseBatch& from, PoseSample& sample) {
  sample.publisher = from.publisher;
  sample.incarnation = from.incarnation;
  sample.sequence = from.sequence_number;
  sample.definitions_through = from.definitions_through;
  sample.source_time_ns = from.source_time_ns;
  sample.flags = from.flags;
  sample.merged = 0;  // a spare sample still has its old value
  sample.merged_objects.clear();
  const auto numbers = dds::view(from.object_numbers);
  sample.object_numbers.assign(numbers.begin(), numbers.end());
  sample.has_odd_columns = !wire::row_count<wire::PoseBatch>(from, wire::kPoseColumns) ||
                           !wire::row_count<wire::PoseBatch>(from, wire::kVelocityColumns);
  sample.poses.clear();
  sample.velocities.clear();
  if (sample.has_odd_columns) return;
  wire::gather_rows<wire::PoseBatch>(from, wire::kPoseColumns, sample.poses);
  wire::gather_rows<wire::PoseBatch>(from, wire::kVelocityColumns, sample.velocities);
}

}  // namespace collided::engine::service
