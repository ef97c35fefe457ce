#include "tests/oracle/brute_force.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "server/exact_phase/distance/closest.hpp"
#include "server/exact_phase/distance/contact.hpp"
#include "server/exact_phase/distance/half_space.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/exact_phase/given/given_ray.hpp"
#include "server/exact_phase/overlap/overlap.hpp"
#include "server/exact_phase/ray/ray_cast.hpp"
#include "server/geometry/placing_error.hpp"
#include "server/world/objects/object_placing.hpp"
#include "server/world/query/underflow.hpp"

namespace collided::oracle {
using namespace engine;
namespace {

bool may_answer(const Snapshot& snapshot, const Questions& questions, ObjectId id) {
  return (snapshot.objects[slot_of(id)]->filter.layers & questions.mask) != 0;
}

const std::string& name_of(const Snapshot& snapshot, ObjectId id) { return snapshot.objects[slot_of(id)]->name; }

/// What is equally far or deep stands by name, then by triangle.
bool precedes(const Snapshot& snapshot, const AnswerHit& a, const AnswerHit& b) {
  return std::pair(name_of(snapshot, a.object), a.triangle) < std::pair(name_of(snapshot, b.object), b.triangle);
}

struct RayFound {
  AnswerHit hit;
  const Part* part;
  double placing_m;  // along the ray

