#pragma once

#include <array>
#include <memory>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "idl/topics.hpp"
#include "server/geometry/shape.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// A Definition of collided.idl, copied from the wire; the IDL explains the fields. Taking it must be quick, so its
/// shape is decoded later, on the world's thread.
struct DefinitionSample {
  std::uint64_t publisher = 0;
  std::uint32_t object_number = 0;
  std::uint64_t incarnation = 0;
  std::uint64_t sequence = 0;
  bool removed = false;
  std::string not_allowed;  // why its publisher's keys do not allow it; empty: they do
  bool moving = true;
  std::uint8_t lost_policy = 0;      // LostPolicy, not checked yet
  bool enters_with_instant = false;  // kPolicyEntersWithInstant in topics.hpp
  std::string publisher_name;
  std::string name;
  Filter filter;
  std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0};  // m; then w x y z
  std::vector<std::uint8_t> shape_bytes;            // as received
  std::variant<Shape, Refusal> shape;               // decoded on the world's thread, or why it cannot be
  bool claims = false;                              // true: no shape given; claims the existing object of that name
  std::shared_ptr<const IndexedMesh> indexed;       // of the shape's mesh, if it was declared solid, with what it
  std::shared_ptr<const SolidMesh> solid;           // encloses
  std::shared_ptr<const WindingMesh> winding;       // or contains by its winding number
};

/// A PoseBatch of collided.idl, copied from the wire. Its vectors are reused from batch to batch.
struct PoseSample {
  std::uint64_t publisher = 0;
  std::uint64_t incarnation = 0;
  std::uint64_t sequence = 0;
  std::uint64_t definitions_through = 0;  // it waits until this publisher's definitions up to here have arrived
  std::int64_t source_time_ns = 0;        // publisher's clock; 0: not stamped
  std::int64_t received_ns = 0;           // server's clock
  std::uint8_t flags = 0;                 // kPosesTeleported etc., topics.hpp
  std::vector<std::uint32_t> object_numbers;
  std::vector<double> poses;                 // 7 each: position in m, orientation w x y z
  std::vector<double> velocities;            // 6 each: linear in m/s, angular in rad/s; or empty: not known
  std::uint32_t merged = 0;                  // poses replaced here by newer ones since the server had too many
  std::vector<std::uint8_t> merged_objects;  // 1: poses of that object were replaced; empty if merged is 0
  bool has_odd_columns = false;              // the wire's columns differ in length; poses and velocities are then empty

  /// A sign of life of its publisher, without poses.
  bool is_only_alive() const {
    return object_numbers.empty() && (source_time_ns == 0 || (flags & wire_contract::kPosesStreamed) != 0);
  }
};

}  // namespace collided::engine::service
