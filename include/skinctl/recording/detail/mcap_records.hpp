// SPDX-License-Identifier: BSD-3-Clause
// The records of an MCAP file (mcap.dev/spec), as bytes, and its summary.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "skinctl/recording/detail/crc32.hpp"

SKINCTL_BEGIN_NAMESPACE
namespace detail::mcap {

static_assert(std::endian::native == std::endian::little, "MCAP is little-endian");

inline constexpr std::array<unsigned char, 8> magic = {0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};

enum class Op : unsigned char {
  header = 1,
  footer,
  schema,
  channel,
  message,
  chunk,
  message_index,
  chunk_index,
  attachment,
  attachment_index,
  statistics,
  metadata,
  metadata_index,
  summary_offset,
  data_end
};
/// Bytes of a record's opcode and length.
inline constexpr std::size_t record_head = 9;

using Bytes = std::vector<unsigned char>;
using View = std::span<const unsigned char>;
using Texts = std::map<std::string, std::string>;

template <class V>
void put(Bytes& out, V value) {
  static_assert(std::is_unsigned_v<V>);
  const std::size_t at = out.size();
  out.resize(at + sizeof value);
  std::memcpy(out.data() + at, &value, sizeof value);
}
inline void put(Bytes& out, std::string_view text) {
  put(out, static_cast<std::uint32_t>(text.size()));
  out.insert(out.end(), text.begin(), text.end());
}
inline void put(Bytes& out, View bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}
/// Appends a record whose content `f(out)` writes; its length is filled in afterwards.
template <class F>
void record(Bytes& out, Op op, F&& f) {
  out.push_back(static_cast<unsigned char>(op));
  put(out, std::uint64_t(0));
  const std::size_t from = out.size();
  f(out);
  const std::uint64_t length = out.size() - from;
  std::memcpy(out.data() + from - sizeof length, &length, sizeof length);
}
/// Appends a list that `f(out)` writes, with its length in bytes before it.
template <class F>
void list(Bytes& out, F&& f) {
  put(out, std::uint32_t(0));
  const std::size_t from = out.size();
  f(out);
  const auto length = static_cast<std::uint32_t>(out.size() - from);
  std::memcpy(out.data() + from - sizeof length, &length, sizeof length);
}
inline void put(Bytes& out, const Texts& texts) {
  list(out, [&](Bytes& o) {
    for (const auto& [key, value] : texts) put(o, std::string_view(key)), put(o, std::string_view(value));
  });
}

struct Schema {
  std::uint16_t id = 0;
  std::string name, encoding, text;
  friend bool operator==(const Schema&, const Schema&) = default;
};
struct Channel {
  std::uint16_t id = 0, schema = 0;
  std::string topic, encoding;
  Texts metadata{};
  friend bool operator==(const Channel&, const Channel&) = default;
};
struct ChunkIndex {
  std::uint64_t first = 0, last = 0;  ///< times of messages [ns]
  std::uint64_t start = 0, length = 0, index_length = 0, size = 0;
  std::map<std::uint16_t, std::uint64_t> index_offsets{};
};
/// The messages of one chunk: for each channel their times [ns] and places, in bytes from the chunk's first
/// record.
using MessageIndexes = std::map<std::uint16_t, std::vector<std::pair<std::uint64_t, std::uint64_t>>>;

inline void write(Bytes& out, const Schema& s) {
  record(out, Op::schema, [&](Bytes& o) {
    put(o, s.id), put(o, std::string_view(s.name)), put(o, std::string_view(s.encoding)),
        put(o, std::string_view(s.text));
  });
}
inline void write(Bytes& out, const Channel& c) {
  record(out, Op::channel, [&](Bytes& o) {
    put(o, c.id), put(o, c.schema), put(o, std::string_view(c.topic)), put(o, std::string_view(c.encoding)),
        put(o, c.metadata);
  });
}
/// Appends the message indexes of a chunk, which stand behind it at `at`; their places go into `index`.
inline void write(Bytes& out, const MessageIndexes& messages, std::uint64_t at, ChunkIndex& index) {
  const std::size_t from = out.size();
  for (const auto& [channel, entries] : messages) {
    index.index_offsets[channel] = at + (out.size() - from);
    record(out, Op::message_index, [&, &id = channel, &list_of = entries](Bytes& o) {
      put(o, id);
      list(o, [&](Bytes& l) {
        for (const auto& [time, place] : list_of) put(l, time), put(l, place);
      });
    });
  }
  index.index_length = out.size() - from;
}

/// The summary of a file, which stands behind its data: everything that an indexed reader asks for.
struct Summary {
  std::vector<Schema> schemas{};
  std::vector<Channel> channels{};
  std::vector<ChunkIndex> chunks{};
  std::vector<std::array<std::uint64_t, 2>> metadata{};  ///< places and lengths of metadata records
  std::vector<std::string> metadata_names{};
  std::map<std::uint16_t, std::uint64_t> counts{};  ///< messages of each channel
  /// Times of messages outside of chunks [ns]; the first after the last: there are none.
  std::uint64_t loose_first = std::numeric_limits<std::uint64_t>::max(), loose_last = 0;

