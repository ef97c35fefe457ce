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

}  // namespace

std::optional<PageQuestion> parse_page_question(std::string_view text) {
  const json question = json::parse(text, nullptr, false);
  if (!question.is_object()) return std::nullopt;
  const auto ask = question.find("ask");
  const std::optional<double> id = finite(question, "id");
  if (ask == question.end() || !id) return std::nullopt;
  if (*ask == "ray") {
    const std::optional<Vec3> origin = vector(question, "origin");
    const std::optional<Vec3> direction = vector(question, "direction");
    if (!origin || !direction || direction->isZero(0)) return std::nullopt;
    return PageQuestion{*id, RayQuestion{.origin = *origin, .direction = *direction}};
  }
  if (*ask == "pair") {
    std::optional<std::string> a = name(question, "a");
    std::optional<std::string> b = name(question, "b");
    if (!a || !b) return std::nullopt;
    return PageQuestion{*id, PairOfNames{std::move(*a), std::move(*b)}};
  }
  if (*ask == "object") {
    std::optional<std::string> of = name(question, "name");
    if (!of) return std::nullopt;
    return PageQuestion{*id, ObjectOfName{std::move(*of)}};
  }
  if (*ask == "owners") return PageQuestion{*id, Owners{}};
  return std::nullopt;
}

}  // namespace collided::view
