// SPDX-License-Identifier: BSD-3-Clause
// MCAP on a disk: a sink that survives a full one, a file in memory, recovery. Needs POSIX.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <string>

#include "skinctl/recording/mcap.hpp"
#include "skinctl/recording/mcap_reader.hpp"

SKINCTL_BEGIN_NAMESPACE

/// A new file. What does not fit on the disk is cut off again, so that the file always ends with a whole
/// record; later bytes are tried anew. For one thread, which is not the loop.
class FileSink {
 public:
  /// Replaces an existing file. Throws `ConfigurationError` with the system's reason.
  explicit FileSink(const std::string& path)
      : descriptor_(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644)) {
    if (descriptor_ < 0) refuse("skinctl: " + path + ": " + std::strerror(errno));
  }
  ~FileSink() { ::close(descriptor_); }
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  [[nodiscard]] bool write(std::span<const unsigned char> bytes) noexcept {
    for (std::size_t done = 0; done < bytes.size();) {
      const auto n = ::write(descriptor_, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n <= 0) {
        ++refused_;
        // Should that fail as well, `recover` cuts there.
        if (done > 0 && (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0 ||
                         ::lseek(descriptor_, static_cast<off_t>(size_), SEEK_SET) < 0))
          return false;
        return false;
      }
      done += static_cast<std::size_t>(n);
    }
    size_ += bytes.size();
    return true;
  }
  /// Number of writes that did not fit.
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_; }

 private:
  int descriptor_;
  std::uint64_t size_ = 0, refused_ = 0;
};

/// A file's bytes, mapped: they are read from the disk where they are looked at.
class MappedFile {
 public:
  /// Throws `ConfigurationError` with the system's reason.
  explicit MappedFile(const std::string& path) {
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat facts{};
    if (descriptor < 0 || ::fstat(descriptor, &facts) != 0 || !S_ISREG(facts.st_mode)) {
      const int reason = descriptor < 0 ? errno : EINVAL;
      if (descriptor >= 0) ::close(descriptor);
      refuse("skinctl: " + path + ": " + std::strerror(reason));
    }
    size_ = static_cast<std::size_t>(facts.st_size);
    void* at = size_ > 0 ? ::mmap(nullptr, size_, PROT_READ, MAP_PRIVATE, descriptor, 0) : nullptr;
    ::close(descriptor);
    if (at == MAP_FAILED) refuse("skinctl: " + path + ": " + std::strerror(errno));
    data_ = static_cast<const unsigned char*>(at);
  }
  ~MappedFile() {
    if (data_ != nullptr) ::munmap(const_cast<unsigned char*>(data_), size_);
  }
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const unsigned char> bytes() const noexcept { return {data_, size_}; }

 private:
  const unsigned char* data_ = nullptr;
  std::size_t size_ = 0;
};

/// The result of `recover`.
struct Recovered {
  bool was_whole = false;  ///< whether the file was whole, and is not touched
  std::uint64_t messages = 0;
  std::uint64_t cut = 0;  ///< bytes removed behind the last whole chunk
  std::string left_out;   ///< messages that were not counted, in words: they stay; empty: none
};

/// Gives a file that was cut off (a killed program, a lost supply) an end again: cuts behind the last whole
/// chunk, and writes its message indexes and the summary anew. A whole file is not touched. Throws
/// `ConfigurationError` for a file that is no MCAP, has compressed chunks, whose contents a summary would
/// have to name, or cannot be written.
inline Recovered recover(const std::string& path) {
  using namespace detail::mcap;
  Recovered out;
  Bytes end;
  std::uint64_t keep = 0;
  {
    const MappedFile file(path);
    const View bytes = file.bytes();
    McapContents contents = read_mcap(bytes, [](const McapMessage&) {});
    if (!contents.is_mcap) refuse("skinctl: " + path + ": no MCAP file");
    out = {contents.whole, contents.summary.messages(), 0, contents.left_out()};
    if (contents.whole) return out;
    if (contents.compressed > 0) refuse("skinctl: " + path + ": not touched: " + out.left_out);
    keep = contents.last_unit_end;
    // The indexes of the last chunk, if nothing follows it: read that chunk alone.
    auto& chunks = contents.summary.chunks;
    if (!chunks.empty() && chunks.back().start + chunks.back().length == keep) {
      MessageIndexes indexes;
      Cursor c(bytes.subspan(chunks.back().start + record_head));
      static_cast<void>(c.take(8 + 8 + 8 + 4));
      static_cast<void>(c.text());
      Cursor records(c.take(c.get<std::uint64_t>()));
      const std::size_t from = records.at();
      while (records.left() > 0 && !chunks.back().index_offsets.empty()) {
        const std::uint64_t place = records.at() - from;
        const auto r = next(records);
        if (!r) break;
        Cursor m(r->content);
        if (r->op != Op::message) continue;
        const auto id = m.get<std::uint16_t>();
        static_cast<void>(m.get<std::uint32_t>());
        indexes[id].emplace_back(m.get<std::uint64_t>(), place);
      }
      detail::mcap::write(end, indexes, keep, chunks.back());
    }
    put(end, View(contents.summary.close(keep + end.size())));
    out.cut = bytes.size() - keep;
  }
  const int descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor < 0) refuse("skinctl: " + path + ": " + std::strerror(errno));
  bool fine = ::ftruncate(descriptor, static_cast<off_t>(keep)) == 0 &&
              ::lseek(descriptor, static_cast<off_t>(keep), SEEK_SET) >= 0;
  for (std::size_t done = 0; fine && done < end.size();) {
    const auto n = ::write(descriptor, end.data() + done, end.size() - done);
    if (n < 0 && errno == EINTR) continue;
    fine = n > 0;
    if (fine) done += static_cast<std::size_t>(n);
  }
  const std::string reason = fine ? "" : std::strerror(errno);
  if (::close(descriptor) != 0 || !fine) refuse("skinctl: " + path + ": cannot be written: " + reason);
  return out;
}

SKINCTL_END_NAMESPACE
