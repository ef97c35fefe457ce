#include "server/service/commands/upload_receiver.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "idl/commands.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/runtime/named_thread.hpp"
#include "server/service/runtime/random_number.hpp"

namespace collided::engine::service {

namespace fs = std::filesystem;
namespace names = wire_contract::command;
using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

constexpr std::uint64_t kPieceBytes = names::kUploadPieceBytes;
constexpr std::size_t kMostNameBytes = 128;

/// Whether a file name is safe: no path, not hidden, no characters special to a shell.
bool is_good_file_name(const std::string& name) {
  const auto allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '-';
  };
  return !name.empty() && name.size() <= kMostNameBytes && name.front() != '.' &&
         std::all_of(name.begin(), name.end(), allowed);
}

std::uint32_t checksum_of(const std::vector<std::byte>& bytes) {
  return static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

bool write_at(int file, const std::vector<std::byte>& bytes, std::uint64_t first) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written = ::pwrite(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(first + done));
    if (written < 0 && errno != EINTR) return false;
    done += written < 0 ? 0 : static_cast<std::size_t>(written);
  }
  return true;
}

}  // namespace

UploadReceiver::UploadReceiver(std::string folder, const std::vector<KeptCommand>& keep, CommandAnswers& answers,
                               Load load)
    : folder_(std::move(folder)), answers_(answers), load_(std::move(load)), jobs_(kMostJobs) {
  std::error_code error;
  if (!folder_.empty()) {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_, error)) {
      const std::string name = entry.path().filename().string();
      const bool is_needed = std::any_of(
          keep.begin(), keep.end(), [&](const KeptCommand& kept) { return kept.text.find(name) != std::string::npos; });
      std::error_code ignored;
      if (!is_needed) fs::remove_all(entry.path(), ignored);
      for (const fs::directory_entry& file : fs::directory_iterator(entry.path(), ignored))
        bytes_[file.path().string()] = file.file_size(ignored);
    }
  }
  jobs_.serve("uploads", [this](const Job& job) {
    if (const auto* forget = std::get_if<Forget>(&job)) remove_file(forget->path);
    else work(std::get<Asked>(job));
  });
}

void UploadReceiver::stop() {
  stopping_.store(true);
  jobs_.finish();
  while (!uploads_.empty()) drop(uploads_.begin());
}

std::vector<BoundCommand> UploadReceiver::commands() {
  const auto queued = [this](const char* name, Handler handler) -> BoundCommand {
    return {.name = name,
            .hand_on = [this, handler](CommandAsk ask, const Arguments&) { take(std::move(ask), handler); }};
  };
  return {queued(names::kUpload, &UploadReceiver::begin), queued(names::kPiece, &UploadReceiver::piece)};
}

void UploadReceiver::take(CommandAsk ask, Handler handler) {
  if (!jobs_.has_room() || !jobs_.push(Asked{std::move(ask), handler}))
    throw BadCommand("too many pieces of uploads wait already", "send it again");
}

bool UploadReceiver::has_taken(const std::string& path) const {
  return !folder_.empty() && path.starts_with(folder_ + "/");
}

void UploadReceiver::forget(const std::string& path) {
  if (has_taken(path)) jobs_.push(Forget{path});
}

void UploadReceiver::work(const Asked& asked) {
  const CommandAsk& ask = asked.ask;
  try {
    if (stopping_.load()) throw BadCommand("the server is stopping");
    drop_forgotten();
    (this->*asked.handler)(ask, Arguments(ask.text));
  } catch (const BadCommand& bad) { answers_.refuse(ask, bad); } catch (const std::bad_alloc&) {
    answers_.refuse(ask, "not enough memory");
  }
}

