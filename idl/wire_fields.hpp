#pragma once

#include <concepts>
#include <type_traits>

#include "idl/dds.hpp"

/// The members of each wire type in the order of collided.idl, for code that treats all of them alike. Where the order
/// here is not that of Cyclone, WireCdr.BytesAreThoseOfTheDdsLibrary fails.
namespace collided::wire {

template <class Sample, class Wire>
concept SampleOf = std::same_as<std::remove_const_t<Sample>, Wire>;

/// Calls `field` with every member: numbers, bool, char[N], double[N], sequences of numbers.
template <SampleOf<Definition> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.publisher), field(s.object_number), field(s.incarnation), field(s.sequence_number), field(s.removed);
  field(s.moving), field(s.lost_policy), field(s.publisher_name), field(s.name), field(s.layers), field(s.mask);
  field(s.group), field(s.position), field(s.orientation), field(s.shape);
}

template <SampleOf<PoseBatch> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.publisher), field(s.incarnation), field(s.sequence_number), field(s.definitions_through);
  field(s.source_time_ns), field(s.flags), field(s.object_numbers), field(s.positions);
  field(s.orientations), field(s.linear_velocities), field(s.angular_velocities);
}

template <SampleOf<Query> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.client), field(s.request), field(s.chunk_index), field(s.chunk_count), field(s.first_question), field(s.kind);
  field(s.mode), field(s.importance), field(s.instant), field(s.instant_ns), field(s.mask), field(s.max_hits);
  field(s.deadline_ns), field(s.error_asked), field(s.barrier_publisher), field(s.barrier_sequence), field(s.only);
  field(s.skip), field(s.points), field(s.directions), field(s.lengths), field(s.radii), field(s.half_sizes);
  field(s.orientations), field(s.end_points), field(s.end_orientations), field(s.text), field(s.blob);
}

template <SampleOf<Reply> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.client), field(s.request), field(s.chunk_index), field(s.chunk_count), field(s.first_question);
  field(s.status), field(s.server), field(s.epoch), field(s.version), field(s.world_time_ns);
  field(s.oldest_pose_age_ns), field(s.compute_ns), field(s.answers), field(s.reasons), field(s.levels);
  field(s.hit_counts), field(s.nodes), field(s.exact_tests), field(s.objects), field(s.triangles), field(s.hit_flags);
  field(s.distances), field(s.distance_errors), field(s.exits), field(s.sweep_ends), field(s.sweep_widths);
  field(s.sweep_begins), field(s.points), field(s.normals), field(s.weights), field(s.point_errors);
  field(s.uncovered_questions), field(s.uncovered_points), field(s.uncovered_distances), field(s.named_ids);
  field(s.names), field(s.text);
}

template <SampleOf<EventFrame> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.server), field(s.epoch), field(s.first_sequence), field(s.version), field(s.world_time_ns), field(s.kinds);
  field(s.reasons), field(s.doubts), field(s.shards), field(s.a), field(s.b), field(s.a_triangles);
  field(s.b_triangles), field(s.episodes), field(s.points), field(s.normals), field(s.depths), field(s.depth_errors),
      field(s.surface_normals), field(s.surface_depths), field(s.surface_depth_errors);
  field(s.bracket_lows), field(s.bracket_highs), field(s.velocities), field(s.velocity_errors), field(s.named_ids);
  field(s.names);
}

template <SampleOf<ContactShard> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.server), field(s.shard), field(s.epoch), field(s.version), field(s.as_of_sequence), field(s.doubts),
      field(s.a);
  field(s.b), field(s.a_triangles), field(s.b_triangles), field(s.episodes), field(s.began_ns), field(s.points);
  field(s.normals), field(s.depths), field(s.depth_errors), field(s.surface_normals), field(s.surface_depths),
      field(s.surface_depth_errors), field(s.named_ids), field(s.names);
}

template <SampleOf<ProbeFrame> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.server), field(s.epoch), field(s.version), field(s.world_time_ns), field(s.states), field(s.objects);
  field(s.met), field(s.triangles), field(s.clearances), field(s.clearance_errors), field(s.points), field(s.normals),
      field(s.probe_names), field(s.named_ids), field(s.names);
}

template <SampleOf<Status> S, class Field>
void for_each_field(S& s, Field&& field) {
  field(s.server), field(s.epoch), field(s.version), field(s.world_time_ns), field(s.last_event_sequence);
  field(s.contact_count), field(s.contact_hash), field(s.contacts_truncated), field(s.state), field(s.pid);
  field(s.namespace_name), field(s.server_version), field(s.scenes), field(s.static_triangles), field(s.object_count);
  field(s.moving_count), field(s.poses_applied), field(s.poses_dropped), field(s.questions_answered);
  field(s.questions_refused), field(s.undecided_answers), field(s.publishers), field(s.applied_sequences);
  field(s.silent_ns), field(s.publisher_states), field(s.publisher_names);
}

}  // namespace collided::wire