  [[nodiscard]] std::uint64_t messages() const {
    std::uint64_t n = 0;
    for (const auto& [id, count] : counts) n += count;
    return n;
  }
  /// Earliest and latest time of a message [ns]; zeros without one.
  [[nodiscard]] std::pair<std::uint64_t, std::uint64_t> times() const {
    std::uint64_t first = loose_first, last = loose_last;
    for (const ChunkIndex& c : chunks)
      if (!c.index_offsets.empty())
        first = first < c.first ? first : c.first, last = last > c.last ? last : c.last;
    return first <= last ? std::pair(first, last) : std::pair(std::uint64_t(0), std::uint64_t(0));
  }

  /// DataEnd, the summary, the footer and the closing magic of a file whose data ends at `end`.
  [[nodiscard]] Bytes close(std::uint64_t end) const {
    Bytes out;
    record(out, Op::data_end, [](Bytes& o) { put(o, std::uint32_t(0)); });
    const std::size_t from = out.size();
    std::vector<std::array<std::uint64_t, 3>> groups;
    const auto group = [&](Op op, const auto& things, auto&& one) {
      const std::uint64_t start = out.size();
      for (const auto& thing : things) one(thing);
      if (out.size() > start)
        groups.push_back({static_cast<std::uint64_t>(op), end + start, out.size() - start});
    };
    group(Op::schema, schemas, [&](const Schema& s) { write(out, s); });
    group(Op::channel, channels, [&](const Channel& c) { write(out, c); });
    group(Op::statistics, std::array{0}, [&](int) { statistics(out); });
    std::size_t k = 0;
    group(Op::metadata_index, metadata, [&](const auto& m) {
      record(out, Op::metadata_index,
             [&](Bytes& o) { put(o, m[0]), put(o, m[1]), put(o, std::string_view(metadata_names[k++])); });
    });
    group(Op::chunk_index, chunks, [&](const ChunkIndex& c) { index(out, c); });
    const std::uint64_t offsets = out.size();
    for (const auto& g : groups)
      record(out, Op::summary_offset, [&](Bytes& o) {
        o.push_back(static_cast<unsigned char>(g[0]));
        put(o, g[1]), put(o, g[2]);
      });
    // The CRC is over the footer as well, its length included.
    out.push_back(static_cast<unsigned char>(Op::footer));
    put(out, std::uint64_t(8 + 8 + 4));
    put(out, end + from);
    put(out, end + offsets);
    put(out, crc32(View(out).subspan(from)));
    put(out, View(magic));
    return out;
  }

 private:
  void statistics(Bytes& out) const {
    const auto [first, last] = times();
    record(out, Op::statistics, [&, begin = first, until = last](Bytes& o) {
      put(o, messages());
      put(o, static_cast<std::uint16_t>(schemas.size()));
      put(o, static_cast<std::uint32_t>(channels.size()));
      put(o, std::uint32_t(0));
      put(o, static_cast<std::uint32_t>(metadata.size()));
      put(o, static_cast<std::uint32_t>(chunks.size()));
      put(o, begin), put(o, until);
      list(o, [&](Bytes& l) {
        for (const auto& [id, count] : counts) put(l, id), put(l, count);
      });
    });
  }
  static void index(Bytes& out, const ChunkIndex& c) {
    record(out, Op::chunk_index, [&](Bytes& o) {
      put(o, c.first), put(o, c.last), put(o, c.start), put(o, c.length);
      list(o, [&](Bytes& l) {
        for (const auto& [id, place] : c.index_offsets)
          if (place != 0) put(l, id), put(l, place);  // 0: a damaged chunk, without an index of this channel
      });
      put(o, c.index_length);
      put(o, std::string_view());
      put(o, c.size), put(o, c.size);
    });
  }
};

}  // namespace detail::mcap
SKINCTL_END_NAMESPACE
