#pragma once

#include <cstdint>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <collided/geometry.hpp>

namespace collided::ros {

/// The instant of a chain of static frames: it holds at all times.
inline constexpr std::int64_t kAlways = std::numeric_limits<std::int64_t>::max();

/// Frames known by their pose in a parent frame, each over the last seconds: ROS calls this tf. A frame has one parent
/// at a time; between two instants its pose is interpolated, beyond the newest it is unknown.
///
/// source   Foote, "tf: The transform library", 2013
/// limits   kMostFrames frames; of each kMostInstants instants, none older than kHistoryNs before its newest
/// threads  one at a time
class FrameTree {
 public:
  static constexpr std::size_t kMostFrames = 10'000;
  static constexpr std::size_t kMostInstants = 4'096;
  static constexpr std::int64_t kHistoryNs = 10'000'000'000;

  /// The outcome for a pose. unnamed: a name is empty, or both are the same. bad: it is not finite, or its quaternion's
  /// norm is not 1 within 1e-3. loop: the child is an ancestor of the parent. late: older than the history. full: a new
  /// frame beyond the limit.
  enum class TransformFate { yes, unnamed, bad, loop, late, full };

  /// Sets a frame's pose in its parent at an instant, in nanoseconds since 1970; kAlways: it is static. A leading slash
  /// of a name is ignored. A new parent discards the frame's history.
  TransformFate set(std::string_view parent, std::string_view child, std::int64_t stamp_ns, const Pose& X_PC);

  /// The newest instant at which one frame's pose in another is known; kAlways if both are at rest relative to each
  /// other. Nothing if a name is unknown or nothing connects the two.
  std::optional<std::int64_t> newest_common(std::string_view fixed, std::string_view frame) const;
  /// The pose of a frame in another one at an instant; nothing if it is unknown then.
  std::optional<Pose> lookup(std::string_view fixed, std::string_view frame, std::int64_t stamp_ns) const;

  bool has(std::string_view frame) const { return find(frame) != kNone; }
  /// Names of all frames, including roots.
  const std::vector<std::string>& names() const { return names_; }

 private:
  static constexpr std::uint32_t kNone = 0xffffffff;
  struct StampedPose {
    std::int64_t stamp_ns = 0;
    Pose X_PC;
  };
  struct KnownFrame {
    std::uint32_t parent = kNone;
    std::deque<StampedPose> instants;  // ascending; a single one for a static frame, at kAlways
  };
  /// The frames from each of two up to, but without, their first common ancestor.
  struct Chains {
    std::vector<std::uint32_t> of_fixed, of_frame;
  };

  std::uint32_t find(std::string_view name) const;
  std::uint32_t found_or_made(std::string_view name);
  bool is_above(std::uint32_t ancestor, std::uint32_t frame) const;
  std::optional<Chains> chains(std::string_view fixed, std::string_view frame) const;
  static std::optional<Pose> at(const KnownFrame& frame, std::int64_t stamp_ns);
  std::optional<Pose> along(const std::vector<std::uint32_t>& chain, std::int64_t stamp_ns) const;

  std::vector<KnownFrame> frames_;
  std::vector<std::string> names_;
  std::unordered_map<std::string, std::uint32_t> numbers_;
};

}  // namespace collided::ros
