// SPDX-License-Identifier: BSD-3-Clause
// MCAP files: messages of many topics, with an index, readable after a cut.
#pragma once

#include <algorithm>
#include <concepts>
#include <optional>

#include "skinctl/core/contract.hpp"
#include "skinctl/core/time.hpp"
#include "skinctl/core/version.hpp"
#include "skinctl/io/message_type.hpp"
#include "skinctl/recording/detail/mcap_records.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A sink for bytes. `write` takes all of them and returns true, or none and returns false.
template <class S>
concept McapSink = requires(S& sink, std::span<const unsigned char> bytes) {
  { sink.write(bytes) } -> std::same_as<bool>;
};

/// The size and time of a chunk, and the profile of the file.
struct McapOptions {
  std::size_t chunk_size = std::size_t(1) << 20;  ///< size of the records at which a chunk is closed [bytes]
  Nanoseconds chunk_time = 1s;                    ///< time from a chunk's first message at which it is closed
  std::string profile = "ros2";
};

/// A topic of a writer.
struct McapChannel {
  std::uint16_t id = 0;
};

/// Writes an MCAP file (profile `ros2`): uncompressed chunks with CRC, their message indexes, a summary at
/// the end.
///
/// A chunk is closed when it holds 1 MiB, or spans 1 s (`McapOptions`): that much is lost if the program is
/// killed. Schemas and channels stand in the first chunk that uses them, so that a file without its end can
/// still be read. Where the sink refuses a chunk (a full disk), its messages are counted in `lost()` and
/// the next chunk is tried. Not for the loop: it allocates.
template <McapSink Sink>
class McapWriter {
 public:
  explicit McapWriter(Sink& sink, const McapOptions& options = {}) : sink_(sink), options_(options) {
    using namespace detail::mcap;
    head_.assign(magic.begin(), magic.end());
    record(head_, Op::header, [&](Bytes& o) {
      put(o, std::string_view(options_.profile)), put(o, std::string_view("skinctl " SKINCTL_VERSION));
    });
    ready();
  }
  McapWriter(const McapWriter&) = delete;
  McapWriter& operator=(const McapWriter&) = delete;

