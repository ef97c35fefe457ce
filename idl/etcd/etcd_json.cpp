#include "idl/etcd/etcd_json.hpp"

#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/base64.hpp"

namespace collided::etcd {
namespace {

const json& part(const json& answer, const char* name, json::value_t kind) {
  const auto found = answer.is_object() ? answer.find(name) : answer.end();
  if (!answer.is_object() || found == answer.end() || found->type() != kind)
    throw NoAnswer(std::string("an answer without '") + name + '\'');
  return *found;
}

}  // namespace

const json& object_in(const json& answer, const char* name) { return part(answer, name, json::value_t::object); }
const json& array_in(const json& answer, const char* name) { return part(answer, name, json::value_t::array); }

const std::string& text_in(const json& answer, const char* name) {
  return part(answer, name, json::value_t::string).get_ref<const std::string&>();
}

std::int64_t number_in(const json& answer, const char* name) {
  if (!answer.is_object() || !answer.contains(name)) return 0;
  const std::string& text = text_in(answer, name);
  std::int64_t number = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (fault != std::errc() || end != text.data() + text.size())
    throw NoAnswer('\'' + std::string(name) + "' that is not a number");
  return number;
}

std::string bytes_in(const json& answer, const char* name) {
  if (answer.is_object() && !answer.contains(name)) return {};
  std::optional<std::string> bytes = decode_base64(text_in(answer, name));
  if (!bytes) throw NoAnswer("a '" + std::string(name) + "' that is not base64");
  return std::move(*bytes);
}

bool is_set_in(const json& answer, const char* name) { return answer.value(name, json(false)) == json(true); }

}  // namespace collided::etcd
