// XML-RPC over HTTP, as ROS 1 nodes and their master speak it: calls and answers as values.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace adapters::ros1 {

/// A text, a whole number or a list. What else XML-RPC has is read as the nearest of them: a boolean as a
/// number; a double, a date or base64 as its text; a structure as the list of its members' values.
struct Value {
  enum class Kind : std::uint8_t { text, number, list };

  Kind kind = Kind::text;
  std::string text{};
  std::int64_t number = 0;
  std::vector<Value> items{};

  [[nodiscard]] static Value of(std::string_view text);
  [[nodiscard]] static Value of(std::int64_t number);
  [[nodiscard]] static Value of(std::vector<Value> items);
  [[nodiscard]] bool operator==(const Value&) const = default;
};

struct Call {
  std::string method;
  std::vector<Value> parameters;
};

/// Lists in lists, and all values of one message: more is refused.
inline constexpr std::size_t deepest = 8, max_values = 1024;

/// None where it is no call, or ends early.
[[nodiscard]] std::optional<Call> parse_call(std::string_view xml);
/// None where it is no answer, or a fault.
[[nodiscard]] std::optional<Value> parse_answer(std::string_view xml);
/// The body of a call, or of an answer.
[[nodiscard]] std::string write(const Call& call);
[[nodiscard]] std::string write(const Value& answer);

/// An HTTP message that comes in pieces: at most 8 KiB of header and 64 KiB of body, no other transfer
/// encoding.
class HttpMessage {
 public:
  enum class Kind : std::uint8_t { request, answer };
  enum class State : std::uint8_t { unfinished, whole, broken };

  explicit HttpMessage(Kind kind) : kind_(kind) {}

  /// What follows the end of the message is ignored. A request other than POST and an answer other than 200
  /// are broken.
  State take(std::span<const std::uint8_t> bytes);
  /// The peer has closed: an answer without a length ends here.
  State closed();
  /// Of a whole message.
  [[nodiscard]] const std::string& body() const noexcept { return body_; }

 private:
  bool read_header(std::string_view header);
  State end();

  Kind kind_;
  State state_ = State::unfinished;
  bool in_body_ = false;
  std::optional<std::size_t> length_;
  std::string header_, body_;
};

/// The bytes of a request to `path` at `host`, and of an answer.
[[nodiscard]] std::string http_request(const std::string& host, const std::string& path,
                                       const std::string& body);
[[nodiscard]] std::string http_answer(const std::string& body);

/// Where a node is: "http://host:port/path".
struct Uri {
  std::string host, path;
  std::uint16_t port = 0;
};
/// None where it is none: no "http://", no port, or a host of other than letters, digits and -._ (at most
/// 255).
[[nodiscard]] std::optional<Uri> parse_uri(std::string_view text);

}  // namespace adapters::ros1
