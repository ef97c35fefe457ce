#include "client/view/server_memory.hpp"

#include <string>

#include <nlohmann/json.hpp>

#include "idl/commands.hpp"

namespace collided::view {
namespace {

constexpr std::chrono::seconds kPatience{10};

Result<std::string> ask_recorder(Client& client, const nlohmann::json& arguments) {
  return client.command(wire_contract::command::kRecording, arguments.dump(), {}, kPatience);
}

/// The recording as the server writes it, page after page.
Result<std::string> fetch_recorded(Client& client, std::chrono::nanoseconds last) {
  const Result<std::string> told = ask_recorder(client, {{"last_s", std::chrono::duration<double>(last).count()}});
  if (!told) return told.error();
  const nlohmann::json made = nlohmann::json::parse(*told, nullptr, false);
  const bool is_understood =
      made.is_object() && made.contains("number") && made.contains("bytes") && made["bytes"].is_number_unsigned();
  if (!is_understood) return Error{ErrorCode::internal, "the server's recording cannot be fetched", ""};
  const auto size = made["bytes"].get<std::uint64_t>();
  if (size > ServerMemory::kMostBytes) {
    return Error{ErrorCode::refused,
                 "the server's recording has " + std::to_string(size >> 20) + " MiB; a page is given " +
                     std::to_string(ServerMemory::kMostBytes >> 20) + " at most",
                 "collide record --last"};
  }
  std::string bytes;
  bytes.reserve(size);
  while (bytes.size() < size) {
    const Result<std::string> page = ask_recorder(client, {{"number", made["number"]}, {"offset", bytes.size()}});
    if (!page) return page.error();
    if (page->empty() || page->size() > size - bytes.size())
      return Error{ErrorCode::internal, "the server's recording broke off at byte " + std::to_string(bytes.size()), ""};
    bytes += *page;
  }
  return bytes;
}

}  // namespace

Result<std::uint64_t> ServerMemory::fetch(Client& client, std::chrono::nanoseconds last) {
  Result<std::string> bytes = fetch_recorded(client, last);
  if (!bytes) return bytes.error();
  const std::lock_guard lock(mutex_);
  newest_ = make_bytes(std::move(*bytes));
  return ++number_;
}

std::optional<WebPage> ServerMemory::page(std::string_view target) const {
  const std::lock_guard lock(mutex_);
  if (!newest_ || target != "/memory?number=" + std::to_string(number_)) return std::nullopt;
  return WebPage{"application/octet-stream", newest_};
}

}  // namespace collided::view
