#include "client/view/request_rules.hpp"

#include <algorithm>

namespace collided::view {
namespace {

bool is_same(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](char x, char y) { return lower(x) == lower(y); });
}

bool is_port(std::string_view text) {
  return !text.empty() && text.size() <= 5 &&
         std::all_of(text.begin(), text.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// The name in "name", "name:port", "[address]" or "[address]:port"; empty for other texts.
std::string_view name_of(std::string_view host) {
  std::string_view name = host;
  std::string_view rest;
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    if (end == std::string_view::npos) return {};
    name = host.substr(1, end - 1);
    rest = host.substr(end + 1);
  } else if (const std::size_t colon = host.find(':'); colon != std::string_view::npos) {
    name = host.substr(0, colon);
    rest = host.substr(colon);
  }
  if (!rest.empty() && !(rest.front() == ':' && is_port(rest.substr(1)))) return {};
  return name;
}

}  // namespace

bool may_be_called(std::string_view host, std::string_view own_address, bool is_loopback, const RequestRules& rules) {
  const std::string_view name = name_of(host);
  if (name.empty()) return false;
  if (is_same(name, own_address) || (is_loopback && is_same(name, "localhost"))) return true;
  return std::any_of(rules.hosts.begin(), rules.hosts.end(),
                     [&](const std::string& allowed) { return is_same(name, allowed); });
}

bool may_connect(std::string_view origin, std::string_view host, const RequestRules& rules) {
  if (origin.empty()) return true;
  constexpr std::string_view kScheme = "http://";
  if (origin.starts_with(kScheme) && is_same(origin.substr(kScheme.size()), host)) return true;
  return std::any_of(rules.origins.begin(), rules.origins.end(),
                     [&](const std::string& allowed) { return is_same(origin, allowed); });
}

}  // namespace collided::view
