// Datagrams that only who holds a key can make, and only now: sealed ones of PROTOCOL.md. Needs libsodium;
// without it a key is refused.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "examples/adapters/skin/datagram.hpp"

namespace adapters::skin {

/// What a tag belongs to. Each has a key of its own, so that none is taken for another.
enum class Sealed : std::uint8_t { version_2, samples, question, lights };

/// The secret of a sender and its receiver: 32 bytes. Its memory is wiped at the end.
class Key {
 public:
  static constexpr std::size_t size = 32;

  /// Throws `ConfigurationError` where the program was built without libsodium, naming the package.
  explicit Key(std::span<const std::uint8_t, size> bytes);
  /// Reads 64 hexadecimal digits. Throws `ConfigurationError` for a file that cannot be read, that others
  /// than its owner may read or write, or that holds anything else.
  static Key read(const std::string& file);
  Key(const Key&) = default;
  Key& operator=(const Key&) = default;
  ~Key();

  /// BLAKE2b of `bytes` with the key of `what`.
  [[nodiscard]] std::array<std::uint8_t, tag_size> tag(Sealed what,
                                                       std::span<const std::uint8_t> bytes) const noexcept;
  /// Whether the last `tag_size` bytes are the tag of those before; takes as long wherever they differ.
  [[nodiscard]] bool made(Sealed what, std::span<const std::uint8_t> bytes) const noexcept;
  /// Puts the tag behind the first `used` bytes; returns how many are used then.
  std::size_t seal(Sealed what, std::span<std::uint8_t> buffer, std::size_t used) const noexcept;

 private:
  std::array<std::array<std::uint8_t, size>, 4> keys_{};  ///< version 2 knew one: the secret itself
};

/// A question on its way: `SKIQ`, the question, a tag.
using QuestionBytes = std::array<std::uint8_t, 4 + question_size + tag_size>;
[[nodiscard]] QuestionBytes question_datagram(const Question& question, const Key& key) noexcept;
/// False for bytes that are no question of who holds this key.
[[nodiscard]] bool parse_question(std::span<const std::uint8_t> bytes, const Key& key,
                                  Question& out) noexcept;

/// The questions of a receiver: 8 random bytes each, answered by the number of a datagram. Answers of
/// another run, recordings and repetitions are told from fresh ones, and late ones by the receiver's own
/// clock.
class Questions {
 public:
  /// A new question each so often; answered within this time.
  static constexpr skinctl::Nanoseconds every = std::chrono::milliseconds(20),
                                        valid = std::chrono::milliseconds(100);
  enum class Answer : std::uint8_t {
    fresh,
    restarted,  ///< fresh, and numbered anew: of a sender that has begun again
    unasked,    ///< its question is none of the last 100 ms
    repeated    ///< or overtaken
  };

  /// Whether it is time for a new question; then it is made.
  bool ask(skinctl::Nanoseconds now) noexcept;
  /// The newest question.
  [[nodiscard]] const Question& newest() const noexcept { return asked_[newest_].question; }
  /// Judges, and remembers, a datagram whose tag is right.
  Answer judge(const Question& question, std::uint32_t number, skinctl::Nanoseconds now) noexcept;

 private:
  struct Asked {
    Question question{};
    skinctl::Nanoseconds at{};
    std::uint32_t number = 0;  ///< newest of its answers
    bool asked = false, answered = false;
  };
  std::array<Asked, 8> asked_{};  ///< those of 100 ms, and room for a late poll
  std::size_t newest_ = 0;
  bool heard_ = false;
  skinctl::Nanoseconds answered_at_{};  ///< when the newest question with an answer was asked
  std::uint32_t number_ = 0;            ///< of the last fresh answer
};

}  // namespace adapters::skin
