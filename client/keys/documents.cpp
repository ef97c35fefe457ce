#include "client/keys/documents.hpp"

#include <algorithm>
#include <array>
#include <ctime>

#include "idl/keys/key_folder.hpp"
#include "idl/topics.hpp"

namespace collided::keys {
namespace {

constexpr std::array kProtections{"none", "sign", "encrypt"};
constexpr std::array kProtectionKinds{"NONE", "SIGN", "ENCRYPT"};

std::string element(const std::string& name, const std::string& content) {
  return '<' + name + '>' + content + "</" + name + '>';
}

std::string escaped(std::string_view text) {
  std::string xml;
  for (const char c : text) {
    switch (c) {
      case '<': xml += "&lt;"; break;
      case '>': xml += "&gt;"; break;
      case '&': xml += "&amp;"; break;
      default: xml += c;
    }
  }
  return xml;
}

std::string time_text(std::int64_t since_1970_s) {
  const std::time_t time = since_1970_s;
  std::tm parts{};
  gmtime_r(&time, &parts);
  char text[32] = {};
  return {text, std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%S", &parts)};
}

std::string domains() {
  return element("domains",
                 element("id_range", element("min", "0") + element("max", std::to_string(wire_contract::kLastDomain))));
}

std::string document(const std::string& content) {
  return R"(<?xml version="1.0" encoding="UTF-8"?><dds xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">)" +
         content + "</dds>\n";
}

std::string tags(const Grant& grant) {
  const auto tag = [](const char* name, std::string_view value) {
    return element("tag", element("name", name) + element("value", escaped(value)));
  };
  std::string all;
  for (const std::string& glob : grant.objects) all += tag(kObjectsTag, glob);
  if (std::ranges::find(grant.roles, KeyRole::admin) != grant.roles.end()) all += tag(kImportanceTag, "high");
  return all.empty() ? all : element("data_tags", all);
}

std::string elements(const std::string& group, const std::string& name, const std::vector<std::string>& contents) {
  std::string all;
  for (const std::string& content : contents) all += element(name, content);
  return element(group, all);
}

/// Names of topics are "<namespace>/<suffix>", with any namespace.
std::string criteria(const std::string& kind, const std::set<std::string>& suffixes,
                     const std::vector<std::string>& partitions, const std::string& data_tags = {}) {
  if (suffixes.empty() || partitions.empty()) return {};
  std::vector<std::string> topics;
  for (const std::string& suffix : suffixes) topics.push_back("*/" + suffix);
  return element(kind,
                 elements("topics", "topic", topics) + elements("partitions", "partition", partitions) + data_tags);
}

std::vector<std::string> query_partitions(const TopicRights& rights) {
  std::vector<std::string> names;
  for (const wire_contract::QueryRight right : rights.queries) names.emplace_back(wire_contract::name_of(right));
  return names;
}

}  // namespace

std::string_view name_of(Protection protection) { return kProtections[static_cast<std::size_t>(protection)]; }

std::string governance_xml(Protection protection) {
  const std::string kind = kProtectionKinds[static_cast<std::size_t>(protection)];
  // Participants' announcements of their topics are protected like the topics themselves.
  const std::string topic_rule = element(
      "topic_rule", element("topic_expression", "*") + element("enable_discovery_protection", "true") +
                        element("enable_liveliness_protection", "true") +
                        element("enable_read_access_control", "true") + element("enable_write_access_control", "true") +
                        element("metadata_protection_kind", kind) + element("data_protection_kind", "NONE"));
  const std::string rule = element(
      "domain_rule", domains() + element("allow_unauthenticated_participants", "false") +
                         element("enable_join_access_control", "true") + element("discovery_protection_kind", kind) +
                         element("liveliness_protection_kind", kind) + element("rtps_protection_kind", "NONE") +
                         element("topic_access_rules", topic_rule));
  return document(element("domain_access_rules", rule));
}

std::string permissions_xml(const Grant& grant) {
  const TopicRights rights = rights_of(grant.roles);
  const std::string validity = element(
      "validity", element("not_before", time_text(grant.from_s)) + element("not_after", time_text(grant.until_s)));
  const std::vector<std::string> anywhere{"*"};
  const std::string rule =
      element("allow_rule", domains() + criteria("publish", rights.write, anywhere, tags(grant)) +
                                criteria("publish", {wire_contract::kQueryTopic.suffix}, query_partitions(rights)) +
                                criteria("subscribe", rights.read, anywhere));
  return document(element("permissions", R"(<grant name=")" + grant.name + R"(">)" +
                                             element("subject_name", "CN=" + grant.name) + validity + rule +
                                             element("default", "DENY") + "</grant>"));
}

}  // namespace collided::keys
