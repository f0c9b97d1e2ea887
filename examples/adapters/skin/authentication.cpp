#include "examples/adapters/skin/authentication.hpp"

#include <sys/stat.h>

#include <algorithm>
#include <fstream>

#include "skinctl/core/contract.hpp"

#if SKINCTL_HAS_SODIUM
#include <sodium.h>
#endif

namespace adapters::skin {

using skinctl::Nanoseconds;

/// Of the keys that are derived from the secret.
[[maybe_unused]] static constexpr char derived_keys[] = {'s', 'k', 'i', 'n', 'c', 't', 'l', '3'};

Key::Key(std::span<const std::uint8_t, size> bytes) {
#if SKINCTL_HAS_SODIUM
  if (sodium_init() < 0) skinctl::refuse("skinctl: libsodium cannot be initialised");
#else
  skinctl::refuse(
      "skinctl: a key needs libsodium, and this program was built without. On Debian 12: sudo apt-get "
      "install "
      "libsodium-dev");
#endif
  std::copy(bytes.begin(), bytes.end(), keys_[0].begin());
#if SKINCTL_HAS_SODIUM
  static_assert(size == crypto_kdf_KEYBYTES && sizeof derived_keys == crypto_kdf_CONTEXTBYTES);
  for (std::size_t k = 1; k < keys_.size(); ++k)
    crypto_kdf_derive_from_key(keys_[k].data(), size, k, derived_keys, keys_[0].data());
#endif
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
  for (auto& key : keys_) sodium_memzero(key.data(), key.size());
#endif
}

std::array<std::uint8_t, tag_size> Key::tag(Sealed what, std::span<const std::uint8_t> bytes) const noexcept {
  std::array<std::uint8_t, tag_size> out{};
#if SKINCTL_HAS_SODIUM
  const auto& key = keys_[static_cast<std::size_t>(what)];
  crypto_generichash(out.data(), out.size(), bytes.data(), bytes.size(), key.data(), key.size());
#else
  static_cast<void>(what), static_cast<void>(bytes);  // no key exists
#endif
  return out;
}

bool Key::made(Sealed what, std::span<const std::uint8_t> bytes) const noexcept {
#if SKINCTL_HAS_SODIUM
  if (bytes.size() < tag_size) return false;
  const auto expected = tag(what, bytes.first(bytes.size() - tag_size));
  return sodium_memcmp(expected.data(), bytes.last(tag_size).data(), tag_size) == 0;
#else
  static_cast<void>(what), static_cast<void>(bytes);
  return false;
#endif
}

std::size_t Key::seal(Sealed what, std::span<std::uint8_t> buffer, std::size_t used) const noexcept {
  const auto made = tag(what, buffer.first(used));
  std::copy(made.begin(), made.end(), buffer.begin() + static_cast<std::ptrdiff_t>(used));
  return used + tag_size;
}

QuestionBytes question_datagram(const Question& question, const Key& key) noexcept {
  QuestionBytes out{'S', 'K', 'I', 'Q'};
  std::copy(question.begin(), question.end(), out.begin() + 4);
  key.seal(Sealed::question, out, 4 + question_size);
  return out;
}

bool parse_question(std::span<const std::uint8_t> bytes, const Key& key, Question& out) noexcept {
  if (bytes.size() != QuestionBytes().size() || bytes[0] != 'S' || bytes[1] != 'K' || bytes[2] != 'I' ||
      bytes[3] != 'Q' || !key.made(Sealed::question, bytes))
    return false;
  std::copy_n(bytes.begin() + 4, question_size, out.begin());
  return true;
}

bool Questions::ask(Nanoseconds now) noexcept {
  const Asked& last = asked_[newest_];
  if (last.asked && now >= last.at && now - last.at < every) return false;
  newest_ = (newest_ + 1) % asked_.size();
  asked_[newest_] = {.at = now, .asked = true};
#if SKINCTL_HAS_SODIUM
  randombytes_buf(asked_[newest_].question.data(), question_size);
#endif
  return true;
}

Questions::Answer Questions::judge(const Question& question, std::uint32_t number, Nanoseconds now) noexcept {
  for (Asked& asked : asked_) {
    if (!asked.asked || now - asked.at > valid || asked.question != question) continue;
    if (asked.answered && number <= asked.number) return Answer::repeated;
    // Where questions have overtaken each other, an older one is answered with a higher number.
    const bool newer = !heard_ || asked.at > answered_at_;
    if (!newer && number <= number_) return Answer::repeated;
    const bool restarted = heard_ && number <= number_;
    if (newer) answered_at_ = asked.at;
    asked.answered = heard_ = true;
    asked.number = number_ = number;
    return restarted ? Answer::restarted : Answer::fresh;
  }
  return Answer::unasked;
}

}  // namespace adapters::skin
