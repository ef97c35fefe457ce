#include "idl/etcd/etcd_members.hpp"

#include <algorithm>
#include <chrono>
#include <exception>
#include <string_view>
#include <utility>

#include <nlohmann/json.hpp>

#include "idl/etcd/etcd_json.hpp"

namespace collided::etcd {
namespace {

using Refusal = NoAnswer::Refusal;
using Clock = std::chrono::steady_clock;

/// etcd's own words, which its gateway and its streams have in common.
constexpr std::string_view kBadToken = "invalid auth token", kOldToken = "revision of auth store is old",
                           kNoUser = "user name is empty", kBadPassword = "invalid user ID or password",
                           kNoPermission = "permission denied", kNoUsers = "authentication is not enabled",
                           kCommonName = "CommonName of client";

bool has(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }

/// As much of a foreign text as a log line bears.
std::string shortened(const std::string& text) {
  constexpr std::size_t kMost = 120;
  std::string line = text.substr(0, kMost);
  std::ranges::replace_if(
      line, [](unsigned char c) { return c < ' ' || c > '~'; }, '.');
  return line;
}

bool is_token_refused(std::string_view why) { return has(why, kBadToken) || has(why, kOldToken) || has(why, kNoUser); }

}  // namespace

EtcdMembers::EtcdMembers(EtcdAddress address, std::int64_t patience_ns)
    : address_(std::move(address)), patience_ns_(patience_ns), connection_(http::http_module("etcd").connect()) {}

http::HttpPost EtcdMembers::post_to(const EtcdEndpoint& member, const char* target, const std::string& question) const {
  const bool is_address_6 = member.host.find(':') != std::string::npos;
  return {.url = (address_.has_tls ? "https://" : "http://") + (is_address_6 ? "[" + member.host + "]" : member.host) +
                 ":" + member.port + target,
          .body = question,
          .patience_ns = patience_ns_,
          .authorization = token_.value_or(std::string()),
          .tls = keys_.files};
}

/// Returns the fault of a request that got no good answer.
NoAnswer EtcdMembers::fault_of(const http::HttpAnswer& answer) const {
  const std::string& trusted = keys_.files.trusted;
  switch (answer.fault) {
    case http::HttpFault::none:
      return refusal_of("status " + std::to_string(answer.status) + ": " + shortened(answer.body));
    case http::HttpFault::not_trusted:
      return NoAnswer(answer.problem + " (trusted: " +
                          (trusted.empty() ? "those of the system; --etcd-keys DIR names others" : trusted) + ')',
                      Refusal::member);
    case http::HttpFault::unusable_files: return NoAnswer(answer.problem, Refusal::member);
    case http::HttpFault::closed:
      if (!address_.has_tls) return NoAnswer(answer.problem + "; it may want etcds://");
      return NoAnswer(answer.problem + (keys_.files.certificate.empty()
                                            ? "; it may want a client certificate, and there is none"
                                            : "; it may not take " + keys_.files.certificate));
    case http::HttpFault::unanswered: break;
  }
  return NoAnswer(answer.problem);
}

/// Returns why etcd refuses the client, else the text.
NoAnswer EtcdMembers::refusal_of(const std::string& text) const {
  const std::string user = "user '" + keys_.user + "'";
  if (has(text, kNoPermission)) return NoAnswer(user + " has no permission for these keys", Refusal::cluster);
  if (has(text, kBadPassword))
    return NoAnswer(user + " is refused with the password in " + address_.keys_folder, Refusal::cluster);
  if (has(text, kNoUser))
    return NoAnswer("a user is needed (" + std::string(kNoUser) + "): --etcd-keys DIR with username and password",
                    Refusal::cluster);
  if (has(text, kCommonName))
    return NoAnswer("its gateway takes no client certificate with a common name (CN) while it has users",
                    Refusal::cluster);
  return NoAnswer(text);
}

json EtcdMembers::answer_of(const EtcdEndpoint& member, const char* target, const std::string& question,
                            std::int64_t patience_ns) {
  http::HttpPost post = post_to(member, target, question);
  post.patience_ns = patience_ns;
  post.connect_ns = patience_ns_;
  post.is_over = is_over_;
  const http::HttpAnswer answer = connection_->post(post);
  constexpr long kOk = 200;
  if (!answer.problem.empty() || answer.status != kOk) throw fault_of(answer);
  json read = json::parse(answer.body, nullptr, false);
  if (!read.is_object()) throw NoAnswer("an answer that is not of etcd: " + shortened(answer.body));
  return read;
}

/// Reads the keys, and gets a token where there is a user.
void EtcdMembers::authenticate(const EtcdEndpoint& member) {
  // etcd spends a tenth of a second on a password by design, and seconds on a busy machine. Giving up sooner would only
  // restart that. An unreachable member shows in its connection.
  constexpr std::int64_t kLeastPatienceNs = 5'000'000'000;
  keys_ = read_etcd_keys(address_);
  token_ = std::string();
  if (keys_.user.empty()) return;
  try {
    const json question{{"name", keys_.user}, {"password", keys_.password}};
    // A file may contain any bytes; those that are not UTF-8 cannot be a password.
    const std::string text = question.dump(-1, ' ', false, json::error_handler_t::replace);
    const json answer = answer_of(member, "/v3/auth/authenticate", text, std::max(patience_ns_, kLeastPatienceNs));
    token_ = text_in(answer, "token");
  } catch (const NoAnswer& failed) {
    if (has(failed.what(), kNoUsers)) return;
    token_.reset();
    throw;
  }
}

void EtcdMembers::ask_as_user(const EtcdEndpoint& member, const std::function<void()>& ask_once) {
  const bool is_fresh = !token_;
  if (is_fresh) authenticate(member);
  try {
    return ask_once();
  } catch (const NoAnswer& failed) {
    // One that was just got is not refused for its age.
    if (!is_token_refused(failed.what()) || keys_.user.empty() || is_fresh) {
      // Files may be replaced by good ones.
      if (failed.refusal != Refusal::none) token_.reset();
      throw;
    }
  }
  authenticate(member);
  ask_once();
}

/// Asks up to member_count members until one answers.
template <class Ask>
void EtcdMembers::ask_in_turn(std::size_t member_count, const Ask& ask_one) {
  std::string problems;
  bool is_refused = true;
  for (std::size_t i = 0; i < member_count; ++i) {
    const std::size_t at = newest_;
    const EtcdEndpoint& member = address_.endpoints[at];
    try {
      return ask_as_user(member, [&] { ask_one(member); });
    } catch (const NoAnswer& failed) {
      newest_ = (at + 1) % address_.endpoints.size();
      const std::string problem = member.host + ':' + member.port + ": " + failed.what();
      if (failed.refusal == Refusal::cluster) throw StoreRefused(problem);
      is_refused = is_refused && failed.refusal != Refusal::none;
      problems += (problems.empty() ? "" : "; ") + problem;
    }
  }
  if (is_refused) throw StoreRefused(problems);
  throw StoreError(problems);
}

void EtcdMembers::ask(const char* target, const json& question, const std::function<void(const json&)>& read) {
  const std::string text = question.dump();
  is_over_ = {};
  ask_in_turn(address_.endpoints.size(),
              [&](const EtcdEndpoint& member) { read(answer_of(member, target, text, patience_ns_)); });
}

void EtcdMembers::read(const char* target, const json& question, const Stream& stream) {
  const std::string text = question.dump();
  is_over_ = stream.is_over;
  ask_in_turn(1, [&](const EtcdEndpoint& member) { read_from(member, target, text, stream); });
}

void EtcdMembers::read_from(const EtcdEndpoint& member, const char* target, const std::string& question,
                            const Stream& stream) {
  http::HttpPost post = post_to(member, target, question);
  const auto began = Clock::now();
  const auto age_ns = [&] { return std::chrono::nanoseconds(Clock::now() - began).count(); };
  bool has_begun = false, is_over = false;
  std::exception_ptr failed;
  post.patience_ns = std::max(stream.life_ns, patience_ns_) + patience_ns_;
  post.is_over = [&] {
    is_over = stream.is_over();
    return is_over || failed || age_ns() > (has_begun ? stream.life_ns : patience_ns_);
  };
  // libcurl bears no exceptions.
  post.take_line = [&](std::string_view line) {
    if (failed || line.empty()) return;
    try {
      const json read = json::parse(line, nullptr, false);
      has_begun = true;
      if (const auto error = read.is_object() ? read.find("error") : read.end();
          read.is_object() && error != read.end())
        throw NoAnswer(shortened(error->dump(-1, ' ', false, json::error_handler_t::replace)));
      stream.take(read);
    } catch (...) { failed = std::current_exception(); }
  };
  const http::HttpAnswer answer = connection_->post(post);
  try {
    if (failed) std::rethrow_exception(failed);
  } catch (const NoAnswer& why) { throw refusal_of(why.what()); }
  if (is_over || (has_begun && age_ns() > stream.life_ns)) return;
  if (!has_begun && age_ns() > patience_ns_)
    throw NoAnswer("no answer within " + std::to_string(patience_ns_ / 1'000'000) + " ms");
  if (answer.problem.empty() && answer.status == 200) throw NoAnswer("its stream ended");
  throw fault_of(answer);
}

}  // namespace collided::etcd
