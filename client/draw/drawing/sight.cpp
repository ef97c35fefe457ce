#include "client/draw/drawing/sight.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <future>

namespace collided::draw {

namespace {

/// Questions in a request.
constexpr std::size_t kBatch = 20'000;
constexpr std::size_t kBatchesInFlight = 4;

/// The rounding in computing a point on an edge, as a fraction of the largest coordinate, is below this.
constexpr double kPointRounding = 16 * 0x1p-52;

/// The samples of one segment, each in the middle of an interval, and whether each is visible.
struct Samples {
  std::uint32_t segment;
  std::size_t first;
  int count;
};

/// An interval between two samples that differ, for bisection.
struct Bracket {
  std::uint32_t segment;
  double seen_at;
  double hidden_at;
  double length_px;
};

std::vector<Bracket> brackets_of(std::span<const LineSegment> segments, const std::vector<Samples>& all,
                                 const std::vector<std::uint8_t>& seen) {
  std::vector<Bracket> brackets;
  for (const Samples& samples : all) {
    for (int i = 1; i < samples.count; ++i) {
      const std::size_t k = samples.first + static_cast<std::size_t>(i);
      if (seen[k] == seen[k - 1]) continue;
      const double before = (i - 0.5) / samples.count;
      const double after = (i + 0.5) / samples.count;
      brackets.push_back({samples.segment, seen[k] != 0 ? after : before, seen[k] != 0 ? before : after,
                          segments[samples.segment].length_px()});
    }
  }
  return brackets;
}

void halve(std::vector<Bracket>& brackets, std::span<const LineSegment> segments, const Camera& camera, Rays& rays,
           const SightOptions& options) {
  const auto is_wide = [&](const Bracket& b) {
    return std::abs(b.seen_at - b.hidden_at) * b.length_px > options.precision_px;
  };
  while (true) {
    std::vector<RayQuestion> questions;
    std::vector<std::size_t> whose;
    for (std::size_t i = 0; i < brackets.size(); ++i) {
      if (!is_wide(brackets[i])) continue;
      const double middle = (brackets[i].seen_at + brackets[i].hidden_at) / 2;
      questions.push_back(sight_of(segments[brackets[i].segment].at(camera, middle), camera, options.bias_px));
      whose.push_back(i);
    }
    if (questions.empty()) return;
    const std::vector<std::uint8_t> seen = rays.are_free(questions);
    for (std::size_t i = 0; i < whose.size(); ++i) {
      Bracket& b = brackets[whose[i]];
      (seen[i] != 0 ? b.seen_at : b.hidden_at) = (b.seen_at + b.hidden_at) / 2;
    }
  }
}

}  // namespace

template <class Question>
std::vector<Answer> Rays::ask(std::span<const Question> questions, const AskOptions& options) {
  std::vector<Answer> all;
  all.reserve(questions.size());
  std::deque<std::future<Result<Answers>>> under_way;
  std::size_t next = 0;
  while (next < questions.size() || !under_way.empty()) {
    while (next < questions.size() && under_way.size() < kBatchesInFlight) {
      const auto batch = questions.subspan(next, std::min(kBatch, questions.size() - next));
      under_way.push_back(client_.ask_async(std::vector<Question>(batch.begin(), batch.end()), options));
      next += batch.size();
    }
    Result<Answers> answers = under_way.front().get();
    under_way.pop_front();
    if (!answers) throw answers.error();
    for (Answer& answer : answers->answers) {
      undecided_ += answer.verdict == Verdict::undecided || answer.verdict == Verdict::invalid ? 1 : 0;
      all.push_back(std::move(answer));
    }
  }
  asked_ += questions.size();
  return all;
}

std::vector<Answer> Rays::first_hits(std::span<const RayQuestion> rays) { return ask(rays, options_); }

std::vector<std::uint8_t> Rays::are_free(std::span<const RayQuestion> rays) {
  AskOptions verdict = options_;
  verdict.mode = HitMode::verdict;
  std::vector<std::uint8_t> free;
  free.reserve(rays.size());
  for (const Answer& answer : ask(rays, verdict)) free.push_back(answer.verdict == Verdict::hit ? 0 : 1);
  return free;
}

std::vector<Answer> Rays::nearest(std::span<const NearQuestion> questions, const std::string& skip) {
  AskOptions others = options_;
  others.skip = skip;
  others.max_hits = 1;
  return ask(questions, others);
}

double LineSegment::length_px() const { return std::hypot(image_b.x - image_a.x, image_b.y - image_a.y); }

Vec3 LineSegment::at(const Camera& camera, double fraction) const {
  const bool is_even = camera.is_orthographic();
  return Camera::at_image_fraction(a, b, is_even ? 1 : image_a.depth_m, is_even ? 1 : image_b.depth_m, fraction);
}

std::vector<LineSegment> segments_in_picture(std::span<const FeatureLine> lines, const Camera& camera) {
  std::vector<LineSegment> segments;
  for (std::uint32_t i = 0; i < lines.size(); ++i) {
    for (std::size_t k = 1; k < lines[i].points.size(); ++k) {
      const Vec3& from = lines[i].points[k - 1];
      const Vec3& to = lines[i].points[k];
      const auto shown = camera.clip(from, to);
      if (!shown) continue;
      const Vec3 a = shown->first == 0 ? from : Vec3(from + shown->first * (to - from));
      const Vec3 b = shown->second == 1 ? to : Vec3(from + shown->second * (to - from));
      segments.push_back({a, b, camera.project(a), camera.project(b), lines[i].kind, lines[i].object, i});
    }
  }
  return segments;
}

RayQuestion sight_of(const Vec3& point, const Camera& camera, double bias_px) {
  const double rounding_m = kPointRounding * std::max(point.cwiseAbs().maxCoeff(), camera.eye().cwiseAbs().maxCoeff());
  return camera.sight(point, std::max(bias_px * camera.pixel_m(point), rounding_m));
}

std::vector<Piece> seen_pieces(std::span<const LineSegment> segments, const Camera& camera, Rays& rays,
                               const SightOptions& options) {
  std::vector<Samples> all;
  std::vector<RayQuestion> questions;
  for (std::uint32_t i = 0; i < segments.size(); ++i) {
    const int count = std::max(1, static_cast<int>(std::ceil(segments[i].length_px() / options.spacing_px)));
    all.push_back({i, questions.size(), count});
    for (int k = 0; k < count; ++k)
      questions.push_back(sight_of(segments[i].at(camera, (k + 0.5) / count), camera, options.bias_px));
  }
  const std::vector<std::uint8_t> seen = rays.are_free(questions);
  std::vector<Bracket> brackets = brackets_of(segments, all, seen);
  halve(brackets, segments, camera, rays, options);
  std::vector<Piece> pieces;
  std::size_t next = 0;
  for (const Samples& samples : all) {
    double from = 0;
    bool is_seen = seen[samples.first] != 0;
    for (; next < brackets.size() && brackets[next].segment == samples.segment; ++next) {
      const double change = (brackets[next].seen_at + brackets[next].hidden_at) / 2;
      pieces.push_back({samples.segment, from, change, is_seen});
      from = change;
      is_seen = !is_seen;
    }
    pieces.push_back({samples.segment, from, 1, is_seen});
  }
  return pieces;
}

}  // namespace collided::draw
