#include "client/library/commands/fetching.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/connection/errors.hpp"
#include "collided/recording.hpp"
#include "idl/commands.hpp"
#include "idl/mcap/output.hpp"

namespace collided {
namespace client {
namespace {

/// Largest recording to fetch: it is held in memory, and no valid flight recorder makes a larger one.
constexpr std::uint64_t kMostBytes = std::uint64_t{1} << 30;
constexpr std::chrono::seconds kTimeout{10};

Result<std::string> ask(Connection& connection, const nlohmann::json& arguments) {
  return command(connection, wire_contract::command::kRecording, arguments.dump(), {}, kTimeout, {});
}

}  // namespace

Result<std::vector<std::byte>> fetch_recorded(Connection& connection, std::chrono::nanoseconds last) {
  const Result<std::string> told = ask(connection, {{"last_s", std::chrono::duration<double>(last).count()}});
  if (!told) return told.error();
  const nlohmann::json made = nlohmann::json::parse(*told, nullptr, false);
  const bool understood = made.is_object() && made.contains("number") && made["number"].is_number_unsigned() &&
                          made.contains("bytes") && made["bytes"].is_number_unsigned();
  const std::uint64_t size = understood ? made["bytes"].get<std::uint64_t>() : 0;
  if (!understood || size > kMostBytes) {
    return Error{ErrorCode::internal, "the server's recording cannot be fetched: " + told->substr(0, 200), ""};
  }
  std::vector<std::byte> bytes;
  bytes.reserve(size);
  while (bytes.size() < size) {
    const Result<std::string> page = ask(connection, {{"number", made["number"]}, {"offset", bytes.size()}});
    if (!page) return page.error();
    if (page->empty() || page->size() > size - bytes.size()) {
      return Error{ErrorCode::internal, "the server's recording broke off at byte " + std::to_string(bytes.size()), ""};
    }
    const auto more = std::as_bytes(std::span(*page));
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

}  // namespace client

Result<std::uint64_t> fetch_recording(const ConnectOptions& options, std::chrono::nanoseconds last,
                                      const std::string& path) {
  const Result<std::shared_ptr<client::Connection>> connection = client::Connection::open(options);
  if (!connection) return connection.error();
  try {
    // Opens the file before it sends a request, which is useless without the file.
    mcap::FileOutput output(path);
    const Result<std::vector<std::byte>> bytes = client::fetch_recorded(**connection, last);
    if (!bytes) return bytes.error();
    if (!output.append(*bytes)) return Error{ErrorCode::bad_input, output.problem(), "nothing was kept"};
    return output.size();
  } catch (const std::runtime_error& failed) { return client::bad_input(failed.what()); }
}

}  // namespace collided
