#include "idl/mcap/writer.hpp"

#include <zlib.h>

#include <algorithm>

namespace collided::mcap {
namespace {

std::uint32_t crc_of(std::span<const std::byte> bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

void put_schema_and_channel(Bytes& bytes, std::uint16_t number, const ChannelDescription& channel) {
  const std::size_t schema = bytes.begin(Opcode::schema);
  bytes.number(number);
  bytes.text(channel.schema_name);
  bytes.text(channel.schema_encoding);
  bytes.text(channel.schema);
  bytes.end(schema);
  const std::size_t record = bytes.begin(Opcode::channel);
  bytes.number(number);
  bytes.number(number);  // of its schema
  bytes.text(channel.topic);
  bytes.text(channel.encoding);
  const std::size_t map = bytes.begin_list();
  for (const auto& [key, value] : channel.metadata) {
    bytes.text(key);
    bytes.text(value);
  }
  bytes.end_list(map);
  bytes.end(record);
}

void put_channels(Bytes& bytes, const std::vector<ChannelDescription>& channels, bool are_only_when_used) {
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].is_only_when_used == are_only_when_used)
      put_schema_and_channel(bytes, static_cast<std::uint16_t>(i + 1), channels[i]);
  }
}

}  // namespace

void put_opening(Bytes& bytes, std::string_view library, const std::vector<ChannelDescription>& channels) {
  bytes.raw(std::as_bytes(std::span(kMagic)));
  const std::size_t header = bytes.begin(Opcode::header);
  bytes.text("");  // no profile
  bytes.text(library);
  bytes.end(header);
  put_channels(bytes, channels, false);
}

void put_channels_in_use(Bytes& bytes, const std::vector<ChannelDescription>& channels) {
  put_channels(bytes, channels, true);
}

FileWriter::FileWriter(Output& output, std::string_view library, std::vector<ChannelDescription> channels)
    : output_(output), channels_(std::move(channels)), is_described_{true}, numbers_(channels_.size() + 1, 0) {
  for (const ChannelDescription& channel : channels_) is_described_.push_back(!channel.is_only_when_used);
  put_opening(piece_, library, channels_);
  append(piece_);
}

std::uint16_t FileWriter::add_channel(ChannelDescription channel) {
  is_described_.push_back(false);
  numbers_.push_back(0);
  channels_.push_back(std::move(channel));
  const auto number = static_cast<std::uint16_t>(channels_.size());
  if (!channels_.back().is_only_when_used) describe(number);
  return number;
}

/// Placed between two chunks, before the one with the channel's first message.
void FileWriter::describe(std::uint16_t channel) {
  is_described_[channel] = true;
  piece_.clear();
  put_schema_and_channel(piece_, channel, channels_[channel - 1]);
  append(piece_);
}

bool FileWriter::append(const Bytes& bytes) {
  if (!output_.append(bytes.all())) {
    failed_ = true;
    return false;
  }
  written_bytes_ += bytes.size();
  return true;
}

void FileWriter::write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
                       std::span<const std::byte> data) {
  ++messages_;
  if (failed_) return;
  if (!is_described_[channel]) describe(channel);
  if (failed_) return;
  chunk_first_ = chunk_messages_ == 0 ? log_time : std::min(chunk_first_, log_time);
  chunk_last_ = chunk_messages_ == 0 ? log_time : std::max(chunk_last_, log_time);
  ++chunk_messages_;
  chunk_index_[channel].emplace_back(log_time, records_.size());
  std::array<std::byte, kMessagePrefixBytes> prefix;
  put_message_prefix(prefix.data(), {channel, numbers_[channel]++, log_time, publish_time}, data.size());
  records_.raw(prefix);
  records_.raw(data);
  if (records_.size() >= kChunkBytes) flush();
}

void FileWriter::flush() {
  if (chunk_messages_ == 0 || failed_) return;
  // The chunk's entry in the summary, valid only after the output has accepted the chunk.
  ChunkEntry entry{.first_time = chunk_first_,
                   .last_time = chunk_last_,
                   .start = written_bytes_,
                   .length = kChunkPrefixBytes + records_.size(),
                   .records_bytes = records_.size(),
                   .index_bytes = 0,
                   .index_offsets = {}};
  std::array<std::byte, kChunkPrefixBytes> prefix;
  put_chunk_prefix(prefix.data(), entry.first_time, entry.last_time, records_.size(), crc_of(records_.all()));
  piece_.clear();
  piece_.raw(prefix);
  piece_.raw(records_.all());
  put_message_indexes(piece_, entry);
  if (append(piece_)) {
    messages_written_ += chunk_messages_;
    first_time_ = chunks_.empty() ? chunk_first_ : std::min(first_time_, chunk_first_);
    last_time_ = chunks_.empty() ? chunk_last_ : std::max(last_time_, chunk_last_);
    for (const auto& [channel, index] : chunk_index_) counts_[channel] += index.size();
    chunks_.push_back(std::move(entry));
  }
  records_.clear();
  chunk_index_.clear();
  chunk_messages_ = 0;
}

