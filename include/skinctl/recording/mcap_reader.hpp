// SPDX-License-Identifier: BSD-3-Clause
// Reads MCAP files, also cut or damaged ones.
#pragma once

#include <algorithm>
#include <optional>
#include <string>

#include "skinctl/core/time.hpp"
#include "skinctl/recording/detail/mcap_records.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A message of a file; its bytes lie in the file's.
struct McapMessage {
  const detail::mcap::Channel& channel;
  Nanoseconds time{};
  std::uint32_t sequence = 0;
  std::span<const unsigned char> bytes;
};

/// The contents that a reader found in a file.
struct McapContents {
  bool is_mcap = false;  ///< the file begins as an MCAP file does
  bool whole = false;    ///< the file ends as an MCAP file does: its summary can be trusted
  std::string profile, library;
  detail::mcap::Summary summary;  ///< summary of the records that were read, not the file's own
  std::map<std::string, detail::mcap::Texts> metadata;
  std::uint64_t data_end = 0;  ///< end of the data's last whole record, in bytes from the file's beginning
  /// End of the last whole record that is no message index, in bytes from the file's beginning; indexes from
  /// here to `data_end` belong to the last chunk.
  std::uint64_t last_unit_end = 0;
  std::uint64_t damaged = 0;     ///< chunks whose CRC is wrong, or whose records are not valid
  std::uint64_t compressed = 0;  ///< whole chunks in a compression: not read
  std::string compression;       ///< name of the compression, as in the file
  std::uint64_t unknown = 0;     ///< messages outside of chunks whose channel was not announced

  /// The contents that were left out, in words; empty: nothing.
  [[nodiscard]] std::string left_out() const {
    std::string out;
    const auto add = [&](std::uint64_t n, const std::string& what) {
      if (n > 0) out += (out.empty() ? "" : ", ") + std::to_string(n) + what;
    };
    add(damaged, " chunks are damaged");
    add(compressed, " chunks are compressed (" + compression +
                        "), which is not read: `mcap decompress` of mcap.dev unpacks them");
    add(unknown, " messages are of a channel that was not announced");
    return out;
  }

  [[nodiscard]] const detail::mcap::Schema* schema(std::uint16_t id) const noexcept {
    for (const auto& s : summary.schemas)
      if (s.id == id) return &s;
    return nullptr;
  }
};

namespace detail::mcap {

/// Walks over bytes; whatever is missing makes it `broken()`.
class Cursor {
 public:
  explicit Cursor(View bytes) noexcept : bytes_(bytes) {}
  template <class V>
  V get() noexcept {
    V value{};
    const View v = take(sizeof value);
    if (!v.empty()) std::memcpy(&value, v.data(), sizeof value);
    return value;
  }
  View take(std::uint64_t n) noexcept {
    if (n > left()) {
      broken_ = true;
      at_ = bytes_.size();
      return {};
    }
    const View out = bytes_.subspan(at_, static_cast<std::size_t>(n));
    at_ += static_cast<std::size_t>(n);
    return out;
  }
  std::string text() {
    const View v = take(get<std::uint32_t>());
    return {v.begin(), v.end()};
  }
  Texts texts() {
    Cursor list(take(get<std::uint32_t>()));
    Texts out;
    while (list.left() > 0 && !list.broken()) {
      std::string key = list.text();
      out[std::move(key)] = list.text();
    }
    broken_ = broken_ || list.broken();
    return out;
  }
  [[nodiscard]] std::size_t left() const noexcept { return bytes_.size() - at_; }
  [[nodiscard]] std::size_t at() const noexcept { return at_; }
  [[nodiscard]] bool broken() const noexcept { return broken_; }

 private:
  View bytes_;
  std::size_t at_ = 0;
  bool broken_ = false;
};

struct Record {
  Op op{};
  View content;
};
/// The next record; none at the end and where its length is beyond the end.
inline std::optional<Record> next(Cursor& cursor) noexcept {
  if (cursor.left() < record_head) return std::nullopt;
  const auto op = static_cast<Op>(cursor.get<unsigned char>());
  const auto length = cursor.get<std::uint64_t>();
  if (length > cursor.left()) return std::nullopt;
  return Record{op, cursor.take(length)};
}

/// Reads a file front to back, a record at a time.
template <class Each>
class FrontToBack {
 public:
  FrontToBack(McapContents& out, Each& each) : out_(out), each_(each) {}

  void run(std::span<const unsigned char> file) {
    Cursor cursor(file);
    const View begin = cursor.take(magic.size());
    out_.is_mcap = !cursor.broken() && std::equal(begin.begin(), begin.end(), magic.begin());
    if (!out_.is_mcap) return;
    out_.data_end = out_.last_unit_end = cursor.at();
    for (bool data = true;;) {
      const std::uint64_t start = cursor.at();
      const auto r = next(cursor);
      if (!r) break;
      if (r->op == Op::data_end) {
        data = false;
      } else if (r->op == Op::footer && !data) {
        const View end = cursor.take(magic.size());
        out_.whole =
            !cursor.broken() && cursor.left() == 0 && std::equal(end.begin(), end.end(), magic.begin());
        break;
      } else if (r->op == Op::header || data) {
        take(*r, start, cursor.at());
      }
      if (data) out_.data_end = cursor.at();
    }
  }

 private:
  enum class Taken { other, fine, message, damaged };

