#include "client/library/commands/upload.hpp"

#include <zlib.h>

#include <algorithm>

#include <nlohmann/json.hpp>

#include "client/library/commands/command.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/commands.hpp"

namespace collided::client {
namespace {

using nlohmann::json;
namespace names = wire_contract::command;

constexpr int kTries = 3;

// The CRC-32 of any number of bytes; zlib takes lengths of at most 32 bits.
std::uint32_t checksum_of(std::span<const std::uint8_t> bytes) {
  uLong sum = ::crc32(0, nullptr, 0);
  while (!bytes.empty()) {
    const std::size_t now = std::min<std::size_t>(bytes.size(), std::size_t{1} << 30);
    sum = ::crc32(sum, bytes.data(), static_cast<uInt>(now));
    bytes = bytes.subspan(now);
  }
  return static_cast<std::uint32_t>(sum);
}

/// Announces the upload and returns the server's number for it.
Result<std::uint64_t> begin(Connection& connection, std::span<const std::uint8_t> bytes, std::string_view file_name,
                            std::chrono::nanoseconds timeout) {
  const json ask{{"file", file_name}, {"bytes", bytes.size()}, {"checksum", checksum_of(bytes)}};
  const std::string text = ask.dump(-1, ' ', false, json::error_handler_t::replace);
  const Result<std::string> answer = command_with_blob(connection, names::kUpload, text, {}, timeout, {});
  if (!answer) return answer.error();
  const json told = json::parse(*answer, nullptr, false);
  const bool is_usable = told.is_object() && told.contains("upload") && told["upload"].is_number_unsigned() &&
                         told.value("piece_bytes", json()) == names::kUploadPieceBytes;
  if (!is_usable)
    return Error{ErrorCode::internal, "upload: the server takes pieces of another size than this client sends", ""};
  return told["upload"].get<std::uint64_t>();
}

std::optional<Error> send_piece(Connection& connection, std::uint64_t upload, std::uint64_t first,
                                std::span<const std::uint8_t> piece, std::chrono::nanoseconds timeout) {
  const std::string text = json{{"upload", upload}, {"first", first}, {"checksum", checksum_of(piece)}}.dump();
  for (int i = 1;; ++i) {
    const Result<std::string> answer = command_with_blob(connection, names::kPiece, text, piece, timeout, {});
    if (answer) return std::nullopt;
    const bool may_work_again = answer.error().code == ErrorCode::timeout || answer.error().hint == "send it again";
    if (i == kTries || !may_work_again) return answer.error();
  }
}

}  // namespace

Result<std::string> upload(Connection& connection, std::span<const std::byte> bytes, std::string_view file_name,
                           std::string_view json_arguments, std::chrono::nanoseconds timeout,
                           const std::function<void(double)>& progress) {
  json arguments = json_arguments.empty() ? json::object() : json::parse(json_arguments, nullptr, false);
  if (!arguments.is_object()) return bad_input("upload: its arguments are not a JSON object");
  const std::span<const std::uint8_t> all(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  const Result<std::uint64_t> number = begin(connection, all, file_name, timeout);
  if (!number) return number.error();
  for (std::size_t first = 0; first < all.size(); first += names::kUploadPieceBytes) {
    const auto piece = all.subspan(first, std::min<std::size_t>(names::kUploadPieceBytes, all.size() - first));
    if (auto error = send_piece(connection, *number, first, piece, timeout)) return *error;
    if (progress) progress(0.5 * static_cast<double>(first + piece.size()) / static_cast<double>(all.size()));
  }
  arguments["upload"] = *number;
  const auto read = [&](double fraction) {
    if (progress) progress(0.5 + 0.5 * fraction);
  };
  return command_with_blob(connection, names::kLoad, arguments.dump(-1, ' ', false, json::error_handler_t::replace), {},
                           timeout, read);
}

}  // namespace collided::client
