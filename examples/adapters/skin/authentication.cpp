#include "examples/adapters/skin/authentication.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <fstream>

#include "examples/adapters/skin/datagram.hpp"
#include "skinctl/core/contract.hpp"

#if SKINCTL_HAS_SODIUM
#include <sodium.h>
#endif

namespace adapters::skin {

Key::Key(std::span<const std::uint8_t, size> bytes) {
#if SKINCTL_HAS_SODIUM
  if (sodium_init() < 0) skinctl::refuse("skinctl: libsodium cannot be initialised");
#else
  skinctl::refuse(
      "skinctl: a key needs libsodium, and this program was built without. On Debian 12: sudo apt-get "
      "install "
      "libsodium-dev");
#endif
  std::copy(bytes.begin(), bytes.end(), bytes_.begin());
}

Key Key::read(const std::string& file) {
  struct stat about{};
  std::ifstream in(file);
  if (!in || ::stat(file.c_str(), &about) != 0 || !S_ISREG(about.st_mode))
    skinctl::refuse("skinctl: " + file + ": cannot be read");
  if ((about.st_mode & 077) != 0)
    skinctl::refuse("skinctl: " + file + ": others may read or write this key; chmod 600 " + file);
  std::array<char, 2 * size + 1> digits{};
  in.read(digits.data(), 2 * size);
  std::array<std::uint8_t, size> bytes{};
  bool good = in.gcount() == 2 * size;
  for (std::size_t i = 0; i < 2 * size && good; ++i) {
    const char c = digits[i];
    const int value = c >= '0' && c <= '9'   ? c - '0'
                      : c >= 'a' && c <= 'f' ? c - 'a' + 10
                      : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                             : -1;
    good = value >= 0;
    bytes[i / 2] = static_cast<std::uint8_t>(16 * bytes[i / 2] + value);
  }
  for (char c = 0; good && in.get(c);) good = c == '\n' || c == '\r' || c == ' ';
  if (!good) skinctl::refuse("skinctl: " + file + ": no key, allowed: 64 hexadecimal digits");
  Key key(bytes);
#if SKINCTL_HAS_SODIUM
  sodium_memzero(digits.data(), digits.size());
  sodium_memzero(bytes.data(), bytes.size());
#endif
  return key;
}

Key::~Key() {
#if SKINCTL_HAS_SODIUM
  sodium_memzero(bytes_.data(), bytes_.size());
#endif
}

std::array<std::uint8_t, tag_size> Key::tag(std::span<const std::uint8_t> bytes) const noexcept {
  std::array<std::uint8_t, tag_size> out{};
#if SKINCTL_HAS_SODIUM
  crypto_generichash(out.data(), out.size(), bytes.data(), bytes.size(), bytes_.data(), bytes_.size());
#else
  static_cast<void>(bytes);  // no key exists
#endif
  return out;
}

bool Key::made(std::span<const std::uint8_t> datagram) const noexcept {
#if SKINCTL_HAS_SODIUM
  if (datagram.size() < tag_size) return false;
  const auto expected = tag(datagram.first(datagram.size() - tag_size));
  return sodium_memcmp(expected.data(), datagram.last(tag_size).data(), tag_size) == 0;
#else
  static_cast<void>(datagram);
  return false;
#endif
}

std::size_t seal(std::span<std::uint8_t> buffer, std::size_t size, std::uint64_t session,
                 const Key& key) noexcept {
  Datagram plain;
  if (size > buffer.size() || buffer.size() - size < session_size + tag_size) return 0;
  if (!parse(buffer.first(size), plain) || plain.sealed || plain.count() > max_sealed_samples) return 0;
  std::uint8_t* const samples = buffer.data() + header_size;
  std::memmove(samples + session_size, samples, size - header_size);
  buffer[4] = 2;
  for (std::size_t i = 0; i < session_size; ++i) samples[i] = static_cast<std::uint8_t>(session >> (8 * i));
  const auto tag = key.tag(buffer.first(size + session_size));
  std::memcpy(buffer.data() + size + session_size, tag.data(), tag_size);
  return size + session_size + tag_size;
}

std::uint64_t session_now() noexcept {
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(now).count());
}

}  // namespace adapters::skin