  void take(const Record& r, std::uint64_t start, std::uint64_t end) {
    Cursor c(r.content);
    std::uint16_t of = 0;  // its channel
    std::uint64_t time = 0;
    const Taken taken = take_plain(r, 0, std::numeric_limits<std::uint64_t>::max(), of, time);
    if (taken == Taken::message) {  // legal outside of a chunk
      ++out_.summary.counts[of];
      out_.summary.loose_first = std::min(out_.summary.loose_first, time);
      out_.summary.loose_last = std::max(out_.summary.loose_last, time);
    }
    if (taken == Taken::damaged && r.op == Op::message) ++out_.unknown;
    if (taken != Taken::other) out_.last_unit_end = end;
    if (r.op == Op::header) {
      out_.profile = c.text(), out_.library = c.text();
      out_.last_unit_end = end;
    } else if (r.op == Op::chunk) {
      take_chunk(c, start, end);
      out_.last_unit_end = end;
    } else if (r.op == Op::message_index) {
      const auto id = c.get<std::uint16_t>();
      if (out_.summary.chunks.empty()) return;
      ChunkIndex& chunk = out_.summary.chunks.back();
      if (const auto known = chunk.index_offsets.find(id); known != chunk.index_offsets.end())
        known->second = start;
      chunk.index_length = end - (chunk.start + chunk.length);
    } else if (r.op == Op::metadata) {
      const std::string name = c.text();
      Texts facts = c.texts();
      if (!c.broken()) {
        out_.metadata[name] = std::move(facts);
        out_.summary.metadata.push_back({start, end - start});
        out_.summary.metadata_names.push_back(name);
      }
      out_.last_unit_end = end;
    }
  }
  void take_chunk(Cursor& c, std::uint64_t start, std::uint64_t end) {
    ChunkIndex index;
    index.first = c.get<std::uint64_t>(), index.last = c.get<std::uint64_t>(),
    index.size = c.get<std::uint64_t>();
    const auto crc = c.get<std::uint32_t>();
    const std::string compression = c.text();
    const View records = c.take(c.get<std::uint64_t>());
    index.start = start, index.length = end - start;
    MessageIndexes messages;
    constexpr std::uint32_t none = 0;  // the file was written without CRCs
    if (!c.broken() && !compression.empty()) {
      ++out_.compressed;
      out_.compression = compression.substr(0, 32);
    } else if (c.broken() || records.size() != index.size || (crc != none && detail::crc32(records) != crc) ||
               !take_records(records, index.first, index.last, messages)) {
      ++out_.damaged;
    }
    for (const auto& [id, entries] : messages)
      out_.summary.counts[id] += entries.size(), index.index_offsets[id] = 0;
    out_.summary.chunks.push_back(std::move(index));
  }
  bool take_records(View records, std::uint64_t first, std::uint64_t last, MessageIndexes& indexes) {
    Cursor inner(records);
    while (inner.left() > 0) {
      const std::uint64_t place = inner.at();
      const auto r = next(inner);
      std::uint16_t id = 0;
      std::uint64_t time = 0;
      const Taken taken = r ? take_plain(*r, first, last, id, time) : Taken::damaged;
      if (taken == Taken::damaged) return false;
      if (taken == Taken::message) indexes[id].emplace_back(time, place);
    }
    return true;
  }
  /// Takes a schema, channel or message. A message names its channel by number: one that is not announced
  /// before is damage.
  Taken take_plain(const Record& r, std::uint64_t first, std::uint64_t last, std::uint16_t& id,
                   std::uint64_t& time) {
    Cursor c(r.content);
    if (r.op == Op::schema) {
      Schema s;
      s.id = c.get<std::uint16_t>(), s.name = c.text(), s.encoding = c.text(), s.text = c.text();
      if (c.broken() || s.id == 0) return Taken::damaged;
      if (!schemas_[s.id]) schemas_[s.id] = true, out_.summary.schemas.push_back(std::move(s));
      return Taken::fine;
    }
    if (r.op == Op::channel) {
      Channel ch;
      ch.id = c.get<std::uint16_t>(), ch.schema = c.get<std::uint16_t>(), ch.topic = c.text(),
      ch.encoding = c.text(), ch.metadata = c.texts();
      if (c.broken() || (ch.schema != 0 && !schemas_[ch.schema])) return Taken::damaged;
      if (channels_.emplace(ch.id, ch).second) out_.summary.channels.push_back(std::move(ch));
      return Taken::fine;
    }
    if (r.op != Op::message) return Taken::other;
    const auto found = channels_.find(id = c.get<std::uint16_t>());
    const auto sequence = c.get<std::uint32_t>();
    time = c.get<std::uint64_t>();
    static_cast<void>(c.get<std::uint64_t>());
    if (c.broken() || found == channels_.end() || time < first || time > last) return Taken::damaged;
    constexpr auto latest = static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max());
    each_(McapMessage{found->second, Nanoseconds(static_cast<std::int64_t>(std::min(time, latest))), sequence,
                      r.content.subspan(c.at())});
    return Taken::message;
  }

  McapContents& out_;
  Each& each_;
  std::map<std::uint16_t, Channel> channels_;
  std::vector<bool> schemas_ = std::vector<bool>(65536);  ///< whether there is a schema of each id
};

}  // namespace detail::mcap

/// Reads a file from memory, front to back, without its summary: calls `each(message)` for the messages of
/// every whole chunk whose CRC is right and of those outside of chunks, and says what is there and what was
/// left out. Any bytes are safe: lengths are checked, and nothing is believed.
template <class Each>
McapContents read_mcap(std::span<const unsigned char> file, Each&& each) {
  McapContents out;
  detail::mcap::FrontToBack<std::remove_reference_t<Each>>(out, each).run(file);
  return out;
}

SKINCTL_END_NAMESPACE
