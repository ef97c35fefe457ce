#include "server/intake/converter.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string_view>
#include <vector>

#include "server/intake/child_process.hpp"
#include "server/intake/file_bytes.hpp"
#include "server/intake/helper_program.hpp"

namespace collided::engine {
namespace {

namespace fs = std::filesystem;

constexpr int kDefaultSeconds = 30;
constexpr std::string_view kStem = "collided-import-";

/// An open file that holds the lock on the directory, or -1 if another process has it.
int lock_directory(const std::string& path) {
  const int directory = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
  if (directory >= 0 && ::flock(directory, LOCK_EX | LOCK_NB) == 0) return directory;
  if (directory >= 0) ::close(directory);
  return -1;
}

/// Removes the directories left by killed processes. A young one may be about to be locked.
void remove_left_ones(const fs::path& parent) {
  constexpr std::chrono::minutes kYoung{1};
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(parent, error)) {
    const std::string path = entry.path().string();
    if (!entry.path().filename().string().starts_with(kStem) || !entry.is_directory(error)) continue;
    if (entry.last_write_time(error) > fs::file_time_type::clock::now() - kYoung) continue;
    const int lock = lock_directory(path);
    if (lock < 0) continue;
    fs::remove_all(path, error);
    ::close(lock);
  }
}

std::string find_converter(const std::string& path) {
  const HelperProgram converter = find_helper_program("collided-import", "COLLIDED_IMPORT");
  if (!converter.path.empty()) return converter.path;
  if (converter.why_not.starts_with("COLLIDED_IMPORT")) refuse_file(file_name(path), converter.why_not);
  refuse_file(file_name(path),
              fmt::format("'{}' needs the converter {}", fs::path(path).extension().string(), converter.why_not));
}

std::chrono::seconds time_limit() {
  const char* text = std::getenv("COLLIDED_IMPORT_SECONDS");
  int seconds = 0;
  if (text == nullptr || std::from_chars(text, text + std::strlen(text), seconds).ec != std::errc{} || seconds <= 0) {
    seconds = kDefaultSeconds;
  }
  return std::chrono::seconds(seconds);
}

/// The first line of the converter's error stream, as text for a message.
std::string first_line(std::string_view text) {
  constexpr std::size_t kMost = 400;
  std::string line(text.substr(0, std::min(text.find('\n'), kMost)));
  for (char& c : line) { c = c < ' ' && c >= 0 ? '?' : c; }
  while (!line.empty() && (line.back() == '.' || line.back() == ' ')) { line.pop_back(); }
  return line;
}

void report_lines(std::string_view text, LoadReport& report) {
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const auto take = [line](std::string_view head, std::vector<std::string>& lines) {
      if (line.starts_with(head)) { lines.emplace_back(line.substr(head.size())); }
    };
    take("placed: ", report.placed);
    take("note: ", report.notes);
    take("mended: ", report.mended);
    take("refused: ", report.refused);
    take("warning: ", report.warnings);
  }
}

}  // namespace

TemporaryDirectory::TemporaryDirectory(const std::string& file) {
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  remove_left_ones(parent);
  path_ = (parent / (std::string(kStem) + "XXXXXX")).string();
  if (error || ::mkdtemp(path_.data()) == nullptr) {
    refuse_file(file_name(file), fmt::format("no temporary directory '{}': {}", path_, std::strerror(errno)));
  }
  lock_ = lock_directory(path_);
}

TemporaryDirectory::~TemporaryDirectory() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
}

ConvertedFile::ConvertedFile(const std::string& path, const std::string& scene_name, const LoadOptions& options,
                             LoadReport& report)
    : directory_(path) {
  { const FileBytes checked(path, FileBytes::Access::mapped, options); }
  std::vector<std::string> words = {find_converter(path),
                                    fs::absolute(path).string(),
                                    this->path(),
                                    "--name",
                                    scene_name,
                                    "--max-triangles",
                                    std::to_string(options.max_triangles),
                                    "--unit-m",
                                    fmt::format("{}", options.unit_m)};
  if (options.strict) words.emplace_back("--strict");
  if (options.up != 0) words.insert(words.end(), {"--up", std::string(1, options.up)});
  if (options.radius_m != 0) words.insert(words.end(), {"--radius-m", fmt::format("{}", options.radius_m)});
  if (options.mend_m) words.insert(words.end(), {"--mend-m", fmt::format("{}", *options.mend_m)});
  const ChildResult result = run_child(words, time_limit(), options.cancelled);
  if (!result.start_failure.empty()) {
    refuse_file(file_name(path), fmt::format("{} cannot be started: {}", words[0], result.start_failure));
  }
  if (result.cancelled) { refuse_file(file_name(path), "cancelled while it was converted"); }
  if (result.timed_out) {
    refuse_file(file_name(path),
                fmt::format("the converter needed more than {} s and was ended; COLLIDED_IMPORT_SECONDS allows more",
                            time_limit().count()));
  }
  if (result.exit_code != 0) {
    const std::string said = first_line(result.errors);
    if (said.ends_with("Nothing was loaded")) throw LoadError(said + ".");  // the message names the file already
    constexpr int kRefused = 1;  // the converter refused the file, and printed the reason
    if (result.exit_code == kRefused && !said.empty()) refuse_file(file_name(path), said);
    const std::string ended = result.exit_code > 0 ? fmt::format("failed with code {}", result.exit_code)
                                                   : fmt::format("was ended by signal {}", result.signal);
    refuse_file(file_name(path), said.empty() ? fmt::format("the converter {}", ended)
                                              : fmt::format("the converter {}: {}", ended, said));
  }
  std::error_code missing;
  if (const auto size = fs::file_size(this->path(), missing); missing || size == 0) {
    refuse_file(file_name(path), "the converter ended well and wrote nothing");
  }
  report_lines(result.output, report);
}

}  // namespace collided::engine
