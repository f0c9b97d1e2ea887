#include "examples/adapters/skin/bag.hpp"

#include <algorithm>

#if SKINCTL_HAS_BZIP2
#include <bzlib.h>
#endif
#if SKINCTL_HAS_LZ4
#include <lz4frame.h>
#endif

namespace adapters::skin {
namespace {

constexpr std::string_view first_line = "#ROSBAG V2.0\n";
enum Op : std::uint8_t {
  op_message = 2,
  op_bag = 3,
  op_index = 4,
  op_chunk = 5,
  op_chunk_info = 6,
  op_connection = 7
};
constexpr std::size_t largest_header = 1 << 20, bag_header_size = 4096, chunk_target = 768 << 10;

template <class U>
U little(std::span<const std::uint8_t> bytes) {
  U x = 0;
  for (std::size_t k = std::min(sizeof(U), bytes.size()); k > 0; --k)
    x = static_cast<U>((x << 7 << 1) | bytes[k - 1]);
  return x;
}
template <class U>
std::string raw(U x) {
  std::string out;
  for (std::size_t k = 0; k < sizeof(U); ++k) out += static_cast<char>(x >> (8 * k));
  return out;
}
std::string field_text(std::string_view name, const std::string& value) {
  return raw(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + std::string(name) + "=" + value;
}
std::string op_text(Op op) {
  return field_text("op", std::string(1, static_cast<char>(op)));
}
/// Seconds and nanoseconds, 32 bits each.
std::string stamp(std::uint64_t time) {
  return raw(static_cast<std::uint32_t>(time / 1'000'000'000)) +
         raw(static_cast<std::uint32_t>(time % 1'000'000'000));
}
std::string record(const std::string& header, std::string_view data) {
  std::string out =
      raw(static_cast<std::uint32_t>(header.size())) + header + raw(static_cast<std::uint32_t>(data.size()));
  return out.append(data);
}

}  // namespace

BagReader::BagReader(const std::string& file) : file_(file), in_(file, std::ios::binary) {
  std::string line(first_line.size(), '\0');
  if (!in_.read(line.data(), static_cast<std::streamsize>(line.size())) || line != first_line)
    fail("is no bag of format 2.0");
}

void BagReader::fail(const std::string& what) const {
  throw BagError(file_ + ": " + what);
}

/// A record of the file. False at its end.
bool BagReader::read_record(std::vector<std::uint8_t>& header, std::vector<std::uint8_t>& data) {
  const auto part = [&](std::vector<std::uint8_t>& into, std::size_t most, bool first) {
    std::array<std::uint8_t, 4> length{};
    in_.read(reinterpret_cast<char*>(length.data()), 4);
    if (in_.gcount() == 0 && first) return false;
    const std::size_t n = little<std::uint32_t>(length);
    if (in_.gcount() == 4 && n > most)
      fail("a record of " + std::to_string(n) + " bytes, allowed: " + std::to_string(most));
    if (in_.gcount() == 4) {
      into.clear();
      // In pieces: a length that lies costs no memory.
      for (std::size_t k = 0; k < n;) {
        const std::size_t piece = std::min<std::size_t>(n - k, 1 << 20);
        into.resize(k + piece);
        in_.read(reinterpret_cast<char*>(into.data() + k), static_cast<std::streamsize>(piece));
        if (static_cast<std::size_t>(in_.gcount()) != piece) break;
        k += piece;
      }
      if (in_) return true;
    }
    cut_short_ = true;
    return false;
  };
  return part(header, largest_header, true) && part(data, largest, false);
}

/// A record of the chunk. False at its end.
bool BagReader::take(Record& out) {
  if (rest_.empty()) return false;
  for (auto* part : {&out.header, &out.data}) {
    if (rest_.size() < 4) fail("a chunk ends within a record");
    const std::size_t n = little<std::uint32_t>(rest_);
    if (rest_.size() - 4 < n) fail("a record is longer than its chunk");
    *part = rest_.subspan(4, n);
    rest_ = rest_.subspan(4 + n);
  }
  return true;
}

/// The value of a field of a header; empty: there is none.
std::span<const std::uint8_t> BagReader::field(std::span<const std::uint8_t> header,
                                               std::string_view name) const {
  while (!header.empty()) {
    const std::size_t n = header.size() < 4 ? header.size() : little<std::uint32_t>(header);
    if (header.size() < 4 || header.size() - 4 < n) fail("a header with a field that is longer than itself");
    const auto whole = header.subspan(4, n);
    const std::string_view text(reinterpret_cast<const char*>(whole.data()), whole.size());
    if (text.size() > name.size() && text.starts_with(name) && text[name.size()] == '=')
      return whole.subspan(name.size() + 1);
    header = header.subspan(4 + n);
  }
  return {};
}

void BagReader::connect(const Record& r) {
  const auto text = [&](std::span<const std::uint8_t> header, std::string_view name) {
    const auto value = field(header, name);
    return std::string(reinterpret_cast<const char*>(value.data()), value.size());
  };
  if (connections_.size() >= 65536) fail("more than 65536 connections");
  connections_[little<std::uint32_t>(field(r.header, "conn"))] = {text(r.header, "topic"),
                                                                  text(r.data, "type")};
}

void BagReader::unpack(std::string_view compression, std::size_t size) {
  if (compression.empty() || compression == "none") {
    std::swap(chunk_, data_);
  } else {
    if (size > largest)
      fail("a chunk of " + std::to_string(size) + " bytes, allowed: " + std::to_string(largest));
    chunk_.resize(size);
    bool good = false;
    if (compression == "bz2") {
#if SKINCTL_HAS_BZIP2
      auto n = static_cast<unsigned>(size);
      good = BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(chunk_.data()), &n,
                                        reinterpret_cast<char*>(data_.data()),
                                        static_cast<unsigned>(data_.size()), 0, 0) == BZ_OK &&
             n == size;
#else
      fail("is compressed with bzip2, which this build cannot read: install libbz2-dev and build again");
#endif
    } else if (compression == "lz4") {
#if SKINCTL_HAS_LZ4
      LZ4F_dctx* context = nullptr;
      if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) == 0) {
        std::size_t done = 0, used = 0, hint = 1;
        while (hint != 0 && used < data_.size()) {
          std::size_t out = size - done, in = data_.size() - used;
          hint = LZ4F_decompress(context, chunk_.data() + done, &out, data_.data() + used, &in, nullptr);
          if (LZ4F_isError(hint) != 0 || (out == 0 && in == 0)) break;
          done += out, used += in;
        }
        good = hint == 0 && done == size;
        LZ4F_freeDecompressionContext(context);
      }
#else
      fail("is compressed with LZ4, which this build cannot read: install liblz4-dev and build again");
#endif
    } else {
      fail("is compressed with '" + std::string(compression.substr(0, 20)) + "', known: none, bz2, lz4");
    }
    if (!good) fail("a chunk that cannot be unpacked");
  }
  rest_ = chunk_;
}

bool BagReader::deliver(const Record& r, BagMessage& message) {
  const auto found = connections_.find(little<std::uint32_t>(field(r.header, "conn")));
  const auto time = field(r.header, "time");
  if (found == connections_.end() || time.size() != 8) fail("a message without its connection or time");
  message.topic = found->second.topic;
  message.type = found->second.type;
  message.time = skinctl::Nanoseconds(std::int64_t{little<std::uint32_t>(time)} * 1'000'000'000 +
                                      little<std::uint32_t>(time.subspan(4)));
  message.bytes = r.data;
  return true;
}

bool BagReader::next(BagMessage& message) {
  for (;;) {
    for (Record r; take(r);) {
      const auto op = field(r.header, "op");
      if (op.size() != 1) fail("a record without its kind");
      if (op[0] == op_connection) connect(r);
      if (op[0] == op_message) return deliver(r, message);
    }
    if (!read_record(header_, data_)) return false;
    const auto op = field(header_, "op");
    if (op.size() != 1) fail("a record without its kind");
    if (op[0] == op_connection) connect({header_, data_});
    if (op[0] == op_message) return deliver({header_, data_}, message);  // legal outside of a chunk
    if (op[0] == op_chunk) {
      const auto compression = field(header_, "compression");
      unpack({reinterpret_cast<const char*>(compression.data()), compression.size()},
             little<std::uint32_t>(field(header_, "size")));
    }
  }
}

BagWriter::BagWriter(const std::string& file, const std::string& topic, const std::string& type,
                     const std::string& definition, const std::string& md5sum)
    : file_(file), out_(file, std::ios::binary) {
  const std::string data = field_text("topic", topic) + field_text("type", type) +
                           field_text("md5sum", md5sum) + field_text("message_definition", definition);
  connection_ = record(
      op_text(op_connection) + field_text("conn", raw(std::uint32_t{0})) + field_text("topic", topic), data);
  chunk_ = connection_;
  // Written again when the place of the index is known.
  out_ << first_line << std::string(bag_header_size, ' ');
  if (!out_) throw BagError(file + ": cannot be written");
}
BagWriter::~BagWriter() {
  try {
    close();
  } catch (const BagError&) {
  }
}

void BagWriter::write(skinctl::Nanoseconds time, std::span<const std::uint8_t> message) {
  const auto ns = static_cast<std::uint64_t>(std::max<std::int64_t>(time.count(), 0));
  entries_.push_back({ns, static_cast<std::uint32_t>(chunk_.size())});
  chunk_ +=
      record(op_text(op_message) + field_text("conn", raw(std::uint32_t{0})) + field_text("time", stamp(ns)),
             {reinterpret_cast<const char*>(message.data()), message.size()});
  if (chunk_.size() > chunk_target) flush();
}

void BagWriter::flush() {
  if (entries_.empty()) return;
  Chunk chunk{static_cast<std::uint64_t>(out_.tellp()), entries_[0].time, entries_[0].time,
              static_cast<std::uint32_t>(entries_.size())};
  std::string index;
  for (const Entry& e : entries_) {
    chunk.first = std::min(chunk.first, e.time);
    chunk.last = std::max(chunk.last, e.time);
    index += stamp(e.time) + raw(e.offset);
  }
  out_ << record(op_text(op_chunk) + field_text("compression", "none") +
                     field_text("size", raw(static_cast<std::uint32_t>(chunk_.size()))),
                 chunk_)
       << record(op_text(op_index) + field_text("ver", raw(std::uint32_t{1})) +
                     field_text("conn", raw(std::uint32_t{0})) + field_text("count", raw(chunk.messages)),
                 index);
  if (!out_) throw BagError(file_ + ": cannot be written");
  chunks_.push_back(chunk);
  entries_.clear();
  chunk_.clear();
}

void BagWriter::close() {
  if (!open_) return;
  open_ = false;
  flush();
  const auto index = static_cast<std::uint64_t>(out_.tellp());
  out_ << connection_;
  for (const Chunk& c : chunks_)
    out_ << record(op_text(op_chunk_info) + field_text("ver", raw(std::uint32_t{1})) +
                       field_text("chunk_pos", raw(c.position)) + field_text("start_time", stamp(c.first)) +
                       field_text("end_time", stamp(c.last)) + field_text("count", raw(std::uint32_t{1})),
                   raw(std::uint32_t{0}) + raw(c.messages));
  const std::string header = op_text(op_bag) + field_text("index_pos", raw(index)) +
                             field_text("conn_count", raw(std::uint32_t{1})) +
                             field_text("chunk_count", raw(static_cast<std::uint32_t>(chunks_.size())));
  out_.seekp(static_cast<std::streamoff>(first_line.size()));
  out_ << record(header, std::string(bag_header_size - 8 - header.size(), ' '));
  out_.flush();
  if (!out_) throw BagError(file_ + ": cannot be written");
}

}  // namespace adapters::skin
