#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "idl/mcap/format.hpp"
#include "idl/mcap/output.hpp"

namespace collided::mcap {

/// A channel's description in a file: `encoding` of its messages, `schema_encoding` of its schema (names of the MCAP
/// registry).
struct ChannelDescription {
  std::string topic;
  std::string encoding;
  std::string schema_name;
  std::string schema_encoding;
  std::string schema;
  std::vector<std::pair<std::string, std::string>> metadata = {};
  bool is_only_when_used = false;  // described only before its first message
};

/// Appends the beginning of a file: magic, header, schemas and channels, numbered from 1 in order, except those
/// with is_only_when_used.
void put_opening(Bytes& bytes, std::string_view library, const std::vector<ChannelDescription>& channels);
/// Appends the schemas and channels that put_opening() leaves out.
void put_channels_in_use(Bytes& bytes, const std::vector<ChannelDescription>& channels);

/// Writes an MCAP file chunk by chunk, each with its checksum and index; close() adds the summary. A file that was not
/// closed is whole up to its last chunk.
///
/// limits   a chunk is written when it has kChunkBytes, or at flush(); memory: kChunkBytes, 16 bytes per message for
///          the indexes of the current chunk, 100 bytes per chunk for the summary
/// errors   after the output has refused a piece, only close() still tries to write; see failed()
/// threads  one
class FileWriter {
 public:
  static constexpr std::size_t kChunkBytes = std::size_t{1} << 20;

  /// Writes the beginning of the file. `output` must outlive the FileWriter.
  FileWriter(Output& output, std::string_view library, std::vector<ChannelDescription> channels);

  /// Adds a channel to those of the file, and returns its number.
  std::uint16_t add_channel(ChannelDescription channel);
  /// Adds a message to the current chunk.
  ///
  /// channel                 number in the order of the descriptions, from 1
  /// log_time, publish_time  ns since 1970
  void write(std::uint16_t channel, std::uint64_t log_time, std::uint64_t publish_time,
             std::span<const std::byte> data);
  /// Writes the waiting messages as a chunk.
  void flush();
  /// Writes text about the whole file, as a separate record.
  void metadata(std::string_view name, const std::vector<std::pair<std::string, std::string>>& entries);
  /// Writes the end of the file. False: something could not be written; if it was the end, a reader reports that as
  /// missing.
  bool close();

  /// True if the output has refused a piece.
  bool failed() const { return failed_; }
  /// Messages given to write(). Those in chunks that the output refused are not in the file.
  std::uint64_t messages() const { return messages_; }
  /// Messages in the file.
  std::uint64_t messages_written() const { return messages_written_; }

 private:
  struct ChunkEntry {
    std::uint64_t first_time, last_time, start, length, records_bytes, index_bytes;
    std::vector<std::pair<std::uint16_t, std::uint64_t>> index_offsets;
  };
  struct MetadataEntry {
    std::uint64_t start, length;
    std::string name;
  };
  bool append(const Bytes& bytes);
  void describe(std::uint16_t channel);
  void put_message_indexes(Bytes& bytes, ChunkEntry& entry) const;
  void put_summary(Bytes& bytes) const;
  void put_statistics(Bytes& bytes) const;
  void put_chunk_indexes(Bytes& bytes) const;

  Output& output_;
  std::vector<ChannelDescription> channels_;
  std::vector<bool> is_described_;  // by channel
  std::uint64_t written_bytes_ = 0;
  bool failed_ = false;
  std::uint64_t messages_ = 0;
  std::uint64_t messages_written_ = 0;
  std::uint64_t first_time_ = 0, last_time_ = 0;
  std::map<std::uint16_t, std::uint64_t> counts_;  // written, by channel
  std::vector<std::uint32_t> numbers_;             // of the next message, by channel
  std::vector<ChunkEntry> chunks_;
  std::vector<MetadataEntry> metadata_;

  // The current chunk.
  Bytes records_;
  std::uint64_t chunk_messages_ = 0;
  std::uint64_t chunk_first_ = 0, chunk_last_ = 0;
  std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>> chunk_index_;  // time, offset
  Bytes piece_;
};

}  // namespace collided::mcap