  /// Adds a topic with messages of a ROS 2 type, in CDR. Throws `ConfigurationError` beyond 65 000 topics.
  [[nodiscard]] McapChannel channel(const std::string& topic, const MessageType& type) {
    const auto known = std::find_if(summary_.schemas.begin(), summary_.schemas.end(),
                                    [&](const auto& s) { return s.name == type.name; });
    std::uint16_t id = 0;
    if (known != summary_.schemas.end()) {
      id = known->id;
    } else {
      id = static_cast<std::uint16_t>(summary_.schemas.size() + 1);
      summary_.schemas.push_back({id, type.name, "ros2msg", type.schema});
    }
    return add({0, id, topic, "cdr", {{"topic_type_hash", type.hash}}});
  }
  /// Adds a topic whose messages have no schema, in an encoding of its own.
  [[nodiscard]] McapChannel channel(const std::string& topic, const std::string& encoding) {
    return add({0, 0, topic, encoding});
  }
  /// Writes facts about the file, by name. They stand where they are written, between chunks. False if the
  /// sink refused.
  bool metadata(const std::string& name, const std::map<std::string, std::string>& facts) {
    using namespace detail::mcap;
    if (!flush()) return false;
    Bytes out;
    record(out, Op::metadata, [&](Bytes& o) { put(o, std::string_view(name)), put(o, facts); });
    const std::uint64_t at = at_;
    if (!append(out)) return false;
    summary_.metadata.push_back({at, out.size()});
    summary_.metadata_names.push_back(name);
    return true;
  }
  /// Writes a message, numbered from 0 in its topic. Times before 1970 count as 0. False if a chunk was
  /// refused.
  bool write(McapChannel channel, Nanoseconds time, std::span<const unsigned char> bytes) {
    return write(channel, time, bytes, sequence_[channel.id - 1u]);
  }
  /// Writes a message with a sequence number of the caller's: a gap says that messages are missing.
  bool write(McapChannel channel, Nanoseconds time, std::span<const unsigned char> bytes,
             std::uint32_t sequence) {
    using namespace detail::mcap;
    SKINCTL_EXPECTS(channel.id > 0 && channel.id <= summary_.channels.size(), "a channel of this writer");
    sequence_[channel.id - 1u] = sequence + 1;
    const auto at = static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0));
    bool fine = true;
    if (const auto limit = static_cast<std::uint64_t>(options_.chunk_time.count());
        !indexes_.empty() && at > chunk_.first && at - chunk_.first >= limit)
      fine = flush();
    announce(channel);
    indexes_[channel.id].emplace_back(at, records_.size());
    record(records_, Op::message,
           [&](Bytes& o) { put(o, channel.id), put(o, sequence), put(o, at), put(o, at), put(o, bytes); });
    chunk_.first = std::min(chunk_.first, at), chunk_.last = std::max(chunk_.last, at);
    return (records_.size() < options_.chunk_size || flush()) && fine;
  }
  /// Closes the chunk and hands it to the sink. False if that refused it.
  bool flush() {
    using namespace detail::mcap;
    if (indexes_.empty()) return true;
    ready();
    out_.clear();
    ChunkIndex index = chunk_;
    index.start = at_, index.size = records_.size();
    record(out_, Op::chunk, [&](Bytes& o) {
      put(o, index.first), put(o, index.last), put(o, index.size), put(o, detail::crc32(records_));
      put(o, std::string_view()), put(o, std::uint64_t(records_.size())), put(o, View(records_));
    });
    index.length = out_.size();
    detail::mcap::write(out_, indexes_, at_ + index.length, index);
    const bool written = append(out_);
    for (const auto& [id, entries] : indexes_) (written ? summary_.counts[id] : lost_) += entries.size();
    if (written) {
      summary_.chunks.push_back(std::move(index));
    } else {
      for (const std::uint16_t id : announced_now_) announced_[id] = false;
    }
    announced_now_.clear();
    records_.clear();
    indexes_.clear();
    chunk_ = empty_chunk;
    return written;
  }
  /// Writes what is left and the summary; nothing may be written afterwards. False if anything was refused.
  bool finish() {
    const bool flushed = flush();
    ready();
    return append(summary_.close(at_)) && flushed;
  }
  /// Number of messages in chunks that the sink refused.
  [[nodiscard]] std::uint64_t lost() const noexcept { return lost_; }
  /// Number of messages that the sink took.
  [[nodiscard]] std::uint64_t written() const { return summary_.messages(); }
  /// Number of bytes that the sink took.
  [[nodiscard]] std::uint64_t size() const noexcept { return at_; }

 private:
  McapChannel add(detail::mcap::Channel channel) {
    require(summary_.channels.size() < 65'000, "McapWriter: topics", double(summary_.channels.size()),
            "< 65 000");
    channel.id = static_cast<std::uint16_t>(summary_.channels.size() + 1);
    summary_.channels.push_back(std::move(channel));
    sequence_.push_back(0);
    return {summary_.channels.back().id};
  }
  /// Writes schema and channel before the first message; if that chunk is lost, in the next one again.
  void announce(McapChannel c) {
    const auto& channel = summary_.channels[c.id - 1u];
    if (announced_[c.id]) return;
    if (channel.schema != 0) detail::mcap::write(records_, summary_.schemas[channel.schema - 1u]);
    detail::mcap::write(records_, channel);
    announced_[c.id] = true;
    announced_now_.push_back(c.id);
  }
  /// Whether the head of the file is there; one that was refused is tried again, before anything else.
  bool ready() {
    if (!begun_ && sink_.write(head_)) begun_ = true, at_ = head_.size();
    return begun_;
  }
  bool append(const detail::mcap::Bytes& bytes) {
    if (!ready() || !sink_.write(bytes)) return false;
    at_ += bytes.size();
    return true;
  }

  static inline const detail::mcap::ChunkIndex empty_chunk{.first =
                                                               std::numeric_limits<std::uint64_t>::max()};
  Sink& sink_;
  McapOptions options_;
  detail::mcap::Summary summary_;
  detail::mcap::Bytes records_, out_, head_;  // of the open chunk; scratch; the file's head
  detail::mcap::MessageIndexes indexes_;
  detail::mcap::ChunkIndex chunk_ = empty_chunk;
  std::vector<std::uint32_t> sequence_;
  std::map<std::uint16_t, bool> announced_;
  std::vector<std::uint16_t> announced_now_;
  std::uint64_t at_ = 0, lost_ = 0;
  bool begun_ = false;
};

SKINCTL_END_NAMESPACE
