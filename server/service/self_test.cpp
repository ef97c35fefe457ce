#include "server/service/self_test.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "server/exact_phase/overlap.hpp"
#include "server/exact_phase/ray_cast.hpp"
#include "server/world/query.hpp"

namespace collided::service {
namespace {

using wire_contract::Answer;
using wire_contract::QueryKind;

/// Everything there is, placed in the world, without an index.
template <class Visit>
void visit_all(const Snapshot& snapshot, Visit&& visit) {
  for (const auto& scene : snapshot.scenes) {
    for (std::uint32_t i = 0; i < scene->mesh.triangles.size(); ++i) {
      const ObjectId part = scene->part_objects[scene->part_of(i)];
      if ((*snapshot.objects)[slot_of(part)]) visit(part, scene->mesh.triangle(i));
    }
  }
  for (const auto& info : *snapshot.objects) {
    if (!info) continue;
    const Frame& frame = snapshot.frames[slot_of(info->id)];
    for (const Primitive& primitive : info->primitives) {
      std::visit([&](const auto& shape) { visit(info->id, place(frame, shape)); }, primitive);
    }
    if (!info->mesh) continue;
    for (std::uint32_t i = 0; i < info->mesh->mesh->triangles.size(); ++i) {
      visit(info->id, place(frame, info->mesh->mesh->triangle(i)));
    }
  }
}

struct Nearest {
  double distance_m = 0;
  double error_m = 0;
};

std::optional<Nearest> cast_at_all(const Snapshot& snapshot, const Ray& ray) {
  std::optional<Nearest> nearest;
  visit_all(snapshot, [&](ObjectId, const auto& shape) {
    RayHit hit;
    if (!cast_ray(ray, shape, hit).yes()) return;
    if (!nearest || hit.distance_m < nearest->distance_m) nearest = Nearest{hit.distance_m, hit.distance_error_m};
  });
  return nearest;
}

template <class Asked>
std::vector<ObjectId> overlaps_of_all(const Snapshot& snapshot, const Asked& asked) {
  std::vector<ObjectId> found;
  visit_all(snapshot, [&](ObjectId id, const auto& shape) {
    if (overlaps(asked, shape).yes()) found.push_back(id);
  });
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Asks questions about a place a little larger than the world.
class Examiner {
 public:
  Examiner(const Snapshot& snapshot, std::uint64_t seed) : snapshot_(snapshot), random_(seed) {
    visit_all(snapshot, [&](ObjectId, const auto& shape) { extend(shape); });
    if (!(low_.array() <= high_.array()).all()) low_ = high_ = Vec3::Zero();
    const Vec3 margin = Vec3::Constant(0.1 * (high_ - low_).norm() + 1e-3);
    low_ -= margin;
    high_ += margin;
  }
  void ask_ray();
  void ask_sphere();
  void ask_box();
  SelfTestResult result;

 private:
  void extend(const Triangle& triangle) {
    for (const Vec3* corner : {&triangle.a, &triangle.b, &triangle.c}) extend(*corner);
  }
  void extend(const Sphere& sphere) { extend(sphere.center); }
  void extend(const Box& box) { extend(box.center); }
  void extend(const Capsule& capsule) { extend(capsule.a); }
  void extend(const Vec3& point) {
    low_ = low_.cwiseMin(point);
    high_ = high_.cwiseMax(point);
  }
  double unit() { return std::uniform_real_distribution<double>(0, 1)(random_); }
  Vec3 place() { return low_ + Vec3(unit(), unit(), unit()).cwiseProduct(high_ - low_); }
  double size() { return (high_ - low_).norm() * 0.05 * unit(); }
  const Answers& ask(QueryKind kind, const std::vector<double>& numbers);
  void compare(bool equal, const char* kind, const std::vector<double>& numbers, const std::string& difference);
  void compare_objects(const char* kind, const std::vector<double>& numbers, const std::vector<ObjectId>& expected);

  const Snapshot& snapshot_;
  std::mt19937_64 random_;
  Vec3 low_ = Vec3::Constant(INFINITY);
  Vec3 high_ = Vec3::Constant(-INFINITY);
  Answers answers_;
  QueryScratch scratch_;
};

const Answers& Examiner::ask(QueryKind kind, const std::vector<double>& numbers) {
  Questions questions;
  questions.kind = kind;
  questions.max_hits = 0xffffffff;
  questions.numbers = numbers;
  answer(snapshot_, questions, answers_, scratch_);
  return answers_;
}

void Examiner::compare(bool equal, const char* kind, const std::vector<double>& numbers,
                       const std::string& difference) {
  ++result.asked;
  if (equal) {
    ++result.equal;
  } else if (result.differences.size() < 5) {
    result.differences.push_back(fmt::format("{} {:.17g}: {}", kind, fmt::join(numbers, " "), difference));
  }
}

void Examiner::ask_ray() {
  const Vec3 origin = place();
  const Vec3 direction = place() - origin;
  if (direction.isZero()) return;
  const std::vector<double> numbers{origin.x(),    origin.y(),    origin.z(), direction.x(),
                                    direction.y(), direction.z(), INFINITY};
  const std::optional<Nearest> expected = cast_at_all(snapshot_, {origin, direction});
  const Answers& given = ask(QueryKind::ray, numbers);
  const bool hit = given.answers[0] == Answer::hit;
  const double distance_m = hit ? given.hits[0].distance_m : 0;
  const bool equal =
      expected ? hit && std::abs(distance_m - expected->distance_m) <= expected->error_m + given.hits[0].error_m
               : given.answers[0] == Answer::miss;
  compare(equal, "ray", numbers,
          fmt::format("brute force says {}, the index {}",
                      expected ? fmt::format("{:.17g} m", expected->distance_m) : "miss",
                      hit ? fmt::format("{:.17g} m", distance_m) : "miss or undecided"));
}

void Examiner::compare_objects(const char* kind, const std::vector<double>& numbers,
                               const std::vector<ObjectId>& expected) {
  std::vector<ObjectId> given;
  for (const AnswerHit& hit : answers_.hits) given.push_back(hit.object);
  std::sort(given.begin(), given.end());
  given.erase(std::unique(given.begin(), given.end()), given.end());
  compare(given == expected, kind, numbers,
          fmt::format("brute force finds {} objects, the index {}", expected.size(), given.size()));
}

void Examiner::ask_sphere() {
  const Sphere sphere{.center = place(), .radius_m = size()};
  const std::vector<double> numbers{sphere.center.x(), sphere.center.y(), sphere.center.z(), sphere.radius_m};
  ask(QueryKind::sphere, numbers);
  compare_objects("sphere", numbers, overlaps_of_all(snapshot_, sphere));
}

void Examiner::ask_box() {
  const Vec3 center = place();
  const Vec3 half_m(size(), size(), size());
  const std::vector<double> numbers{center.x(), center.y(), center.z(), half_m.x(), half_m.y(), half_m.z(), 1, 0, 0, 0};
  ask(QueryKind::box, numbers);
  compare_objects("box", numbers,
                  overlaps_of_all(snapshot_, Box{.center = center, .axes = Mat3::Identity(), .half_m = half_m}));
}

}  // namespace

SelfTestResult self_test(const Snapshot& snapshot, std::uint32_t question_count, std::uint64_t seed) {
  Examiner examiner(snapshot, seed);
  for (std::uint32_t i = 0; i < question_count; ++i) {
    examiner.ask_ray();
    examiner.ask_sphere();
    examiner.ask_box();
  }
  return examiner.result;
}

}  // namespace collided::service
