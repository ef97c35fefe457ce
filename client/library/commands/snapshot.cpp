#include "collided/snapshot.hpp"

#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <utility>

#include <nlohmann/json.hpp>

#include "client/library/commands/geometry.hpp"
#include "client/library/commands/geometry_decoding.hpp"
#include "client/library/connection/connection.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"
#include "idl/mcap/output.hpp"

namespace collided {
namespace client {
namespace {

constexpr const char* kCommand = wire_contract::command::kSnapshot;

/// A file beside the one that is to be written, gone again unless it was put in place.
class FileBeside {
 public:
  /// Throws std::runtime_error where it cannot be made.
  explicit FileBeside(const std::string& path) : path_(path), beside_(path + ".part"), output_(beside_) {}
  ~FileBeside() {
    std::error_code ignored;
    std::filesystem::remove(beside_, ignored);
  }
  FileBeside(const FileBeside&) = delete;
  FileBeside& operator=(const FileBeside&) = delete;

  /// Returns what went wrong; empty: the bytes are under the path.
  std::string put_in_place(std::span<const std::byte> bytes) {
    if (!output_.append(bytes)) return output_.problem();
    std::error_code error;
    std::filesystem::rename(beside_, path_, error);
    return error ? path_ + ": " + error.message() : std::string();
  }

 private:
  std::string path_;
  std::string beside_;
  mcap::FileOutput output_;
};

Result<WrittenSnapshot> write(Connection& connection, FileBeside& file, const std::function<bool(double)>& progress) {
  constexpr std::chrono::seconds kPageTimeout{
      60};  // of a page; the first one comes once the server has put all together
  const Result<std::optional<std::string>> bytes =
      fetch_pages(connection, kCommand, nlohmann::json::object(), kPageTimeout, progress);
  if (!bytes) return bytes.error();
  if (!*bytes) return Error{ErrorCode::timeout, "snapshot: the server forgot what it was sending", "ask again"};
  std::string flaw;
  std::optional<WrittenSnapshot> written = decode_snapshot(**bytes, flaw);
  if (!written) return unfit(kCommand, flaw);
  if (const std::string failure = file.put_in_place(std::as_bytes(std::span(**bytes))); !failure.empty())
    return bad_input(failure, "nothing was written");
  return std::move(*written);
}

}  // namespace
}  // namespace client

Result<WrittenSnapshot> write_snapshot(const ConnectOptions& options, const std::string& path,
                                       const std::function<bool(double)>& progress) {
  Result<Client> client = Client::connect(options);
  if (!client) return client.error();
  const Result<ServerStatus> status = client->status();
  if (!status) return status.error();
  if (status->state != "ready")
    return Error{ErrorCode::refused, "snapshot: the server is " + status->state + ", so objects may be missing",
                 "wait until it is ready; nothing was written"};
  const Result<std::shared_ptr<client::Connection>> connection = client::Connection::open(options);
  if (!connection) return connection.error();
  try {
    client::FileBeside file(path);
    return client::write(**connection, file, progress);
  } catch (const std::runtime_error& failed) { return client::bad_input(failed.what()); }
}

}  // namespace collided