  /// What was first is decided among placed parts; what is told holds for where they truly are.
  AnswerHit told() const {
    AnswerHit wide = hit;
    wide.error_m += placing_m;
    return wide;
  }
};

bool earlier(const Snapshot& snapshot, const Ray& ray, const RayFound& a, const RayFound& b) {
  const auto* ta = std::get_if<Triangle>(&a.part->shape);
  const auto* tb = std::get_if<Triangle>(&b.part->shape);
  const bool apart = a.hit.distance_m + a.hit.error_m < b.hit.distance_m - b.hit.error_m ||
                     b.hit.distance_m + b.hit.error_m < a.hit.distance_m - a.hit.error_m;
  if (!apart && ta != nullptr && tb != nullptr) {
    const int order = compare_hits(ray, *ta, *tb);
    if (order != 0) return order < 0;
  } else if (a.hit.distance_m != b.hit.distance_m) {
    return a.hit.distance_m < b.hit.distance_m;
  }
  return precedes(snapshot, a.hit, b.hit);
}

/// Of the triangle, or of all primitives that the part is one of.
double placing_of_object(const Snapshot& snapshot, const Part& part, const Aabb& asked) {
  if (part.frame == nullptr) return 0;
  const Placed object{.info = snapshot.objects[slot_of(part.object)].get(), .frame = *part.frame, .bounds = {}};
  return placing_error_m(object, part.triangle, asked);
}

GivenPart given(const Part& part) {
  if (part.pose == nullptr) return {};
  if (const auto* triangle = std::get_if<Triangle>(&part.own))
    return {.own = *triangle, .pose = part.pose, .frame = part.frame.get()};
  return {.own = &std::get<Primitive>(part.own), .pose = part.pose, .frame = part.frame.get()};
}

ConvexPart placed(const Part& part) {
  return std::visit([](const auto& shape) -> ConvexPart { return shape; }, part.shape);
}

/// Whether the ray meets the part for the numbers given: by rationals, wherever double has it within a sphere about the part.
bool meets(const Ray& ray, const Part& part, RayHit& hit) {
  const GivenPart as_given = given(part);
  const double off_m = as_given.placing_error_m(ray.origin.lpNorm<1>());
  const ConvexPart in_world = placed(part);
  const ExactResult found = std::visit(
      [&](const auto& shape) {
        return cast_ray_as_given(
            ray, shape, off_m, [&] { return as_given; }, hit);
      },
      part.shape);
  if (off_m == 0) return found.yes();
  const Aabb box = bounds_of_part(in_world);
  const Vec3 middle = (box.low + box.high) / 2;
  const double passes_m = (middle - ray.origin).cross(ray.direction).norm() / ray.direction.norm();
  if (passes_m > (box.high - box.low).norm() && half_space_of(in_world) == nullptr) return found.yes();
  RayHit unread;
  const ExactResult exact = ray_as_given(ray, in_world, as_given, off_m, found, unread);
  return exact.yes();
}

std::vector<AnswerHit> ray(const std::vector<Part>& parts, const Snapshot& snapshot, const Questions& questions,
                           const double* n) {
  const Ray asked{.origin = {n[0], n[1], n[2]}, .direction = {n[3], n[4], n[5]}, .length_m = n[6]};
  std::vector<RayFound> found;
  for (const Part& part : parts) {
    if (!may_answer(snapshot, questions, part.object)) continue;
    RayHit hit;
    if (!meets(asked, part, hit)) continue;
    AnswerHit answer{.object = part.object, .triangle = part.triangle};
    answer.flags = hit.inside ? kHitInside : 0;
    answer.distance_m = hit.distance_m;
    answer.error_m = hit.distance_error_m;
    answer.exit_m = hit.exit_m;
    answer.point = hit.point;
    answer.normal = hit.normal;
    answer.weights = hit.weights;
    const double placing_m = hit.distance_m > 0 ? part.placing_m(asked.origin, hit.distance_m) : 0;
    found.push_back({answer, &part, placing_error_along(asked, hit, placing_m, std::get_if<Triangle>(&part.shape))});
  }
  std::vector<AnswerHit> hits;
  if (questions.mode == HitMode::closest) {
    const auto first = std::min_element(found.begin(), found.end(),
                                        [&](const auto& a, const auto& b) { return earlier(snapshot, asked, a, b); });
    if (first != found.end()) hits.push_back(first->told());
    return hits;
  }
  for (const RayFound& f : found) hits.push_back(f.told());
  std::sort(hits.begin(), hits.end(), [&](const AnswerHit& a, const AnswerHit& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : precedes(snapshot, a, b);
  });
  return hits;
}

/// Whether two parts meet for the numbers given: by rationals wherever their bounds meet, or are apart by no more than
/// placing may be off.
bool meet(const ConvexPart& a, const GivenPart& given_a, const ConvexPart& b, const GivenPart& given_b) {
  if (given_a.pose == nullptr && given_b.pose == nullptr) return overlaps(a, b).yes();
  Aabb near = bounds_of_part(a);
  const Vec3 margin = Vec3::Constant(1e-12 * near.low.cwiseAbs().cwiseMax(near.high.cwiseAbs()).maxCoeff());
  near.low -= margin;
  near.high += margin;
  if (!overlaps(near, bounds_of_part(b))) return false;
  const Decision decision = overlaps_as_given(a, b, {given_a, given_b});
  return decision == Decision::undecided ? overlaps(a, b).yes() : decision == Decision::yes;
}

/// The contact of two that meet; where they are apart as placed, their nearest points.
Contact contact_of(const ConvexPart& a, const ConvexPart& b) {
  if (overlaps(a, b).yes()) return contact(a, b);
  const Separation apart = separation(a, b);
  return {.point = apart.on_a, .normal = apart.normal, .depth_error_m = apart.distance_m + apart.error_m};
}

template <class Asked>
std::vector<AnswerHit> overlap(const std::vector<Part>& parts, const Snapshot& snapshot, const Questions& questions,
                               const Asked& asked, const GivenPart& given_asked) {
  const ConvexPart whole = Primitive(asked);
  std::map<ObjectId, AnswerHit> deepest;
  for (const Part& part : parts) {
    if (!may_answer(snapshot, questions, part.object)) continue;
    const ConvexPart shape = placed(part);
    if (!meet(whole, given_asked, shape, given(part))) continue;
    const Contact touched = contact_of(whole, shape);
    AnswerHit hit{.object = part.object, .triangle = part.triangle};
    hit.distance_m = touched.depth_m;
    hit.error_m = touched.depth_error_m + placing_of_object(snapshot, part, bounds(asked));
    if (given_asked.pose != nullptr) hit.error_m += given_asked.placing_error_m(0);
    hit.point = touched.point;
    hit.normal = touched.normal;
    const auto [place, is_new] = deepest.emplace(part.object, hit);
    const bool deeper = hit.distance_m > place->second.distance_m ||
                        (hit.distance_m == place->second.distance_m && hit.triangle < place->second.triangle);
    if (!is_new && deeper) place->second = hit;
  }
  std::vector<AnswerHit> hits;
  for (const auto& [object, hit] : deepest) hits.push_back(hit);
  std::sort(hits.begin(), hits.end(), [&](const AnswerHit& a, const AnswerHit& b) {
    return a.distance_m != b.distance_m ? a.distance_m > b.distance_m : precedes(snapshot, a, b);
  });
  return hits;
}

std::vector<AnswerHit> near(const std::vector<Part>& parts, const Snapshot& snapshot, const Questions& questions,
                            const double* n) {
  std::map<ObjectId, AnswerHit> nearest;
  const Vec3 point{n[0], n[1], n[2]};
  for (const Part& part : parts) {
    if (!may_answer(snapshot, questions, part.object)) continue;
    const Closest found = std::visit([&](const auto& shape) { return closest(point, shape); }, part.shape);
    const auto is_within = [&](double radius_m) {
      return meet(Primitive(Sphere{.center = point, .radius_m = radius_m}), {}, placed(part), given(part));
    };
    if (!std::isinf(n[3]) && !is_within(n[3])) continue;
    AnswerHit hit{.object = part.object, .triangle = part.triangle};
    const bool is_held = !std::holds_alternative<Triangle>(part.shape) && is_within(0);
    hit.flags = is_held ? kHitInside : 0;
    hit.distance_m = is_held ? 0 : found.distance_m;
    hit.error_m = is_held ? 0 : with_underflow(found.distance_m, found.distance_error_m + part.placing_m(point));
    hit.point = is_held ? point : found.point;
    hit.normal = found.normal;
    const auto [place, is_new] = nearest.emplace(part.object, hit);
    if (!is_new &&
        std::pair(hit.distance_m, hit.triangle) < std::pair(place->second.distance_m, place->second.triangle)) {
      place->second = hit;
    }
  }
  std::vector<AnswerHit> hits;
  for (const auto& [object, hit] : nearest) hits.push_back(hit);
  std::sort(hits.begin(), hits.end(), [&](const AnswerHit& a, const AnswerHit& b) {
    return a.distance_m != b.distance_m ? a.distance_m < b.distance_m : precedes(snapshot, a, b);
  });
  if (hits.size() > questions.max_hits) hits.resize(questions.max_hits);
  return hits;
}

}  // namespace

double Part::placing_m(const Vec3& point, double beyond_m) const {
  if (frame == nullptr) return 0;
  if (const auto* face = std::get_if<Triangle>(&own)) return placing_error_m(*frame, *face);
  return placing_error_m(*frame, std::get<Primitive>(own), (point - frame->position).lpNorm<1>() + beyond_m);
}

std::vector<Part> all_parts(const Snapshot& snapshot) {
  std::vector<Part> parts;
  for (const auto& scene : snapshot.scenes) {
    for (std::uint32_t t = 0; t < scene->mesh.triangles.size(); ++t) {
      std::uint32_t number = 0;
      while (t >= scene->parts[number].first_triangle + scene->parts[number].triangle_count) ++number;
      parts.push_back(
          {scene->part_objects[number], t - scene->parts[number].first_triangle, scene->mesh.triangle(t), {}});
    }
  }
  for (const auto& info : snapshot.objects) {
    if (!info) continue;
    const auto kept = std::make_shared<const Frame>(snapshot.frame(slot_of(info->id)));
    const Frame& frame = *kept;
    const Pose* pose = snapshot.has_given_poses ? &snapshot.poses[slot_of(info->id)] : nullptr;
    for (const Primitive& primitive : info->primitives) {
      std::visit(
          [&](const auto& own) {
            parts.push_back({info->id, kNoTriangle, place(frame, own), primitive, kept, pose});
          },
          primitive);
    }
    if (!info->mesh) continue;
    for (std::uint32_t t = 0; t < info->mesh->mesh->triangles.size(); ++t) {
      const Triangle own = info->mesh->mesh->triangle(t);
      parts.push_back({info->id, t, place(frame, own), own, kept, pose});
    }
  }
  return parts;
}

void answer(const Snapshot& snapshot, const Questions& questions, Answers& answers) {
  answers = {};
  const std::vector<Part> parts = all_parts(snapshot);
  const std::size_t stride = questions.kind == QuestionKind::ray      ? kRayNumbers
                             : questions.kind == QuestionKind::sphere ? kSphereNumbers
                             : questions.kind == QuestionKind::box    ? kBoxNumbers
                                                                      : kNearNumbers;
  for (const double* n = questions.numbers.data(); n != questions.numbers.data() + questions.numbers.size();
       n += stride) {
    std::vector<AnswerHit> hits;
    if (questions.kind == QuestionKind::ray) {
      hits = ray(parts, snapshot, questions, n);
    } else if (questions.kind == QuestionKind::sphere) {
      hits = overlap(parts, snapshot, questions, Sphere{.center = {n[0], n[1], n[2]}, .radius_m = n[3]}, {});
    } else if (questions.kind == QuestionKind::box) {
      const Pose pose{.position = {n[0], n[1], n[2]}, .rotation = Quat(n[6], n[7], n[8], n[9])};
      const Frame frame = frame_of(pose);
      const Primitive own = Box{.center = Vec3::Zero(), .half_m = {n[3], n[4], n[5]}};
      hits = overlap(parts, snapshot, questions,
                     Box{.center = pose.position, .axes = frame.rotation, .half_m = {n[3], n[4], n[5]}},
                     {.own = &own, .pose = &pose, .frame = &frame});
    } else {
      hits = near(parts, snapshot, questions, n);
    }
    answers.answers.push_back(hits.empty() ? Verdict::miss : Verdict::hit);
    answers.reasons.push_back(UndecidedReason::none);
    answers.hit_counts.push_back(static_cast<std::uint32_t>(hits.size()));
    answers.hits.insert(answers.hits.end(), hits.begin(), hits.end());
  }
}

std::set<std::pair<ObjectId, ObjectId>> touching_pairs(const Snapshot& snapshot) {
  const std::vector<Part> parts = all_parts(snapshot);
  std::set<std::pair<ObjectId, ObjectId>> pairs;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    for (std::size_t j = i + 1; j < parts.size(); ++j) {
      const ObjectId a = std::min(parts[i].object, parts[j].object);
      const ObjectId b = std::max(parts[i].object, parts[j].object);
      const ObjectInfo& info_a = *snapshot.objects[slot_of(a)];
      const ObjectInfo& info_b = *snapshot.objects[slot_of(b)];
      if (a == b || (!info_a.moving && !info_b.moving) || !may_meet(info_a, info_b)) continue;
      if (meet(placed(parts[i]), given(parts[i]), placed(parts[j]), given(parts[j]))) pairs.emplace(a, b);
    }
  }
  return pairs;
}

}  // namespace collided::oracle
