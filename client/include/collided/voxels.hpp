#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include <collided/codes.hpp>
#include <collided/publisher.hpp>

/// Live obstacles from scans: a grid of cells that are occupied, free or unknown, and a publisher that keeps the world
/// as the grid has it.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
struct VoxelTiles;   // the insides of a VoxelGrid ...
struct ShownVoxels;  // ... and of PublishedVoxels
}  // namespace client

using codes::UnknownCells;

/// A grid of cubes that stands along the world's axes, a corner of one at the origin.
struct VoxelOptions {
  /// Side of a cell, m, from 1e-6 to 1e6. It is rounded to 24 significant bits, so that every corner is a double and
  /// neighbours share theirs to the last bit: 0.05 becomes 0.05000000074505806.
  double cell_m = 0.05;
  UnknownCells unknown = UnknownCells::free;
  /// A cell that no scan has met for so long is unknown again, up to a sixteenth later; 0: never.
  std::chrono::nanoseconds decay{0};
  /// Points farther than this from the origin of their scan do not count, and what lies before them is clear up to there. No
  /// ray is longer than 16,000 cells.
  double reach_m = std::numeric_limits<double>::infinity();
  /// A block in which cells have only become free is told of this much after it was told of last, or later: cells at the
  /// rim of what a sensor sees come and go. What becomes occupied or unknown is told of at once.
  std::chrono::nanoseconds clearing_delay{500'000'000};
  /// Blocks of 16 x 16 x 16 cells that may be in use, of some 16 kB each.
  std::size_t most_blocks = 32'768;
};

/// A cell by its numbers: it reaches from number * cell_m to (number + 1) * cell_m along each axis.
using VoxelNumber = std::array<std::int32_t, 3>;
enum class VoxelState : std::uint8_t { unknown, free, occupied };

/// What became of a scan.
struct VoxelScan {
  std::size_t points = 0;    // taken
  std::size_t refused = 0;   // not finite, or beyond 2^23 cells from the origin of the grid
  std::size_t far = 0;       // beyond reach_m: they only clear what lies before
  std::size_t dropped = 0;   // in a block beyond most_blocks
  std::size_t occupied = 0;  // cells that have points
  /// Cells that rays crossed, that no point is in, and for which it made a difference: where unknown is free, occupied
  /// ones; else also those that no scan met before, or none since the last sixteenth of the decay began.
  std::size_t crossed = 0;
  std::size_t changed = 0;  // blocks whose cells are other than before
};

/// A cube of cells with one state, as a map has it.
struct VoxelBlock {
  VoxelNumber low{};      // its lowest cell
  std::int32_t side = 1;  // cells, from 1 to 65,536
  VoxelState state = VoxelState::free;
};

/// The cells alone, without a server. A scan counts once for a cell, however many points or rays meet it: a cell with
/// points becomes more surely occupied, one that rays cross and that has no point less so. A free cell with a point is occupied
/// at once; all free cells are equally free.
///
/// source   Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework", 2013, with its usual weights: log
///          odds of 0.85 and -0.4, kept below 3.5 and, so that no obstacle comes late, above -0.4; occupied from 0 on
/// exact    which cell a point is in, and which cells a ray crosses: those whose inside the segment meets, from the
///          origin, moved by at most 1/64 of a cell along each axis, to the middle of the point's cell
/// threads  one at a time
class VoxelGrid {
 public:
  /// Error bad_input for options that are out of their range.
  static Result<VoxelGrid> make(const VoxelOptions& options);
  ~VoxelGrid();
  VoxelGrid(VoxelGrid&&) noexcept;
  VoxelGrid& operator=(VoxelGrid&&) noexcept;

  /// Takes a scan.
  ///
  /// points  x y z each, m, in the grid's frame
  /// origin  of the sensor; with it the space between it and each point becomes free. Ignored where it is not finite
  /// time    of the scan, on any clock that does not go back; for decay alone
  VoxelScan insert(std::span<const double> points, const std::optional<Vec3>& origin, std::chrono::nanoseconds time);
  VoxelScan insert(std::span<const float> points, const std::optional<Vec3>& origin, std::chrono::nanoseconds time);
  /// Sets cells to what a map says, and all others to unknown.
  VoxelScan assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time);
  /// Lets what was not met for long become unknown; insert() does so too. Returns the number of changed blocks.
  std::size_t decay(std::chrono::nanoseconds time);
  void clear();

  VoxelState state(const VoxelNumber& cell) const;
  /// The cell that holds a point: a border belongs to the cell above it. Nothing for one that insert() would refuse.
  std::optional<VoxelNumber> cell_of(const Vec3& point) const;
  /// As rounded.
  double cell_m() const;
  std::size_t occupied_count() const;
  std::size_t block_count() const;

 private:
  friend struct client::ShownVoxels;
  explicit VoxelGrid(std::unique_ptr<client::VoxelTiles> tiles);
  std::unique_ptr<client::VoxelTiles> tiles_;
};

/// A grid in the world. Each block of 16 x 16 x 16 cells with an occupied one is an object NAME/i_j_k that stands still,
/// made of its occupied cells (VoxelShape). What is unknown is objects NAME/unknown/..., where asked for.
///
/// A change arrives block by block, not all at once; in between a cell may count as occupied or unknown for longer than
/// it is, never as free. A contact with a block that changes ends with geometry_changed and begins again.
///
/// owner    the caller, beside the publisher, which every call is given
/// threads  one call at a time
class PublishedVoxels {
 public:
  /// Error bad_input for options that are out of their range. With UnknownCells other than free all of space is unknown
  /// from now on.
  ///
  /// layers, lost_policy  of all objects, as in ObjectOptions
  static Result<PublishedVoxels> start(Publisher& publisher, const std::string& name, const VoxelOptions& options = {},
                                       std::uint32_t layers = 1, LostPolicy lost_policy = LostPolicy::freeze);
  ~PublishedVoxels();
  PublishedVoxels(PublishedVoxels&&) noexcept;
  PublishedVoxels& operator=(PublishedVoxels&&) noexcept;

  /// As VoxelGrid's, and sends what has changed. With an error some changes may be sent; the next call sends the rest.
  Result<VoxelScan> insert(Publisher& publisher, std::span<const double> points, const std::optional<Vec3>& origin,
                           std::chrono::nanoseconds time);
  Result<VoxelScan> insert(Publisher& publisher, std::span<const float> points, const std::optional<Vec3>& origin,
                           std::chrono::nanoseconds time);
  Result<VoxelScan> assign(Publisher& publisher, std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time);
  /// Also tells of blocks whose clearing_delay is over; to be called now and then where no scan comes.
  Result<std::size_t> decay(Publisher& publisher, std::chrono::nanoseconds time);
  Result<void> clear(Publisher& publisher);

  const VoxelGrid& grid() const;
  /// Objects in the world, those of unknown space included.
  std::size_t object_count() const;

 private:
  explicit PublishedVoxels(std::unique_ptr<client::ShownVoxels> shown);
  std::unique_ptr<client::ShownVoxels> shown_;
};

}  // namespace collided

#pragma GCC visibility pop