/// Begins an upload: checks name and room, makes the file, and answers its number, which cannot be guessed.
void UploadReceiver::begin(const CommandAsk& ask, const Arguments& arguments) {
  const std::string name = arguments.text("file");
  const std::uint64_t bytes = arguments.whole("bytes");
  if (folder_.empty())
    throw BadCommand("upload: the server has no folder to keep files in", "start it with --state-dir");
  if (!is_good_file_name(name)) {
    throw BadCommand(
        fmt::format("upload: the file name {} has more than {} bytes, a dot in front, or others than letters, digits, "
                    "dot, dash and underscore",
                    printable(name), kMostNameBytes));
  }
  std::uint64_t kept = bytes;
  for (const auto& [path, size] : bytes_) kept += size;
  if (bytes == 0 || kept > kMostBytes) {
    throw BadCommand(
        fmt::format("upload: {} bytes, with what lies here already {}; allowed: 1 to {}. Nothing was taken", bytes,
                    kept, kMostBytes));
  }
  if (uploads_.size() >= kMostUnderWay) throw BadCommand("upload: too many are under way already", "ask again");
  const std::uint64_t number = random_number() % names::kMostExact;
  const std::string own = fmt::format("{}/{:014x}", folder_, number);
  std::error_code error;
  fs::create_directories(own, error);
  Upload upload{.client = ask.client,
                .path = own + "/" + name,
                .file = -1,
                .bytes = bytes,
                .checksum = arguments.whole_32("checksum"),
                .pieces = std::vector<std::int64_t>((bytes + kPieceBytes - 1) / kPieceBytes, -1),
                .missing = 0,
                .asked_at = Clock::now()};
  upload.missing = upload.pieces.size();
  upload.file = ::open(upload.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
  // Allocates the room on disk now, so that a full disk is reported before anything is sent.
  const int fault = upload.file < 0 ? errno : ::posix_fallocate(upload.file, 0, static_cast<off_t>(bytes));
  bytes_[upload.path] = bytes;
  const auto place = uploads_.emplace(number, std::move(upload)).first;
  if (fault != 0) {
    drop(place);
    throw BadCommand(
        fmt::format("upload: no room for {} bytes in {}: {}. Nothing was taken", bytes, folder_, std::strerror(fault)));
  }
  answers_.send(ask, ReplyStatus::ok, json{{"upload", number}, {"piece_bytes", kPieceBytes}}.dump());
}

/// Writes a piece to its place and notes its checksum, from which commit() combines that of the file.
void UploadReceiver::piece(const CommandAsk& ask, const Arguments& arguments) {
  Upload& upload = find(ask, arguments);
  const std::uint64_t first = arguments.whole("first");
  const std::uint64_t wanted = first < upload.bytes ? std::min(kPieceBytes, upload.bytes - first) : 0;
  if (first % kPieceBytes != 0 || wanted == 0 || ask.blob.size() != wanted) {
    throw BadCommand(fmt::format(
        "upload: a piece of {} bytes at {}; pieces are of {} bytes, one after the other, the last up to byte {}",
        ask.blob.size(), first, kPieceBytes, upload.bytes));
  }
  const std::uint32_t checksum = checksum_of(ask.blob);
  if (checksum != arguments.whole("checksum"))
    throw BadCommand("upload: a piece was damaged on its way", "send it again");
  if (!write_at(upload.file, ask.blob, first)) {
    throw BadCommand(fmt::format("upload: a piece cannot be written: {}", std::strerror(errno)), "send it again");
  }
  std::int64_t& known = upload.pieces[first / kPieceBytes];
  upload.missing -= known < 0 ? 1 : 0;
  known = checksum;
  upload.asked_at = Clock::now();
  answers_.send(ask, ReplyStatus::ok, json{{"missing", upload.missing}}.dump());
}

/// Checks that the file is complete and as it was sent, and syncs it, since a file to be loaded must survive a crash;
/// then has it loaded.
void UploadReceiver::commit(const CommandAsk& ask, const Arguments& arguments) {
  Upload& upload = find(ask, arguments);
  if (upload.missing > 0)
    throw BadCommand(
        fmt::format("upload: {} pieces of {} are missing. Nothing was loaded", upload.missing, upload.pieces.size()));
  uLong all = 0;
  for (std::size_t i = 0; i < upload.pieces.size(); ++i) {
    const std::uint64_t size = std::min(kPieceBytes, upload.bytes - i * kPieceBytes);
    all = ::crc32_combine(all, static_cast<uLong>(upload.pieces[i]), static_cast<z_off_t>(size));
  }
  const auto place = uploads_.find(arguments.whole("upload"));
  if (all != upload.checksum || ::fsync(upload.file) != 0) {
    const std::string why = all != upload.checksum ? "the file is not what its checksum says" : std::strerror(errno);
    drop(place);
    throw BadCommand("upload: " + why + ". Nothing was loaded");
  }
  const std::string path = upload.path;
  const std::uint32_t checksum = upload.checksum;
  ::close(upload.file);
  uploads_.erase(place);
  try {
    load_(ask, path, checksum);
  } catch (const BadCommand&) {
    remove_file(path);
    throw;
  }
}

UploadReceiver::Upload& UploadReceiver::find(const CommandAsk& ask, const Arguments& arguments) {
  const auto found = uploads_.find(arguments.whole("upload"));
  if (found == uploads_.end() || found->second.client != ask.client) {
    throw BadCommand(
        fmt::format("upload: there is none of that number under way; what is not gone on with for {} s is thrown away",
                    kPatience.count()),
        "begin again");
  }
  return found->second;
}

void UploadReceiver::drop(std::map<std::uint64_t, Upload>::iterator upload) {
  if (upload->second.file >= 0) ::close(upload->second.file);
  const std::string path = upload->second.path;
  uploads_.erase(upload);
  remove_file(path);
}

void UploadReceiver::remove_file(const std::string& path) {
  std::error_code ignored;
  fs::remove_all(fs::path(path).parent_path(), ignored);
  bytes_.erase(path);
}

void UploadReceiver::drop_forgotten() {
  const Clock::time_point stale = Clock::now() - kPatience;
  for (auto upload = uploads_.begin(); upload != uploads_.end();) {
    const auto here = upload++;
    if (here->second.asked_at < stale) drop(here);
  }
}

}  // namespace collided::engine::service