void FileWriter::put_message_indexes(Bytes& bytes, ChunkEntry& entry) const {
  const std::size_t before = bytes.size();
  for (const auto& [channel, index] : chunk_index_) {
    entry.index_offsets.emplace_back(channel, written_bytes_ + bytes.size());
    const std::size_t record = bytes.begin(Opcode::message_index);
    bytes.number(channel);
    const std::size_t list = bytes.begin_list();
    for (const auto& [time, offset] : index) {
      bytes.number(time);
      bytes.number(offset);
    }
    bytes.end_list(list);
    bytes.end(record);
  }
  entry.index_bytes = bytes.size() - before;
}

void FileWriter::metadata(std::string_view name, const std::vector<std::pair<std::string, std::string>>& entries) {
  flush();
  piece_.clear();
  const std::size_t record = piece_.begin(Opcode::metadata);
  piece_.text(name);
  const std::size_t map = piece_.begin_list();
  for (const auto& [key, value] : entries) {
    piece_.text(key);
    piece_.text(value);
  }
  piece_.end_list(map);
  piece_.end(record);
  const std::uint64_t start = written_bytes_;
  if (!failed_ && append(piece_)) metadata_.push_back({start, piece_.size(), std::string(name)});
}

bool FileWriter::close() {
  flush();
  // A full disk may still have space for the end, which is smaller than the chunk that was cut off.
  piece_.clear();
  const std::size_t data_end = piece_.begin(Opcode::data_end);
  piece_.number(std::uint32_t{0});  // no checksum over all: every chunk has its own
  piece_.end(data_end);
  const std::size_t summary = piece_.size();
  put_summary(piece_);
  const std::uint64_t summary_start = written_bytes_ + summary;
  const std::size_t footer = piece_.begin(Opcode::footer);
  piece_.number(summary_start);
  piece_.number(std::uint64_t{0});  // no table of the summary's groups
  // The footer's length includes the checksum of the summary, which is appended after it.
  piece_.end(footer, sizeof(std::uint32_t));
  piece_.number(crc_of(piece_.all().subspan(summary)));
  piece_.raw(std::as_bytes(std::span(kMagic)));
  return append(piece_) && !failed_;
}

void FileWriter::put_summary(Bytes& bytes) const {
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    if (is_described_[i + 1]) put_schema_and_channel(bytes, static_cast<std::uint16_t>(i + 1), channels_[i]);
  }
  put_statistics(bytes);
  put_chunk_indexes(bytes);
  for (const MetadataEntry& entry : metadata_) {
    const std::size_t record = bytes.begin(Opcode::metadata_index);
    bytes.number(entry.start);
    bytes.number(entry.length);
    bytes.text(entry.name);
    bytes.end(record);
  }
}

void FileWriter::put_statistics(Bytes& bytes) const {
  const std::size_t record = bytes.begin(Opcode::statistics);
  bytes.number(messages_written_);
  const auto described = std::count(is_described_.begin() + 1, is_described_.end(), true);
  bytes.number(static_cast<std::uint16_t>(described));  // schemas
  bytes.number(static_cast<std::uint32_t>(described));
  bytes.number(std::uint32_t{0});  // attachments
  bytes.number(static_cast<std::uint32_t>(metadata_.size()));
  bytes.number(static_cast<std::uint32_t>(chunks_.size()));
  bytes.number(first_time_);
  bytes.number(last_time_);
  const std::size_t map = bytes.begin_list();
  for (const auto& [channel, count] : counts_) {
    bytes.number(channel);
    bytes.number(count);
  }
  bytes.end_list(map);
  bytes.end(record);
}

void FileWriter::put_chunk_indexes(Bytes& bytes) const {
  for (const ChunkEntry& chunk : chunks_) {
    const std::size_t record = bytes.begin(Opcode::chunk_index);
    bytes.number(chunk.first_time);
    bytes.number(chunk.last_time);
    bytes.number(chunk.start);
    bytes.number(chunk.length);
    const std::size_t map = bytes.begin_list();
    for (const auto& [channel, offset] : chunk.index_offsets) {
      bytes.number(channel);
      bytes.number(offset);
    }
    bytes.end_list(map);
    bytes.number(chunk.index_bytes);
    bytes.text("");
    bytes.number(chunk.records_bytes);
    bytes.number(chunk.records_bytes);
    bytes.end(record);
  }
}

}  // namespace collided::mcap
