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

/// Live obstacles from scans: a grid of occupied, free and unknown cells, which can be published as objects of the
/// world.
#pragma GCC visibility push(default)

namespace collided {

namespace client {
struct VoxelTiles;   // the insides of a VoxelGrid ...
struct ShownVoxels;  // ... and of PublishedVoxels
}  // namespace client

using codes::UnknownCells;

/// Options of a grid of cubes that is aligned with the world's axes and has a corner at the origin.
struct VoxelOptions {
  /// Side of a cell, m, from 1e-6 to 1e6. It is rounded to 24 significant bits, so that every corner is a double and
  /// neighbours share theirs to the last bit: 0.05 becomes 0.05000000074505806.
  double cell_m = 0.05;
  UnknownCells unknown = UnknownCells::free;
  /// A cell that no scan has hit or crossed for this long becomes unknown, up to a sixteenth later; 0: never.
  std::chrono::nanoseconds decay{0};
  /// Points farther than this from the origin of their scan are ignored; their rays clear cells up to this distance. No
  /// ray is longer than 16,000 cells.
  double reach_m = std::numeric_limits<double>::infinity();
  /// Minimum interval between updates of a block in which cells have only become free, since cells at the edge of a
  /// sensor's view flicker. Cells that become occupied or unknown are sent at once.
  std::chrono::nanoseconds clearing_delay{500'000'000};
  /// Maximum number of blocks of 16 x 16 x 16 cells, of some 16 kB each.
  std::size_t most_blocks = 32'768;
};

/// The number of a cell along each axis: it extends from number * cell_m to (number + 1) * cell_m.
using VoxelNumber = std::array<std::int32_t, 3>;
enum class VoxelState : std::uint8_t { unknown, free, occupied };

/// The outcome of a scan.
struct VoxelScan {
  std::size_t points = 0;    // taken
  std::size_t refused = 0;   // not finite, or beyond 2^23 cells from the origin of the grid
  std::size_t far = 0;       // beyond reach_m: they only clear cells in front
  std::size_t dropped = 0;   // in excess blocks, beyond most_blocks
  std::size_t occupied = 0;  // cells that have points
  /// Cells without points that rays crossed and for which this may matter: occupied ones and, unless unknown counts as
  /// free, also cells that no scan has met, or none since the last sixteenth of the decay began.
  std::size_t crossed = 0;
  std::size_t changed = 0;  // blocks with changed cells
};

/// A cube of cells with one state, as in a map.
struct VoxelBlock {
  VoxelNumber low{};      // its lowest cell
  std::int32_t side = 1;  // cells, from 1 to 65,536
  VoxelState state = VoxelState::free;
};

/// The cells alone, without a server. A scan updates a cell once, however many points or rays meet it. Points raise its
/// odds of being occupied; rays lower them if the scan has no point in the cell. A free cell with a point becomes
/// occupied at once; all free cells have equal odds.
///
/// source   Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework", 2013, with its usual weights:
///          log odds of 0.85 and -0.4, clamped to at most 3.5 and, so that no obstacle comes late, at least -0.4;
///          occupied from 0 on
/// exact    which cell a point is in, and which cells a ray crosses: those whose interior meets the segment from the
///          origin, moved by at most 1/64 of a cell along each axis, to the centre of the point's cell
/// threads  one call at a time
class VoxelGrid {
 public:
  /// Makes an empty grid. Error bad_input for options out of range.
  static Result<VoxelGrid> make(const VoxelOptions& options);
  ~VoxelGrid();
  VoxelGrid(VoxelGrid&&) noexcept;
  VoxelGrid& operator=(VoxelGrid&&) noexcept;

  /// Inserts a scan.
  ///
  /// points  x y z each, m, in the grid's frame
  /// origin  of the sensor: the space between it and each point becomes free. Ignored if it is not finite
  /// time    of the scan, on any monotonic clock; used only for decay
  VoxelScan insert(std::span<const double> points, const std::optional<Vec3>& origin, std::chrono::nanoseconds time);
  VoxelScan insert(std::span<const float> points, const std::optional<Vec3>& origin, std::chrono::nanoseconds time);
  /// Sets cells to the states of a map, and all others to unknown.
  VoxelScan assign(std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time);
  /// Lets old cells become unknown (VoxelOptions::decay); insert() does so too. Returns the number of changed blocks.
  std::size_t decay(std::chrono::nanoseconds time);
  /// Makes all cells unknown.
  void clear();

  VoxelState state(const VoxelNumber& cell) const;
  /// Returns the cell that contains a point; a border belongs to the cell above it. Nothing for a point that insert()
  /// would refuse.
  std::optional<VoxelNumber> cell_of(const Vec3& point) const;
  /// Side of a cell, as rounded.
  double cell_m() const;
  std::size_t occupied_count() const;
  std::size_t block_count() const;

 private:
  friend struct client::ShownVoxels;
  explicit VoxelGrid(std::unique_ptr<client::VoxelTiles> tiles);
  std::unique_ptr<client::VoxelTiles> tiles_;
};

/// A grid in the world. Each block of 16 x 16 x 16 cells with an occupied one is a static object NAME/i_j_k, made of
/// its occupied cells (VoxelShape). Unknown space is published on request as objects NAME/unknown/...
///
/// A change arrives block by block, not all at once. Meanwhile a cell may count as occupied or unknown for too long,
/// never as free. A contact with a changed block ends with geometry_changed and begins again.
///
/// owner    the caller; every call takes the publisher
/// threads  one call at a time
class PublishedVoxels {
 public:
  /// Starts the grid. Error bad_input for options out of range. With UnknownCells other than free all of space is
  /// unknown from now on.
  ///
  /// layers, lost_policy  of all objects, as in ObjectOptions
  static Result<PublishedVoxels> start(Publisher& publisher, const std::string& name, const VoxelOptions& options = {},
                                       std::uint32_t layers = 1, LostPolicy lost_policy = LostPolicy::freeze);
  ~PublishedVoxels();
  PublishedVoxels(PublishedVoxels&&) noexcept;
  PublishedVoxels& operator=(PublishedVoxels&&) noexcept;

  /// As for VoxelGrid, and sends the changes. After an error some changes may have been sent; the next call sends the
  /// rest.
  Result<VoxelScan> insert(Publisher& publisher, std::span<const double> points, const std::optional<Vec3>& origin,
                           std::chrono::nanoseconds time);
  Result<VoxelScan> insert(Publisher& publisher, std::span<const float> points, const std::optional<Vec3>& origin,
                           std::chrono::nanoseconds time);
  Result<VoxelScan> assign(Publisher& publisher, std::span<const VoxelBlock> blocks, std::chrono::nanoseconds time);
  /// As for VoxelGrid; also sends blocks whose clearing_delay has passed. Call it regularly while no scans come.
  Result<std::size_t> decay(Publisher& publisher, std::chrono::nanoseconds time);
  /// Makes all cells unknown, and sends the changes.
  Result<void> clear(Publisher& publisher);

  const VoxelGrid& grid() const;
  /// Number of objects in the world, including those of unknown space.
  std::size_t object_count() const;

 private:
  explicit PublishedVoxels(std::unique_ptr<client::ShownVoxels> shown);
  std::unique_ptr<client::ShownVoxels> shown_;
};

}  // namespace collided

#pragma GCC visibility pop
