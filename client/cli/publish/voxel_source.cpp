#include "client/cli/publish/voxel_source.hpp"

#include <charconv>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/files_program.hpp"
#include "client/cli/input/number.hpp"
#include "idl/clocks.hpp"

namespace collided::cli {
namespace {

std::vector<double> parse_points(std::string_view text) {
  std::vector<double> numbers;
  const char* at = text.data();
  const char* const end = at + text.size();
  while (at != end) {
    if (*at == ' ' || *at == '\n') {
      ++at;
      continue;
    }
    double number = 0;
    const auto [next, error] = std::from_chars(at, end, number);
    if (error != std::errc())
      throw Failure(Exit::refused, fmt::format("no number: '{}'", std::string(at, std::min(end, at + 40))));
    numbers.push_back(number);
    at = next;
  }
  return numbers;
}

class VoxelSource : public MotionSource {
 public:
  VoxelSource(const VoxelSourceOptions& options, std::vector<double> points)
      : options_(options), points_(std::move(points)) {}

  void begin(Session&, const Globals&, WorldPublisher& publisher) override {
    voxels_.emplace(take(PublishedVoxels::start(publisher.of_one_server(), options_.name, options_.voxels,
                                                options_.objects.layers, options_.objects.lost_policy)));
  }
  std::optional<double> next_time() override {
    return is_taken_ ? std::nullopt : std::optional<double>(static_cast<double>(frames_) / options_.rate_hz);
  }
  std::size_t move(WorldPublisher& publisher) override {
    scan_ = take(voxels_->insert(publisher.of_one_server(), std::span<const double>(points_), options_.origin,
                                 wire_contract::since_1970()));
    is_taken_ = true;
    ++frames_;
    // A missing block would be space that counts as free.
    if (const Result<void> applied = publisher.wait_applied(kPatience); !applied) throw as_failure(applied.error());
    return 0;
  }
  bool restart() override {
    is_taken_ = false;
    frames_ = 0;
    return true;
  }
  void report(Record& record, std::vector<std::string>& lines) const override {
    const VoxelGrid& grid = voxels_->grid();
    record.insert(record.end(), {{"points", std::uint64_t{scan_.points}},
                                 {"far", std::uint64_t{scan_.far}},
                                 {"dropped", std::uint64_t{scan_.dropped}},
                                 {"cell", grid.cell_m()},
                                 {"occupied", std::uint64_t{grid.occupied_count()}},
                                 {"blocks", std::uint64_t{grid.block_count()}},
                                 {"objects", std::uint64_t{voxels_->object_count()}}});
    lines.push_back(fmt::format("{} in {} of {} m, as {}", counted(scan_.points, "point"),
                                counted(grid.occupied_count(), "occupied cell"), grid.cell_m(),
                                counted(voxels_->object_count(), "object")));
    if (scan_.far > 0) lines.push_back(fmt::format("  {} beyond --reach", counted(scan_.far, "point")));
    if (scan_.dropped > 0)
      lines.push_back(fmt::format("  warning  {} in blocks beyond the limit", counted(scan_.dropped, "point")));
  }
  std::uint64_t refused_count() const override { return scan_.refused; }

 private:
  VoxelSourceOptions options_;
  std::vector<double> points_;
  std::optional<PublishedVoxels> voxels_;
  VoxelScan scan_;
  std::uint64_t frames_ = 0;
  bool is_taken_ = false;
};

}  // namespace

std::unique_ptr<MotionSource> make_voxel_source(const Io& io, const VoxelSourceOptions& options) {
  return std::make_unique<VoxelSource>(options, parse_points(files_program_output(io, {"points", options.path})));
}

}  // namespace collided::cli
