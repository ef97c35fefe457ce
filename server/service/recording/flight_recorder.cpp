#include "server/service/recording/flight_recorder.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <new>
#include <stdexcept>

#include "idl/mcap/output.hpp"
#include "idl/mcap/writer.hpp"
#include "idl/recording/opening_commands.hpp"
#include "server/service/runtime/named_thread.hpp"

namespace collided::engine::service {
namespace {

constexpr std::size_t kRingBytes = std::size_t{8} << 20;
/// The ring is drained at least this often.
constexpr std::chrono::seconds kPeriod{1};
constexpr int kFatalSignals[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT};

std::atomic<FlightRecorder*> at_fatal_signals{nullptr};

/// One record of an MCAP message, in memory owned elsewhere; `data` is the sample in CDR.
struct RecordView {
  mcap::MessageHead head;
  std::span<const std::byte> whole, data;
};

/// The first record of bytes that begin with a whole one.
RecordView first_of(std::span<const std::byte> records) {
  std::uint64_t length = 0;
  RecordView record;
  const std::byte* at = records.data() + 1;
  const auto get = [&](auto& value) {
    std::memcpy(&value, at, sizeof value);
    at += sizeof value;
  };
  get(length), get(record.head.channel), get(record.head.number), get(record.head.log_time),
      get(record.head.publish_time);
  record.whole = records.first(mcap::kRecordPrefixBytes + length);
  record.data = record.whole.subspan(mcap::kMessagePrefixBytes);
  return record;
}

/// write(2) until all is written; safe in a signal handler.
void write_all(int file, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::write(file, bytes.data(), bytes.size());
    if (count <= 0) return;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
}

}  // namespace

FlightRecorder::FlightRecorder(const std::string& name_space, std::int64_t window_ns, std::string stem,
                               std::int64_t forget_after_ns)
    : name_space_(name_space),
      window_ns_(static_cast<std::uint64_t>(window_ns)),
      stem_(std::move(stem)),
      crash_path_(stem_ + "_crash.mcap"),
      ring_(kRingBytes),
      opening_(forget_after_ns),
      window_(window_ns_, [this](std::span<const std::byte> records) { opening_.fold(records); }) {
  std::vector<mcap::ChannelDescription> channels = recording::channels_of(name_space_);
  mcap::put_channels_in_use(standing_prologue_, channels);
  // Without a schema, so that readers do not take them for queries.
  channels.push_back({.topic = name_space_ + "/inventory",
                      .encoding = "cdr",
                      .schema_name = "collided::Inventory",
                      .schema_encoding = "",
                      .schema = ""});
  mcap::put_opening(prologue_, recording::library_name(), channels);
  thread_ = named_thread("recorder", [this] { run(); });
}

FlightRecorder::~FlightRecorder() {
  FlightRecorder* self = this;
  if (at_fatal_signals.compare_exchange_strong(self, nullptr)) {
    for (const int signal : kFatalSignals) std::signal(signal, SIG_DFL);
  }
  stopping_.store(true);
  wake_.release();
  thread_.join();
}

void FlightRecorder::run() {
  while (!stopping_.load()) {
    const bool is_busy = wake_.try_acquire_for(kPeriod);
    is_woken_.store(false);
    try {
      const std::lock_guard lock(mutex_);
      take_over(!is_busy);
    } catch (const std::bad_alloc&) {
      // Changes that could not be taken over stay in the ring for the next time; those that find no room there are
      // counted.
    }
  }
}

/// Moves what the ring has received into the window.
void FlightRecorder::take_over(bool gives_back) {
  if (frozen_.load()) return;
  ring_.drain(gives_back,
              [&](std::span<const std::byte> record) { window_.add(record, first_of(record).head.log_time); });
  window_.expire(now_ns());
}

void FlightRecorder::note_own(std::string_view text, std::span<const std::byte> blob) {
  dds::Sample<wire::Query> query;
  query->request = ++own_commands_;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  query->chunk_count = 1;
  static_cast<void>(dds::set_text(query->text, text));  // it came in such a field, so it fits
  dds::borrow(query->blob, std::span(reinterpret_cast<const std::uint8_t*>(blob.data()), blob.size()));
  note(recording::Recorded::query, *query);
}

void FlightRecorder::note_changes(const Inventory::Changes& changes) {
  const bool is_news = !changes.is_empty() || changes.client != 0 || own_commands_ > own_commands_noted_;
  if (!is_news) return;
  own_commands_noted_ = own_commands_;
  // All with one time, so that no file begins between two of them.
  const std::uint64_t now = now_ns();
  write_changes(changes, own_commands_, [&](const wire::Query& query) { put(kInventoryChannel, query, now, now); });
}

FlightFile FlightRecorder::write(const std::string& word, std::int64_t last_ns) {
  if (stem_.empty()) throw std::runtime_error("no folder can be written to; --state-dir names one");
  FlightFile file{
      .path = stem_ + "_" + word + ".mcap", .bytes = 0, .messages = 0, .dropped = 0, .from_ns = 0, .to_ns = now_ns()};
  file.from_ns = file.to_ns - std::min(static_cast<std::uint64_t>(std::max<std::int64_t>(0, last_ns)), window_ns_);
  ::unlink(file.path.c_str());  // an earlier file would keep its old permissions
  mcap::FileOutput output(file.path);
  // A truncated file is useless, and takes the room that the journal needs.
  struct UnlessWritten {
    const std::string& path;
    bool is_due = true;
    ~UnlessWritten() {
      if (is_due) ::unlink(path.c_str());
    }
  } removal{file.path};
  mcap::FileWriter writer(output, recording::library_name(), recording::channels_of(name_space_));
  {
    // Samples that arrive meanwhile wait in the ring.
    const std::lock_guard lock(mutex_);
    take_over(false);
    FlightOpening opening = opening_;
    std::vector<RecordView> newer;
    window_.for_each_block([&](std::span<const std::byte> records, std::uint64_t, std::uint64_t) {
      while (!records.empty()) {
        const RecordView record = first_of(records);
        record.head.log_time < file.from_ns || last_ns == 0 ? opening.fold(record.whole) : newer.push_back(record);
        records = records.subspan(record.whole.size());
      }
    });
    file.dropped = ring_.dropped() + opening.left_out();
    std::uint64_t opening_messages = 0;
    opening.write([&](recording::Recorded, std::span<const std::byte>) { ++opening_messages; });
    writer.metadata("recording", {{"opening_messages", std::to_string(opening_messages)},
                                  {"dropped", std::to_string(file.dropped)},
                                  {recording::kOpeningCommands, recording::text_of(opening.noted_commands())}});
    opening.write([&](recording::Recorded topic, std::span<const std::byte> data) {
      writer.write(static_cast<std::uint16_t>(topic), file.from_ns, file.from_ns, data);
    });
    for (const RecordView& record : newer) {
      if (record.head.channel != kInventoryChannel)
        writer.write(record.head.channel, record.head.log_time, record.head.publish_time, record.data);
    }
  }
  if (!writer.close()) throw std::runtime_error(output.problem());
  removal.is_due = false;
  file.bytes = output.size();
  file.messages = writer.messages_written();
  return file;
}

// ---- at a fatal signal

void FlightRecorder::write_at_fatal_signals() {
  if (stem_.empty()) return;
  at_fatal_signals.store(this);
  for (const int signal : kFatalSignals) {
    struct sigaction before {};
    sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_DFL) continue;
    struct sigaction action {};
    action.sa_handler = on_fatal_signal;
    // The handler runs once: a fault within it ends the process as it would have without the handler.
    action.sa_flags = static_cast<int>(SA_RESETHAND | SA_NODEFER);
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

void FlightRecorder::on_fatal_signal(int signal) {
  // The first thread that fails writes. If others fail meanwhile they end the process, and the file is cut off.
  if (FlightRecorder* recorder = at_fatal_signals.exchange(nullptr)) {
    recorder->frozen_.store(true);
    recorder->write_crash_file();
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Only unlink, open, write and close: a signal handler may neither allocate nor lock. Without checksums and without an
/// end record; a reader takes such a file up to its last whole chunk.
void FlightRecorder::write_crash_file() const {
  ::unlink(crash_path_.c_str());  // an earlier file would keep its old permissions
  const int file = ::open(crash_path_.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, 0600);
  if (file < 0) return;
  write_all(file, prologue_.all());
  if (has_standing_.load(std::memory_order_relaxed)) write_all(file, standing_prologue_.all());
  std::byte prefix[mcap::kChunkPrefixBytes];
  window_.for_each_block([&](std::span<const std::byte> records, std::uint64_t first_time, std::uint64_t last_time) {
    mcap::put_chunk_prefix(prefix, first_time, last_time, records.size(), 0);
    write_all(file, prefix);
    write_all(file, records);
  });
  // The last samples, such as the one on which the thread failed, are still in the ring.
  std::size_t bytes = 0, seen = 0;
  std::uint64_t last_time = 0;
  ring_.peek([&](std::span<const std::byte> record) {
    bytes += record.size();
    last_time = std::max(last_time, first_of(record).head.log_time);
  });
  mcap::put_chunk_prefix(prefix, last_time, last_time, bytes, 0);
  write_all(file, prefix);
  ring_.peek([&](std::span<const std::byte> record) {
    seen += record.size();
    if (seen <= bytes) write_all(file, record);  // other threads may have added some since the sum
  });
  ::close(file);
}

}  // namespace collided::engine::service
