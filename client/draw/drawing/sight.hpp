#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/draw/drawing/features.hpp"

namespace collided::draw {

/// Asks a server and counts. Throws Error. Threads: one.
class Rays {
 public:
  /// options  what may hide and be hit: only, skip, mask, timeout
  Rays(Client& client, AskOptions options) : client_(client), options_(std::move(options)) {}

  /// In batches of 20,000, each on one state of the world.
  std::vector<Answer> first_hits(std::span<const RayQuestion> rays);
  /// Whether each meets nothing; 1 where it does not.
  std::vector<std::uint8_t> are_free(std::span<const RayQuestion> rays);
  /// The nearest of what is not named so, up to within_m.
  std::vector<Answer> nearest(std::span<const NearQuestion> questions, const std::string& skip);

  std::uint64_t asked() const { return asked_; }
  std::uint64_t undecided() const { return undecided_; }

 private:
  template <class Question>
  std::vector<Answer> ask(std::span<const Question> questions, const AskOptions& options);

  Client& client_;
  AskOptions options_;
  std::uint64_t asked_ = 0;
  std::uint64_t undecided_ = 0;
};

/// A straight piece of a line, clipped to the picture.
struct Segment {
  Vec3 a;
  Vec3 b;
  ImagePoint image_a;
  ImagePoint image_b;
  LineKind kind = LineKind::crease;
  std::uint32_t object = 0;
  std::uint32_t line = 0;  // pieces of one line follow each other

  double length_px() const;
  /// In the world, where the image is at this fraction of its length.
  Vec3 at(const Camera& camera, double fraction) const;
};

std::vector<Segment> segments_in_picture(std::span<const FeatureLine> lines, const Camera& camera);

/// A piece of a segment between two fractions of its image that is seen, or is not.
struct Piece {
  std::uint32_t segment = 0;
  double from = 0;
  double to = 1;
  bool is_seen = true;
};

struct SightOptions {
  double spacing_px = 1;      // between samples: what is seen or hidden for less may be missed
  double precision_px = 0.1;  // of where it changes
  double bias_px = 0.01;      // of the point that is looked at, towards the eye
};

/// Which pieces the eye sees: samples along every segment, and where two neighbours differ, the place between by
/// bisection. A sample is seen when the ray from it, less the bias, to the eye meets nothing. What the server leaves
/// undecided counts as seen. cost  a ray a sample, and log2(spacing / precision) a change
std::vector<Piece> seen_pieces(std::span<const Segment> segments, const Camera& camera, Rays& rays,
                               const SightOptions& options = {});

/// The ray that decides about a point: from bias_px before it to the eye, or further where rounding needs more.
RayQuestion sight_of(const Vec3& point, const Camera& camera, double bias_px);

}  // namespace collided::draw
