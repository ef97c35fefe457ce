#include "client/view/request_rules.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

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

constexpr std::string_view kTokenParameter = "token=";

/// Calls visit(part) for the parts of a text between separators, without the spaces before each.
template <class Visit>
void for_each_part(std::string_view text, char separator, Visit&& visit) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find(separator), text.size());
    std::string_view part = text.substr(0, end);
    part.remove_prefix(std::min(part.find_first_not_of(' '), part.size()));
    visit(part);
    text.remove_prefix(std::min(end + 1, text.size()));
  }
}

std::string_view query_of(std::string_view target) {
  const std::size_t mark = target.find('?');
  return mark == std::string_view::npos ? std::string_view() : target.substr(mark + 1);
}

/// Compares every character, regardless of the first difference, so that the time reveals nothing to a guesser.
bool is_token(std::string_view given, std::string_view token) {
  if (given.size() != token.size()) return false;
  unsigned char differences = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    differences = static_cast<unsigned char>(differences | (given[i] ^ token[i]));
  return differences == 0;
}

}  // namespace

std::string new_token() {
  std::array<unsigned char, 16> bytes{};
  if (::getentropy(bytes.data(), bytes.size()) != 0) throw std::runtime_error("the system has no random numbers");
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string token;
  for (const unsigned char byte : bytes) {
    token += kDigits[byte / 16];
    token += kDigits[byte % 16];
  }
  return token;
}

Admission admission_of(std::string_view target, std::string_view cookies, std::string_view cookie_name,
                       const RequestRules& rules) {
  if (rules.token.empty()) return Admission::by_cookie;
  Admission admission = Admission::none;
  for_each_part(cookies, ';', [&](std::string_view cookie) {
    if (!cookie.starts_with(cookie_name)) return;
    cookie.remove_prefix(cookie_name.size());
    if (cookie.starts_with('=') && is_token(cookie.substr(1), rules.token)) admission = Admission::by_cookie;
  });
  for_each_part(query_of(target), '&', [&](std::string_view parameter) {
    if (parameter.starts_with(kTokenParameter) && is_token(parameter.substr(kTokenParameter.size()), rules.token))
      admission = Admission::by_query;
  });
  return admission;
}

std::string without_token(std::string_view target) {
  std::string kept;
  for_each_part(query_of(target), '&', [&](std::string_view parameter) {
    if (parameter.starts_with(kTokenParameter)) return;
    kept += kept.empty() ? '?' : '&';
    kept += parameter;
  });
  return std::string(target.substr(0, target.find('?'))) + kept;
}

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
