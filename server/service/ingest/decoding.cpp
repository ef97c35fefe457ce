#include "server/service/ingest/decoding.hpp"

#include <algorithm>

namespace collided::engine::service {

std::unique_ptr<DefinitionSample> decoded(const wire::Definition& from) {
  auto sample = std::make_unique<DefinitionSample>();
  sample->publisher = from.publisher;
  sample->object_number = from.object_number;
  sample->incarnation = from.incarnation;
  sample->sequence = from.sequence_number;
  sample->removed = from.removed;
  sample->moving = from.moving;
  sample->lost_policy = from.lost_policy;
  sample->publisher_name = from.publisher_name;
  sample->name = from.name;
  sample->filter = {.layers = from.layers, .mask = from.mask, .group = from.group};
  std::copy_n(from.pose, sample->pose.size(), sample->pose.begin());
  const auto shape = dds::view(from.shape);
  sample->shape_bytes.assign(shape.begin(), shape.end());
  return sample;
}

void decode(const wire::PoseBatch& from, PoseSample& sample) {
  sample.publisher = from.publisher;
  sample.incarnation = from.incarnation;
  sample.sequence = from.sequence_number;
  sample.definitions_through = from.definitions_through;
  sample.source_time_ns = from.source_time_ns;
  sample.flags = from.flags;
  const auto numbers = dds::view(from.object_numbers);
  const auto poses = dds::view(from.poses);
  const auto velocities = dds::view(from.velocities);
  sample.object_numbers.assign(numbers.begin(), numbers.end());
  sample.poses.assign(poses.begin(), poses.end());
  sample.velocities.assign(velocities.begin(), velocities.end());
}

}  // namespace collided::engine::service
