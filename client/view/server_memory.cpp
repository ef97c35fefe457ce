#include "client/view/server_memory.hpp"

#include <string>
#include <system_error>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/view/recording.hpp"
#include "client/view/uploaded_file.hpp"
#include "idl/commands.hpp"

namespace collided::view {
namespace {

constexpr std::chrono::seconds kPatience{10};

Result<std::string> ask_recorder(Client& client, const nlohmann::json& arguments) {
  return client.command(wire_contract::command::kRecording, arguments.dump(), {}, kPatience);
}

/// Writes the recording into a file as the server sends it, page after page.
Result<void> fetch_recorded(Client& client, std::chrono::nanoseconds last, UploadedFile& file) {
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
  for (std::uint64_t fetched = 0; fetched < size;) {
    const Result<std::string> page = ask_recorder(client, {{"number", made["number"]}, {"offset", fetched}});
    if (!page) return page.error();
    if (page->empty() || page->size() > size - fetched)
      return Error{ErrorCode::internal, "the server's recording broke off at byte " + std::to_string(fetched), ""};
    file.append(*page);
    fetched += page->size();
  }
  return {};
}

}  // namespace

Result<std::uint64_t> ServerMemory::fetch(Client& client, std::chrono::nanoseconds last,
                                          std::shared_ptr<const ShownObjects> surroundings) try {
  UploadedFile file;
  if (const Result<void> fetched = fetch_recorded(client, last, file); !fetched) return fetched.error();
  Result<std::string> run =
      run_of_recording(file.path(), std::move(surroundings), [this] { return is_stopping_.load(); });
  if (!run) return run.error();
  const std::lock_guard lock(mutex_);
  newest_ = make_bytes(std::move(*run));
  return ++number_;
} catch (const std::system_error& failed) { return Error{ErrorCode::refused, failed.what(), ""}; }

std::optional<WebPage> ServerMemory::page(std::string_view target) const {
  const std::lock_guard lock(mutex_);
  if (!newest_ || target != "/memory?number=" + std::to_string(number_)) return std::nullopt;
  return WebPage{"application/json", newest_};
}

}  // namespace collided::view
