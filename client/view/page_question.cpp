#include "client/view/page_question.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

namespace collided::view {
namespace {

using nlohmann::json;

constexpr std::size_t kMostNameBytes = 255;

std::optional<double> finite(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_number()) return std::nullopt;
  const auto value = found->get<double>();
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

std::optional<Vec3> vector(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_array() || found->size() != 3) return std::nullopt;
  Vec3 value;
  for (int axis = 0; axis < 3; ++axis) {
    const json& part = (*found)[static_cast<std::size_t>(axis)];
    if (!part.is_number()) return std::nullopt;
    value[axis] = part.get<double>();
  }
  return value.allFinite() ? std::optional(value) : std::nullopt;
}

std::optional<std::string> name(const json& object, const char* key) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string()) return std::nullopt;
  auto text = found->get<std::string>();
  return !text.empty() && text.size() <= kMostNameBytes ? std::optional(std::move(text)) : std::nullopt;
}

/// Nothing if it is negative.
std::optional<double> size_in(const json& object, const char* key) {
  const std::optional<double> value = finite(object, key);
  return value && *value >= 0 ? value : std::nullopt;
}

using What = std::optional<decltype(PageQuestion::what)>;

What ray_of(const json& question) {
  const std::optional<Vec3> origin = vector(question, "origin");
  const std::optional<Vec3> direction = vector(question, "direction");
  if (!origin || !direction || direction->isZero(0)) return std::nullopt;
  return RayQuestion{.origin = *origin, .direction = *direction};
}

What sphere_of(const json& question) {
  const std::optional<Vec3> center = vector(question, "center");
  const std::optional<double> radius_m = size_in(question, "radius");
  if (!center || !radius_m) return std::nullopt;
  return SphereQuestion{.center = *center, .radius_m = *radius_m};
}

What box_of(const json& question) {
  const std::optional<Vec3> center = vector(question, "center");
  const std::optional<Vec3> half_m = vector(question, "half");
  if (!center || !half_m || (half_m->array() < 0).any()) return std::nullopt;
  return BoxQuestion{.center = *center, .half_m = *half_m};
}

What near_of(const json& question) {
  const std::optional<Vec3> point = vector(question, "point");
  const std::optional<double> count = finite(question, "count");
  if (!point || !count || !(*count >= 1 && *count <= kMostNearest)) return std::nullopt;
  return NearestToPoint{{.point = *point}, static_cast<std::uint32_t>(*count)};
}

What sweep_of(const json& question) {
  const std::optional<double> radius_m = size_in(question, "radius");
  const std::optional<Vec3> from = vector(question, "from");
  const std::optional<Vec3> to = vector(question, "to");
  if (!radius_m || *radius_m == 0 || !from || !to) return std::nullopt;
  return SweptBall{*radius_m, {.from = {.position = *from}, .to = {.position = *to}}};
}

What pair_of(const json& question) {
  std::optional<std::string> a = name(question, "a");
  std::optional<std::string> b = name(question, "b");
  if (!a || !b) return std::nullopt;
  return PairOfNames{std::move(*a), std::move(*b)};
}

template <class Named>
What named_of(const json& question) {
  std::optional<std::string> of = name(question, "name");
  if (!of) return std::nullopt;
  return Named{std::move(*of)};
}

What owners_of(const json&) { return Owners{}; }

What memory_of(const json& question) {
  const std::optional<double> last_s = finite(question, "seconds");
  return last_s && *last_s > 0 && *last_s <= kMostRemembered_s ? What(Remembered{*last_s}) : std::nullopt;
}

What sampled_of(const json& question) {
  constexpr double kMostWhole = 9'007'199'254'740'992;  // 2^53
  const std::optional<double> since = size_in(question, "since");
  return since && *since <= kMostWhole ? What(SampledSince{*since}) : std::nullopt;
}

struct Kind {
  std::string_view ask;
  What (*parse)(const json& question);
};

constexpr Kind kKinds[] = {{"ray", ray_of},
                           {"sphere", sphere_of},
                           {"box", box_of},
                           {"near", near_of},
                           {"sweep", sweep_of},
                           {"pair", pair_of},
                           {"owners", owners_of},
                           {"memory", memory_of},
                           {"sampled", sampled_of},
                           {"object", named_of<ObjectOfName>},
                           {"nearest", named_of<NearestToObject>}};

}  // namespace

std::optional<PageQuestion> parse_page_question(std::string_view text) {
  const json question = json::parse(text, nullptr, false);
  if (!question.is_object()) return std::nullopt;
  const auto ask = question.find("ask");
  const std::optional<double> id = finite(question, "id");
  if (ask == question.end() || !id) return std::nullopt;
  for (const Kind& kind : kKinds) {
    if (*ask != kind.ask) continue;
    What what = kind.parse(question);
    return what ? std::optional(PageQuestion{*id, std::move(*what)}) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace collided::view
