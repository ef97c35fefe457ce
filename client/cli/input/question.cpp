#include "client/cli/input/question.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/failure.hpp"
#include "client/cli/input/number.hpp"
#include "idl/topics.hpp"
#include "idl/unit_quaternion.hpp"

namespace collided::cli {
namespace {

constexpr std::array kRayColumns{QuestionColumn{"fx", "ox"},   QuestionColumn{"fy", "oy"}, QuestionColumn{"fz", "oz"},
                                 QuestionColumn{"dx", {}},     QuestionColumn{"dy", {}},   QuestionColumn{"dz", {}},
                                 QuestionColumn{"length", {}}, QuestionColumn{"tx", {}},   QuestionColumn{"ty", {}},
                                 QuestionColumn{"tz", {}}};
constexpr std::array kRayKeys{JsonKey{"from", column::kFrom, 3}, JsonKey{"dir", column::kDirection, 3},
                              JsonKey{"to", column::kTo, 3}, JsonKey{"length", column::kLength, 1}};
constexpr std::array kSphereColumns{QuestionColumn{"x", "cx"}, QuestionColumn{"y", "cy"}, QuestionColumn{"z", "cz"},
                                    QuestionColumn{"radius", "r"}};
constexpr std::array kSphereKeys{JsonKey{"center", column::kSphereCenter, 3}, JsonKey{"radius", column::kRadius, 1}};
constexpr std::array kBoxColumns{
    QuestionColumn{"lx", {}}, QuestionColumn{"ly", {}}, QuestionColumn{"lz", {}}, QuestionColumn{"hx", {}},
    QuestionColumn{"hy", {}}, QuestionColumn{"hz", {}}, QuestionColumn{"cx", {}}, QuestionColumn{"cy", {}},
    QuestionColumn{"cz", {}}, QuestionColumn{"sx", {}}, QuestionColumn{"sy", {}}, QuestionColumn{"sz", {}},
    QuestionColumn{"qw", {}}, QuestionColumn{"qx", {}}, QuestionColumn{"qy", {}}, QuestionColumn{"qz", {}}};
constexpr std::array kBoxKeys{JsonKey{"low", column::kLow, 3}, JsonKey{"high", column::kHigh, 3},
                              JsonKey{"center", column::kBoxCenter, 3}, JsonKey{"size", column::kSize, 3},
                              JsonKey{"quat", column::kQuaternion, 4}};
constexpr std::array kNearColumns{QuestionColumn{"x", "px"}, QuestionColumn{"y", "py"}, QuestionColumn{"z", "pz"},
                                  QuestionColumn{"reach", {}}};
constexpr std::array kNearKeys{JsonKey{"point", column::kPoint, 3}, JsonKey{"reach", column::kReach, 1}};

constexpr std::array kInsideColumns{QuestionColumn{"x", "px"}, QuestionColumn{"y", "py"}, QuestionColumn{"z", "pz"}};
constexpr std::array kInsideKeys{JsonKey{"point", column::kPoint, 3}};

const std::array<QuestionForm, kQuestionKinds> kForms{
    QuestionForm{"rays", kRayColumns, kRayKeys, 6, 7}, QuestionForm{"spheres", kSphereColumns, kSphereKeys, 4, 4},
    QuestionForm{"boxes", kBoxColumns, kBoxKeys, 6, 6}, QuestionForm{"points", kNearColumns, kNearKeys, 3, 4},
    QuestionForm{"points", kInsideColumns, kInsideKeys, 3, 3}};

void need_finite(const Vec3& vector, std::string_view what) {
  if (!vector.allFinite()) throw bad_use(fmt::format("{} {} must be finite", what, format_vector(vector)));
}

RayQuestion make_ray_question(const Numbers& numbers) {
  if (!numbers.has(column::kFrom, 3)) throw bad_use("where does the ray start? 3 numbers are needed");
  const bool has_direction = numbers.has(column::kDirection, 3);
  const bool has_target = numbers.has(column::kTo, 3);
  if (has_direction == has_target) {
    throw bad_use(has_target ? "a direction and a point to aim at exclude each other" : "where does the ray go?",
                  "give a direction after the start, or a point to aim at: to X Y Z");
  }
  RayQuestion ray;
  ray.origin = numbers.vector(column::kFrom);
  need_finite(ray.origin, "start");
  ray.direction = has_target ? Vec3(numbers.vector(column::kTo) - ray.origin) : numbers.vector(column::kDirection);
  need_finite(ray.direction, "direction");
  if (ray.direction == Vec3::Zero()) {
    if (has_target) throw bad_use(fmt::format("start and target are the same point, {}", format_vector(ray.origin)));
    throw bad_use("direction 0 0 0 has no direction", "use --to X Y Z to aim at a point");
  }
  if (numbers.has(column::kLength, 1)) ray.length_m = numbers.value[column::kLength];
  if (!(ray.length_m >= 0)) throw bad_use(fmt::format("length {} is below 0", format_number(ray.length_m)));
  return ray;
}

SphereQuestion make_sphere_question(const Numbers& numbers) {
  if (!numbers.has(column::kSphereCenter, 4)) throw bad_use("a sphere takes 4 numbers: centre and radius");
  SphereQuestion sphere{numbers.vector(column::kSphereCenter), numbers.value[column::kRadius]};
  need_finite(sphere.center, "centre");
  const bool radius_fits = sphere.radius_m >= 0 && std::isfinite(sphere.radius_m);
  if (!radius_fits)
    throw bad_use(fmt::format("radius {} must be finite and not below 0", format_number(sphere.radius_m)));
  return sphere;
}

BoxQuestion make_box_question(const Numbers& numbers) {
  const bool has_corners = numbers.has(column::kLow, 6);
  const bool has_center = numbers.has(column::kBoxCenter, 6);
  if (has_corners == has_center) throw bad_use("a box takes two corners (6 numbers), or --center X Y Z --size X Y Z");
  BoxQuestion box;
  if (has_corners) {
    const Vec3 low = numbers.vector(column::kLow);
    const Vec3 high = numbers.vector(column::kHigh);
    need_finite(low, "corner");
    need_finite(high, "corner");
    if ((low.array() > high.array()).any()) {
      throw bad_use(fmt::format("corners {} and {}: the first must be the lower one on every axis", format_vector(low),
                                format_vector(high)));
    }
    // Halved before they are added, so that the middle of two huge corners is finite.
    box.center = low / 2 + high / 2;
    box.half_m = high / 2 - low / 2;
  } else {
    box.center = numbers.vector(column::kBoxCenter);
    box.half_m = numbers.vector(column::kSize) / 2;
    need_finite(box.center, "centre");
    need_finite(box.half_m, "size");
    if ((box.half_m.array() < 0).any()) throw bad_use(fmt::format("size {} is below 0", format_vector(box.half_m * 2)));
  }
  if (numbers.has(column::kQuaternion, 4)) {
    const double* q = &numbers.value[column::kQuaternion];
    box.rotation = unit_quaternion(q[0], q[1], q[2], q[3]);
  }
  return box;
}

NearQuestion make_near_question(const Numbers& numbers) {
  if (!numbers.has(column::kPoint, 3)) throw bad_use("near what? 3 numbers are needed");
  NearQuestion near;
  near.point = numbers.vector(column::kPoint);
  need_finite(near.point, "point");
  if (numbers.has(column::kReach, 1)) near.within_m = numbers.value[column::kReach];
  if (!(near.within_m >= 0)) throw bad_use(fmt::format("reach {} is below 0", format_number(near.within_m)));
  return near;
}

InsideQuestion make_inside_question(const Numbers& numbers) {
  if (!numbers.has(column::kPoint, 3)) throw bad_use("what is inside? 3 numbers are needed, a point");
  const InsideQuestion inside{numbers.vector(column::kPoint)};
  need_finite(inside.point, "point");
  return inside;
}

}  // namespace

std::string_view name_of(QuestionKind kind) {
  constexpr std::array<std::string_view, kQuestionKinds> kNames{"ray", "sphere", "box", "near", "inside"};
  return kNames[static_cast<std::size_t>(kind)];
}

Questions no_questions(QuestionKind kind) {
  switch (kind) {
    case QuestionKind::ray: return std::vector<RayQuestion>{};
    case QuestionKind::sphere: return std::vector<SphereQuestion>{};
    case QuestionKind::box: return std::vector<BoxQuestion>{};
    case QuestionKind::near: return std::vector<NearQuestion>{};
    case QuestionKind::inside: break;
  }
  return std::vector<InsideQuestion>{};
}

std::size_t question_count(const Questions& questions) {
  return std::visit([](const auto& list) { return list.size(); }, questions);
}

std::future<Result<Answers>> ask_async(Client& client, Questions questions, const AskOptions& options) {
  return std::visit([&](auto& list) { return client.ask_async(std::move(list), options); }, questions);
}

Result<Answers> ask(Client& client, const Questions& questions, const AskOptions& options) {
  return std::visit([&](const auto& list) { return client.ask(std::span(list), options); }, questions);
}

const QuestionForm& form_of(QuestionKind kind) { return kForms[static_cast<std::size_t>(kind)]; }

void add_question(Questions& questions, const Numbers& numbers) {
  switch (static_cast<QuestionKind>(questions.index())) {
    case QuestionKind::ray: std::get<0>(questions).push_back(make_ray_question(numbers)); break;
    case QuestionKind::sphere: std::get<1>(questions).push_back(make_sphere_question(numbers)); break;
    case QuestionKind::box: std::get<2>(questions).push_back(make_box_question(numbers)); break;
    case QuestionKind::near: std::get<3>(questions).push_back(make_near_question(numbers)); break;
    case QuestionKind::inside: std::get<4>(questions).push_back(make_inside_question(numbers)); break;
  }
}

Quat from_roll_pitch_yaw(const Vec3& angles_rad) {
  return Quat(Eigen::AngleAxisd(angles_rad.z(), Vec3::UnitZ()) * Eigen::AngleAxisd(angles_rad.y(), Vec3::UnitY()) *
              Eigen::AngleAxisd(angles_rad.x(), Vec3::UnitX()));
}

Quat unit_quaternion(double w, double x, double y, double z) {
  const Quat rotation(w, x, y, z);
  if (!wire_contract::is_unit_quaternion(rotation)) {
    throw bad_use(fmt::format("quaternion {} {} {} {} (w x y z) has norm {}, allowed 1 +- {}", format_number(w),
                              format_number(x), format_number(y), format_number(z), format_number(rotation.norm()),
                              format_number(wire_contract::kUnitQuaternionSlack)));
  }
  return rotation.normalized();
}

}  // namespace collided::cli
