#include "client/cli/publish/path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/line_reader.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/output/text_row.hpp"
#include "client/cli/session.hpp"

namespace collided::cli {
namespace {

constexpr std::size_t kMostPoints = 10'000'000;

/// The numbers of the cells that are x, y and z, from the header.
std::array<std::size_t, 3> coordinate_cells(const std::vector<std::string>& header, const std::string& where) {
  std::array<std::size_t, 3> cells{};
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto found = std::find(header.begin(), header.end(), kNames[axis]);
    if (found == header.end()) throw bad_use(fmt::format("{}: no column '{}'", where, kNames[axis]));
    cells[axis] = static_cast<std::size_t>(found - header.begin());
  }
  return cells;
}

Vec3 read_point(const std::vector<std::string>& cells, const std::array<std::size_t, 3>& of_axis,
                const std::string& where) {
  Vec3 point;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (of_axis[axis] >= cells.size())
      throw bad_use(fmt::format("{}: {} cells, no column {}", where, cells.size(), "xyz"[axis]));
    try {
      point[static_cast<int>(axis)] = parse_finite(cells[of_axis[axis]], Measure::length);
    } catch (const Failure&) {
      throw bad_use(fmt::format("{}: '{}' in column {}", where, printable(cells[of_axis[axis]]), "xyz"[axis]));
    }
  }
  return point;
}

class PathSource : public MotionSource {
 public:
  PathSource(std::vector<Vec3> points, const PathOptions& options) : options_(options), path_(std::move(points)) {
    frame_count_ = static_cast<std::uint64_t>(std::ceil(path_.length_m() / options.speed_m_s * options.rate_hz)) + 1;
  }

  void begin(Session&, const Globals&, WorldPublisher& publisher) override {
    ObjectOptions object;
    object.name = options_.name;
    object.shape = {options_.shape};
    object.pose = pose_at(0);
    object.layers = options_.objects.layers;
    object.mask = options_.objects.mask;
    object.lost_policy = options_.objects.lost_policy;
    object.solid = options_.objects.solid;
    object.solid_by_winding = options_.objects.solid_by_winding;
    object_ = take(publisher.add(object));
    if (object.solid) take(publisher.wait_applied(kPatience));
  }

  std::optional<double> next_time() override {
    if (frame_ >= frame_count_) return std::nullopt;
    return static_cast<double>(frame_) / options_.rate_hz;
  }

  std::size_t move(WorldPublisher& publisher) override {
    moved(publisher.move(object_, pose_at(static_cast<double>(frame_++) / options_.rate_hz * options_.speed_m_s)));
    return 1;
  }

  bool restart() override {
    frame_ = 0;
    return true;
  }

  void report(Record& record, std::vector<std::string>& lines) const override {
    const double flown =
        std::min(path_.length_m(), static_cast<double>(frame_) / options_.rate_hz * options_.speed_m_s);
    record.push_back({"length", path_.length_m()});
    record.push_back({"flown", flown});
    lines.push_back(fmt::format("  {} of {} m", format_number(flown), format_number(path_.length_m())));
  }

 private:
  Pose pose_at(double along_m) const {
    Pose pose;
    pose.position = path_.at(along_m);
    if (options_.face_forward)
      pose.rotation = Quat::FromTwoVectors(Vec3::UnitX(), path_.direction(along_m)).normalized();
    return pose;
  }

  PathOptions options_;
  Path path_;
  Publisher::Object object_ = 0;
  std::uint64_t frame_ = 0;
  std::uint64_t frame_count_ = 0;
};

}  // namespace

Path::Path(std::vector<Vec3> points) : points_(std::move(points)) {
  if (points_.size() < 2) throw bad_use(fmt::format("a path takes 2 points or more; {} given", points_.size()));
  distance_m_.push_back(0);
  for (std::size_t at = 1; at < points_.size(); ++at)
    distance_m_.push_back(distance_m_.back() + (points_[at] - points_[at - 1]).norm());
  const bool has_length = length_m() > 0 && std::isfinite(length_m());
  if (!has_length) throw bad_use(fmt::format("a path of length {}", format_number(length_m())));
}

/// The segment at a distance from the start; never one of length 0, except past the end.
std::size_t Path::segment(double along_m) const {
  const auto after = std::upper_bound(distance_m_.begin(), distance_m_.end(), along_m);
  const auto index = static_cast<std::size_t>(after - distance_m_.begin());
  return std::clamp<std::size_t>(index, 1, points_.size() - 1) - 1;
}

Vec3 Path::at(double along_m) const {
  if (!(along_m > 0)) return points_.front();
  if (along_m >= length_m()) return points_.back();
  const std::size_t index = segment(along_m);
  const double fraction = (along_m - distance_m_[index]) / (distance_m_[index + 1] - distance_m_[index]);
  return points_[index] + (points_[index + 1] - points_[index]) * fraction;
}

Vec3 Path::direction(double along_m) const {
  std::size_t index = segment(std::clamp(along_m, 0.0, std::nextafter(length_m(), 0.0)));
  return (points_[index + 1] - points_[index]).normalized();
}

std::vector<Vec3> parse_waypoints(std::string_view text) {
  std::vector<Vec3> points;
  std::size_t begin = text.find_first_not_of(' ');
  while (begin != std::string_view::npos) {
    const std::size_t end = std::min(text.find_first_of(" ;", begin), text.size());
    points.push_back(parse_vector(text.substr(begin, end - begin), Measure::length));
    begin = text.find_first_not_of(" ;", end);
  }
  return points;
}

std::vector<Vec3> read_waypoints(Io& io, const std::string& path) {
  const InputFile file(path, io.in);
  LineReader lines(file.descriptor());
  std::string text;
  std::vector<std::string> cells;
  std::array<std::size_t, 3> of_axis{0, 1, 2};
  std::vector<Vec3> points;
  char separator = 0;
  while (lines.next(text)) {
    if (is_blank_line(text)) continue;
    const std::string where = fmt::format("{} line {}", file.name(), lines.line_number());
    const bool first = separator == 0;
    if (first) separator = sniff_separator(text);
    split_cells(text, separator, cells);
    if (first && !is_number_text(cells.front())) {
      of_axis = coordinate_cells(cells, where);
      continue;
    }
    if (points.size() >= kMostPoints) throw bad_use(fmt::format("{}: more than {} points", where, kMostPoints));
    points.push_back(read_point(cells, of_axis, where));
  }
  return points;
}

std::unique_ptr<MotionSource> make_path_source(std::vector<Vec3> points, bool closed, const PathOptions& options) {
  if (closed && !points.empty() && points.front() != points.back()) points.push_back(points.front());
  return std::make_unique<PathSource>(std::move(points), options);
}

}  // namespace collided::cli
