#include "idl/etcd/etcd_address.hpp"

#include <algorithm>
#include <charconv>

namespace collided::etcd {
namespace {

constexpr std::string_view kPlain = "etcd://";
constexpr std::string_view kWithTls = "etcds://";

bool is_letter_or_digit(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9'); }

bool is_made_of(std::string_view text, std::string_view besides) {
  return std::ranges::all_of(text, [&](char c) { return is_letter_or_digit(c) || besides.find(c) != besides.npos; });
}

bool is_port(std::string_view text) {
  int port = 0;
  const auto [end, fault] = std::from_chars(text.data(), text.data() + text.size(), port);
  return fault == std::errc() && end == text.data() + text.size() && port >= 1 && port <= 65'535;
}

std::optional<EtcdEndpoint> parse_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos || !is_port(text.substr(colon + 1))) return std::nullopt;
  std::string_view host = text.substr(0, colon);
  const bool is_in_brackets = host.size() > 2 && host.front() == '[' && host.back() == ']';
  if (is_in_brackets) host = host.substr(1, host.size() - 2);
  constexpr std::size_t kMostLetters = 253;  // of a name in DNS
  const bool is_good = !host.empty() && host.size() <= kMostLetters && is_made_of(host, is_in_brackets ? ":.%" : ".-_");
  if (!is_good) return std::nullopt;
  return EtcdEndpoint{.host = std::string(host), .port = std::string(text.substr(colon + 1))};
}

}  // namespace

bool is_in_etcd(std::string_view text) { return text.starts_with(kPlain) || text.starts_with(kWithTls); }

std::optional<EtcdAddress> parse_etcd_address(std::string_view text, const std::string& keys_folder) {
  constexpr std::size_t kMostEndpoints = 16;
  constexpr std::size_t kMostKeyLetters = 200;
  if (!is_in_etcd(text)) return std::nullopt;
  const bool has_tls = text.starts_with(kWithTls);
  text.remove_prefix(has_tls ? kWithTls.size() : kPlain.size());
  const std::size_t slash = std::min(text.find('/'), text.size());
  EtcdAddress address{.endpoints = {},
                      .key = std::string(text.substr(std::min(slash + 1, text.size()))),
                      .has_tls = has_tls,
                      .keys_folder = keys_folder};
  const bool is_key = address.key.size() <= kMostKeyLetters && is_made_of(address.key, "_.-/") &&
                      !address.key.starts_with('/') && !address.key.ends_with('/');
  if (!is_key) return std::nullopt;
  std::string_view hosts = text.substr(0, slash);
  for (bool is_last = false; !is_last;) {
    const std::size_t comma = hosts.find(',');
    is_last = comma == std::string_view::npos;
    const std::optional<EtcdEndpoint> endpoint = parse_endpoint(hosts.substr(0, comma));
    if (!endpoint || address.endpoints.size() == kMostEndpoints) return std::nullopt;
    address.endpoints.push_back(*endpoint);
    hosts.remove_prefix(is_last ? hosts.size() : comma + 1);
  }
  return address;
}

}  // namespace collided::etcd
