#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "server/geometry/shape.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// A Definition of collided.idl off the wire. The shape is decoded on the world's thread, not where samples are taken.
struct DefinitionSample {
  std::uint64_t publisher = 0;
  std::uint32_t object_number = 0;
  std::uint64_t incarnation = 0;
  std::uint64_t sequence = 0;
  bool removed = false;
  bool moving = true;
  std::uint8_t lost_policy = 0;
  std::string publisher_name;
  std::string name;
  Filter filter;
  std::array<double, 7> pose{0, 0, 0, 1, 0, 0, 0};
  std::vector<std::uint8_t> shape_bytes;  // as they came
  std::variant<Shape, Refusal> shape;     // decoded, or why they could not be
};

/// A PoseBatch of collided.idl off the wire; its vectors are reused from batch to batch.
struct PoseSample {
  std::uint64_t publisher = 0;
  std::uint64_t incarnation = 0;
  std::uint64_t sequence = 0;
  std::uint64_t definitions_through = 0;
  std::int64_t source_time_ns = 0;
  std::int64_t received_ns = 0;  // server's clock
  std::uint8_t flags = 0;
  std::vector<std::uint32_t> object_numbers;
  std::vector<double> poses;       // 7 each: position, orientation
  std::vector<double> velocities;  // 6 each: linear, angular; or empty
  bool has_odd_columns = false;    // of different lengths: the two above are empty
};

}  // namespace collided::engine::service
