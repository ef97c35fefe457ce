#include "client/ros/live_clouds.hpp"

#include <cmath>

#include "client/ros/placed_frame.hpp"

namespace collided::ros {
namespace {

constexpr std::size_t kMostCloudsWaiting = 8;
constexpr std::int64_t kLongestCloudWaitNs = 1'000'000'000;

/// A rotation that maps the grid onto itself would do too, but clouds of maps are mostly not turned at all.
bool is_upright(const Pose& pose) { return std::abs(std::abs(pose.rotation.w()) - 1) <= 1e-9; }

}  // namespace

void LiveClouds::tell(const std::string& flaw) {
  constexpr std::size_t kMostFlaws = 100;
  if (flaws_.size() < kMostFlaws) flaws_.push_back(flaw);
}

Result<void> LiveClouds::start() {
  if (options_.clouds.empty() && options_.maps.empty()) return {};
  Result<Publisher> publisher = client_.publish("collide ros clouds");
  if (!publisher) return publisher.error();
  publisher_.emplace(std::move(*publisher));
  for (const std::string& name : options_.clouds) {
    Result<PublishedVoxels> grid = PublishedVoxels::start(*publisher_, name, options_.voxels);
    if (!grid) return grid.error();
    grids_.emplace_back(std::move(*grid));
  }
  grids_.resize(options_.clouds.size() + options_.maps.size());
  return {};
}

void LiveClouds::refuse(const std::string& flaw) {
  ++counts_.bad;
  tell(flaw);
}

void LiveClouds::put_off(Waiting message) {
  if (waiting_.size() >= kMostCloudsWaiting) {
    ++counts_.frameless;
    waiting_.pop_front();
  }
  waiting_.push_back(std::move(message));
}

void LiveClouds::take(std::size_t topic, const CloudMessage& cloud, std::int64_t now_ns) {
  auto points = points_of(cloud);
  if (const auto* flaw = std::get_if<std::string>(&points)) return refuse(*flaw);
  put_off({.grid = topic,
           .frame = cloud.frame,
           .stamp_ns = cloud.stamp_ns,
           .came_ns = now_ns,
           .points = std::get<std::vector<double>>(std::move(points)),
           .blocks = {}});
}

void LiveClouds::take(std::size_t topic, const OctomapMessage& map, std::int64_t now_ns) {
  auto blocks = blocks_of(map);
  if (const auto* flaw = std::get_if<std::string>(&blocks)) return refuse(*flaw);
  put_off({.grid = options_.clouds.size() + topic,
           .frame = map.frame,
           .stamp_ns = map.stamp_ns,
           .came_ns = now_ns,
           .points = {},
           .blocks = std::get<std::vector<VoxelBlock>>(std::move(blocks)),
           .cell_m = map.resolution_m});
}

void LiveClouds::go_on(const FrameTree& frames, std::int64_t now_ns) {
  if (!publisher_) return;
  for (std::size_t left = waiting_.size(); left > 0; --left) {
    Waiting message = std::move(waiting_.front());
    waiting_.pop_front();
    const PlacedFrame placed = place_frame(frames, options_.fixed, message.frame, message.stamp_ns, message.came_ns);
    if (placed.placing == FramePlacing::not_yet) {
      if (now_ns - message.came_ns > kLongestCloudWaitNs) ++counts_.frameless;
      else waiting_.push_back(std::move(message));
      continue;
    }
    if (placed.placing == FramePlacing::unnamed) {
      ++counts_.unnamed;
      continue;
    }
    counts_.unstamped += placed.is_unstamped ? 1 : 0;
    counts_.ahead += placed.is_ahead ? 1 : 0;
    message.cell_m > 0 ? put_map(message, placed.pose) : put(message, placed.pose);
  }
  for (std::optional<PublishedVoxels>& grid : grids_) {
    if (grid && !grid->decay(*publisher_, std::chrono::nanoseconds(now_ns))) ++counts_.unsent;
  }
  static_cast<void>(publisher_->keep_alive());
}

void LiveClouds::put(Waiting& message, const Pose& pose) {
  const Eigen::Matrix3d turn = pose.rotation.toRotationMatrix();
  for (std::size_t i = 0; i + 2 < message.points.size(); i += 3) {
    Eigen::Map<Vec3> point(message.points.data() + i);
    point = turn * point + pose.position;
  }
  // By the time of reception: a sensor's clock may differ, and decay runs by this one.
  const Result<VoxelScan> scan = grids_[message.grid]->insert(*publisher_, std::span<const double>(message.points),
                                                              pose.position, std::chrono::nanoseconds(message.came_ns));
  if (!scan) {
    ++counts_.unsent;
    tell(scan.error().message);
    return;
  }
  ++counts_.clouds;
  counts_.points += scan->points;
  counts_.not_finite += scan->refused;
  counts_.dropped += scan->dropped;
}

/// The cells of a map are along the axes of its frame, those here along the world's.
void LiveClouds::put_map(Waiting& message, const Pose& pose) {
  if (!is_upright(pose)) return refuse("a map whose frame is turned in '" + options_.fixed + "'");
  std::optional<PublishedVoxels>& grid = grids_[message.grid];
  if (!grid) {
    VoxelOptions options = options_.voxels;
    options.cell_m = message.cell_m;
    options.decay = {};  // a map states its own content
    Result<PublishedVoxels> made =
        PublishedVoxels::start(*publisher_, options_.maps[message.grid - options_.clouds.size()], options);
    if (!made) return refuse(made.error().message);
    grid.emplace(std::move(*made));
  }
  const double cell_m = grid->grid().cell_m();
  if (std::abs(cell_m - message.cell_m) > 1e-6 * cell_m)
    return refuse("a map of cells of another size than the first one's");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double cells = pose.position[static_cast<int>(axis)] / cell_m;
    const double whole = std::nearbyint(cells);
    if (std::abs(cells - whole) > 1e-6 * std::max(1.0, std::abs(cells)) || std::abs(whole) > 1e6)
      return refuse("a map whose frame stands beside the world's grid of cells");
    for (VoxelBlock& block : message.blocks) block.low[axis] += static_cast<std::int32_t>(whole);
  }
  const Result<VoxelScan> scan = grid->assign(*publisher_, message.blocks, std::chrono::nanoseconds(message.came_ns));
  if (!scan) {
    ++counts_.unsent;
    tell(scan.error().message);
    return;
  }
  ++counts_.maps;
  counts_.dropped += scan->dropped;
}

std::size_t LiveClouds::occupied_count() const {
  std::size_t count = 0;
  for (const std::optional<PublishedVoxels>& grid : grids_) count += grid ? grid->grid().occupied_count() : 0;
  return count;
}

}  // namespace collided::ros
