#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "client/draw/drawing/features.hpp"

namespace collided::draw {

/// Asks a server the questions of a drawing, and counts them. Every call throws Error if the server does not answer.
/// One thread.
class Rays {
 public:
  /// options  which objects are visible and hide others: only, skip, mask; and the timeout
  Rays(Client& client, AskOptions options) : client_(client), options_(std::move(options)) {}

  /// The first hit of each ray, in batches of 20,000, each about one state of the world.
  std::vector<Answer> first_hits(std::span<const RayQuestion> rays);
  /// By ray: 1 if it hits nothing.
  std::vector<std::uint8_t> are_free(std::span<const RayQuestion> rays);
  /// The nearest object for each question, except those whose names match `skip`.
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

/// A straight part of a line, clipped to the picture.
struct LineSegment {
  Vec3 a;
  Vec3 b;
  ImagePoint image_a;
  ImagePoint image_b;
  LineKind kind = LineKind::crease;
  std::uint32_t object = 0;
  std::uint32_t line = 0;  // number of the line; its segments follow each other

  double length_px() const;
  /// The point in the world that appears at this fraction of the image.
  Vec3 at(const Camera& camera, double fraction) const;
};

/// The segments of lines, clipped to the picture.
std::vector<LineSegment> segments_in_picture(std::span<const FeatureLine> lines, const Camera& camera);

/// A piece of a segment, between two fractions of its image, that is visible throughout or hidden throughout.
struct Piece {
  std::uint32_t segment = 0;
  double from = 0;
  double to = 1;
  bool is_seen = true;
};

/// How closely visibility is sampled.
struct SightOptions {
  double spacing_px = 1;      // between samples; shorter pieces may be missed
  double precision_px = 0.1;  // of the place where it changes
  double bias_px = 0.01;      // by which a sample is moved towards the eye
};

/// Decides which pieces of segments are visible: by samples along every segment, and where two neighbours differ, by
/// bisection between them. A sample is visible if the ray from in front of it to the eye hits nothing. Undecided
/// answers count as visible.
/// cost  a ray for each sample, and log2(spacing / precision) for each change
std::vector<Piece> seen_pieces(std::span<const LineSegment> segments, const Camera& camera, Rays& rays,
                               const SightOptions& options = {});

/// The ray that decides whether a point is visible. It begins bias_px in front of it, or more if rounding requires it.
RayQuestion sight_of(const Vec3& point, const Camera& camera, double bias_px);

}  // namespace collided::draw
