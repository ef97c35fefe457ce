#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "idl/etcd/etcd_address.hpp"
#include "idl/etcd/etcd_keys.hpp"
#include "idl/etcd/lease_store.hpp"
#include "idl/http/http_post.hpp"

namespace collided::etcd {

struct NoAnswer;

/// The members of a cluster of etcd 3.4 or later, through their JSON gateway: asked in turn, beginning with the one that
/// answered last, with TLS and as a user if the address asks for it. A refused token is replaced by
/// a new one, for which the folder's files are read again.
///
/// threads  one
class EtcdMembers {
 public:
  /// patience_ns  for the answer of each member
  /// throws       ModuleMissing
  EtcdMembers(EtcdAddress address, std::int64_t patience_ns);

  /// Has read() take the first answer that it throws no NoAnswer for. Throws StoreError, StoreRefused.
  void ask(const char* target, const nlohmann::json& question, const std::function<void(const nlohmann::json&)>& read);

  struct Stream {
    std::function<void(const nlohmann::json& line)> take;  // NoAnswer ends the stream
    std::function<bool()> is_over;                         // asked ten times a second
    std::int64_t life_ns = 0;                              // it is left then
  };
  /// Reads the lines of one member's answer, until it is over or has lived. Throws as ask() where it ends otherwise, or does
  /// not begin within the patience; the next call begins with the next member then.
  void read(const char* target, const nlohmann::json& question, const Stream& stream);

 private:
  template <class Ask>
  void ask_in_turn(std::size_t member_count, const Ask& ask_one);
  void ask_as_user(const EtcdEndpoint& member, const std::function<void()>& ask_once);
  nlohmann::json answer_of(const EtcdEndpoint& member, const char* target, const std::string& question,
                           std::int64_t patience_ns);
  void read_from(const EtcdEndpoint& member, const char* target, const std::string& question, const Stream& stream);
  void authenticate(const EtcdEndpoint& member);
  http::HttpPost post_to(const EtcdEndpoint& member, const char* target, const std::string& question) const;
  NoAnswer fault_of(const http::HttpAnswer& answer) const;
  NoAnswer refusal_of(const std::string& text) const;

  const EtcdAddress address_;
  const std::int64_t patience_ns_;
  EtcdKeys keys_;
  std::optional<std::string> token_;  // nothing: not read yet; empty: none is needed
  const std::unique_ptr<http::HttpConnection> connection_;
  std::function<bool()> is_over_;  // of a stream, which may need a token first
  std::size_t newest_ = 0;         // the member that answered last
};

}  // namespace collided::etcd
