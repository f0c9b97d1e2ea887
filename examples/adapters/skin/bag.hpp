// ROS 1 bags, format 2.0: messages in the order in which they were recorded.
#pragma once

#include <array>
#include <cstdint>
#include <fstream>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "skinctl/core/time.hpp"

namespace adapters::skin {

/// A file that is no bag, is damaged, or is compressed in a way that this build cannot read. The text names
/// the file and the place.
class BagError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct BagMessage {
  std::string_view topic, type;
  skinctl::Nanoseconds time{};  ///< of its recording
  std::span<const std::uint8_t> bytes;
};

/// Reads a bag from its front to its end, chunk by chunk; the index is not needed, so a bag whose recorder
/// was killed is read up to where it ends. Memory is bounded by the largest chunk, at most `largest`.
class BagReader {
 public:
  static constexpr std::size_t largest = 64 << 20;

  /// Throws `BagError`.
  explicit BagReader(const std::string& file);
  /// The next message, valid until the next call; false at the end. Throws `BagError`.
  bool next(BagMessage& message);
  /// The file ended within a record.
  [[nodiscard]] bool cut_short() const noexcept { return cut_short_; }

 private:
  struct Record {
    std::span<const std::uint8_t> header, data;
  };
  struct Connection {
    std::string topic, type;
  };
  [[noreturn]] void fail(const std::string& what) const;
  bool read_record(std::vector<std::uint8_t>& header, std::vector<std::uint8_t>& data);
  bool take(Record& record);
  [[nodiscard]] std::span<const std::uint8_t> field(std::span<const std::uint8_t> header,
                                                    std::string_view name) const;
  void connect(const Record& record);
  void unpack(std::string_view compression, std::size_t size);
  bool deliver(const Record& record, BagMessage& message);

  std::string file_;
  std::ifstream in_;
  std::vector<std::uint8_t> header_, data_, chunk_;
  std::span<const std::uint8_t> rest_;  ///< of the chunk
  std::map<std::uint32_t, Connection> connections_;
  bool cut_short_ = false;
};

/// Writes a bag of one topic, uncompressed, with its index.
class BagWriter {
 public:
  /// Throws `BagError` where the file cannot be written. `md5sum` "*" fits every reader that takes any
  /// definition.
  BagWriter(const std::string& file, const std::string& topic, const std::string& type,
            const std::string& definition, const std::string& md5sum = "*");
  ~BagWriter();
  BagWriter(const BagWriter&) = delete;
  BagWriter& operator=(const BagWriter&) = delete;
  void write(skinctl::Nanoseconds time, std::span<const std::uint8_t> message);
  /// Writes the index. Throws `BagError`; the destructor does not.
  void close();

 private:
  struct Entry {
    std::uint64_t time;
    std::uint32_t offset;
  };
  struct Chunk {
    std::uint64_t position, first, last;
    std::uint32_t messages;
  };
  void flush();

  std::string file_, connection_;
  std::ofstream out_;
  std::string chunk_;
  std::vector<Entry> entries_;
  std::vector<Chunk> chunks_;
  bool open_ = true;
};

}  // namespace adapters::skin
